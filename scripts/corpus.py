#!/usr/bin/env python3
"""Runs the programs over a folder of strangers' images, and writes what other decoders read of them.

    scripts/corpus.py FOLDER            every file through ndf-maps, ndf-maps --height and environment, as dry runs
    scripts/corpus.py FOLDER --expect   beside each file NAME.expected, for
                                        GLINT_CORPUS=FOLDER cargo test -p glint-bake --lib corpus -- --nocapture

The first needs `glint-bake` (target/debug, or GLINT_BAKE) and nothing else. The second needs numpy, Pillow, tifffile,
imagecodecs and OpenEXR. A run that panics (exit code 1, or a signal) or takes more than 5 seconds is listed, and the
exit code is 1.
"""

import collections
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

LONGEST = 5.0


def files(folder):
    return sorted(p for p in pathlib.Path(folder).rglob("*") if p.is_file() and p.suffix != ".expected")


def run_programs(folder):
    program = os.environ.get("GLINT_BAKE", "target/debug/glint-bake")
    counts, faults = collections.Counter(), []
    with tempfile.TemporaryDirectory() as out:
        for path in files(folder):
            for command in (["ndf-maps"], ["ndf-maps", "--height", "2"], ["environment"]):
                args = [program, command[0], str(path), *command[1:], "-n", "-o", f"{out}/x.glintpack"]
                start = time.monotonic()
                try:
                    ended = subprocess.run(args, capture_output=True, timeout=60)
                    code, said = ended.returncode, ended.stderr.decode(errors="replace").strip()
                except subprocess.TimeoutExpired:
                    code, said = "no end", ""
                took = time.monotonic() - start
                counts[f"{' '.join(command)}: {code}"] += 1
                if code not in (0, 3, 4, 5, 6) or took > LONGEST or "please report" in said:
                    faults.append(f"{path}: {' '.join(command)}: {code} after {took:.1f} s: {said[:300]}")
    for name, count in sorted(counts.items()):
        print(f"{name}: {count}")
    print("\n".join(faults) or "no panic, nothing longer than 5 seconds")
    return 1 if faults else 0


def oriented(values, orientation):
    """Rows and columns as the orientation tag 274 says."""
    import numpy

    turns = {
        1: lambda v: v,
        2: lambda v: v[:, ::-1],
        3: lambda v: v[::-1, ::-1],
        4: lambda v: v[::-1],
        5: lambda v: v.swapaxes(0, 1),
        6: lambda v: numpy.rot90(v, -1),
        7: lambda v: v[::-1, ::-1].swapaxes(0, 1),
        8: lambda v: numpy.rot90(v),
    }
    return turns.get(orientation, turns[1])(values)


def read_exr(path):
    import numpy
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = file.parts[0].channels
        names = ["R", "G", "B"] if "R" in channels else ["Y"]
        values = [channels[name].pixels.astype(numpy.float32) for name in names]
    return numpy.stack(values * (3 // len(values)), axis=-1)


def read_tiff(path):
    import numpy
    import tifffile

    with tifffile.TiffFile(path) as file:
        page = file.pages[0]
        if page.photometric not in (0, 1, 2) or page.imagedepth > 1:
            return None
        values = page.asarray()
        if page.planarconfig == 2 and values.ndim == 3:
            values = numpy.moveaxis(values, 0, -1)
        if values.dtype.kind == "u":
            # Samples of 12 bits and the like lie in the next larger type.
            values = values.astype(numpy.float64) / (2.0**page.bitspersample - 1)
        elif values.dtype.kind != "f":
            return None
        if page.photometric == 0:
            values = 1.0 - values
        if tuple(page.extrasamples) == (1,):
            # Associated alpha: colours are multiplied by it.
            alpha = values[..., -1:]
            values = numpy.concatenate([values[..., :-1] / numpy.where(alpha == 0, 1, alpha), alpha], -1)
        tag = page.tags.get(274)
        return oriented(values, tag.value if tag else 1)


def read_other(path):
    import imagecodecs
    import numpy
    from PIL import Image

    data = path.read_bytes()
    if data[:8] == b"\x89PNG\r\n\x1a\n" and data[24] == 16:
        # Pillow has 8 bits for these.
        values = imagecodecs.png_decode(data).astype(numpy.float64) / 65535.0
        return values if b"eXIf" not in data and b"tRNS" not in data else None
    with Image.open(path) as image:
        if image.format not in ("PNG", "JPEG", "TGA", "WEBP"):
            return None
        # Of a PNG, EXIF has a chunk; text and XMP are not read.
        tagged = image.format != "PNG" or b"eXIf" in data
        orientation = image.getexif().get(274, 1) if tagged else 1
        if image.mode in ("I;16", "I;16B", "I"):
            values = numpy.asarray(image).astype(numpy.float64) / 65535.0
        else:
            if image.mode == "P":
                image = image.convert("RGBA" if "transparency" in image.info else "RGB")
            elif "transparency" in image.info and image.mode in ("L", "RGB"):
                image = image.convert("LA" if image.mode == "L" else "RGBA")
            elif image.mode == "1" and "transparency" not in image.info:
                image = image.convert("L")
            if image.mode not in ("L", "LA", "RGB", "RGBA"):
                return None
            values = numpy.asarray(image).astype(numpy.float64) / 255.0
        return oriented(values, orientation)


def write_expected(folder):
    import numpy

    written = collections.Counter()
    for path in files(folder):
        suffix = path.suffix.lower()
        read = {".exr": read_exr, ".tif": read_tiff, ".tiff": read_tiff}.get(suffix, read_other)
        try:
            values = read(path)
        except Exception as error:  # Whatever another decoder throws: it has no opinion then.
            print(f"{path}: {type(error).__name__}: {str(error)[:100]}")
            values = None
        if values is None:
            continue
        values = numpy.atleast_3d(values).astype("<f4")
        if values.ndim != 3 or values.shape[2] > 4:
            continue
        height, width, channels = values.shape
        data = struct.pack("<III", width, height, channels) + values.tobytes()
        path.with_name(path.name + ".expected").write_bytes(data)
        written[suffix] += 1
    print(dict(written))
    return 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3) or sys.argv[2:] not in ([], ["--expect"]):
        sys.exit(__doc__)
    sys.exit(write_expected(sys.argv[1]) if sys.argv[2:] else run_programs(sys.argv[1]))
