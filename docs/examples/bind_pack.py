#!/usr/bin/env python3
"""Binds a slope dictionary as a GPU reads it and asks it: python3 bind_pack.py PACK SHADERS PIXELS ANSWERS

A host written from docs/FORMAT.md alone, on the package `wgpu` of PyPI, with read_pack.py beside it. It binds the sections of
the table "Bindings" of a dictionary byte for byte, converts nothing, and runs the example that
`glint-bake shaders --lang wgsl --method dictionary -o SHADERS` writes. PIXELS holds records of `ExamplePixel` of
SHADERS/example_pixels.wgsl, such as `--vectors` writes, ANSWERS gets as many of `ExampleAnswer`.
"""
import pathlib
import sys

import wgpu

from read_pack import read

PIXEL_BYTES, ANSWER_BYTES, GROUP = 80, 48, 64


def section(path, kind):
    """The bytes of the first section of a kind, as they are in the file."""
    found = next(s for s in read(path)["sections"] if s["kind"] == kind)
    if found["codec"] != "none":
        sys.exit(f"{path}: {kind} is compressed; bake without --compress")
    with open(path, "rb") as file:
        file.seek(found["offset"])
        return file.read(found["stored_len"])


def answers(pack, shaders, pixels):
    adapter = wgpu.gpu.request_adapter_sync(power_preference="high-performance")
    device = adapter.request_device_sync()
    usage = wgpu.BufferUsage

    # The program: its files one after the other, in any order.
    files = [f for kind in ["glint", "bind", "example"] for f in sorted(pathlib.Path(shaders).glob(f"{kind}_*.wgsl"))]
    source = "\n".join(file.read_text() for file in files)
    pipeline = device.create_compute_pipeline(
        layout="auto", compute=dict(module=device.create_shader_module(code=source), entry_point="main"))

    count = len(pixels) // PIXEL_BYTES
    asked = device.create_buffer_with_data(data=pixels, usage=usage.STORAGE)
    answered = device.create_buffer(size=count * ANSWER_BYTES, usage=usage.STORAGE | usage.COPY_SRC)

    # Group 1: SDUB and SDTB as they are, then the colours of the material, here white.
    white = memoryview(bytearray(16)).cast("f")
    white[:] = memoryview(bytes.fromhex("0000803f" * 4)).cast("f")
    bound = [
        device.create_buffer_with_data(data=section(pack, "SDUB"), usage=usage.UNIFORM),
        device.create_buffer_with_data(data=section(pack, "SDTB"), usage=usage.STORAGE),
        device.create_buffer_with_data(data=white, usage=usage.STORAGE),
    ]

    def group(index, buffers):
        entries = [dict(binding=i, resource=dict(buffer=b, offset=0, size=b.size)) for i, b in enumerate(buffers)]
        return device.create_bind_group(layout=pipeline.get_bind_group_layout(index), entries=entries)

    encoder = device.create_command_encoder()
    compute = encoder.begin_compute_pass()
    compute.set_pipeline(pipeline)
    compute.set_bind_group(0, group(0, [asked, answered]))
    compute.set_bind_group(1, group(1, bound))
    compute.dispatch_workgroups(-(-count // GROUP))
    compute.end()
    device.queue.submit([encoder.finish()])
    return device.queue.read_buffer(answered)


if __name__ == "__main__":
    pack_path, shaders_path, pixels_path, answers_path = sys.argv[1:]
    with open(answers_path, "wb") as out:
        out.write(answers(pack_path, shaders_path, pathlib.Path(pixels_path).read_bytes()))
