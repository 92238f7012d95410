#!/usr/bin/env python3
"""Reads a glintpack and prints what it holds as JSON: python3 read_pack.py PACK

Written from docs/FORMAT.md alone, with nothing but Python's standard library and xxh3.py beside it. Of the checks of
"How to read a pack" it leaves out what is in the records and texels of known kinds, and, before Python 3.14, which can
decompress, compressed payloads; "left_out" says so. A pack that is not sound ends with exit code 4.
"""
import json
import struct
import sys

from xxh3 import xxh3_64

def f32(value):
    """The shortest decimal that is this single float, as JSON writers of other languages print it."""
    texts = (f"{value:.{digits}g}" for digits in range(1, 10))
    return next(float(t) for t in texts if struct.pack("<f", float(t)) == struct.pack("<f", value))


# Types of parameters: a name of a number, "bool", "string", ("list", T), ("array", n, T), ("option", T), ("enum", variants), or
# a dictionary of fields. A variant is its name, or (name, fields).
NUMBERS = {"u8": "<B", "u16": "<H", "u32": "<I", "u64": "<Q", "f32": "<f", "f64": "<d"}
LEVEL = dict(nodes_x="u32", nodes_y="u32", first_node="u32")
CELLS = dict(cells_x="u32", cells_y="u32", cell_texels="f32", seed="u64")
WRAP, PAIR, RGB = ("enum", ["Repeat", "Clamp"]), ("array", 2, "f32"), ("array", 3, "f32")
LOBES = dict(
    cell_texels="u32", cells_x="u32", cells_y="u32", first_lobe="u32", weight_scale="f32", position_sigma=PAIR,
    residual_sigma=PAIR, jacobian_scale="f32")
GRID = dict(width="u32", height="u32", columns="u32", rows="u32")
TILES = dict(colours="u32", variants="u32", margin="u32", hash_seed="u32")
PROVENANCE = dict(
    tool_version="string", git_hash="string", method="string", options=("list", ("array", 2, "string")), seed="u64",
    inputs=("list", dict(name="string", xxh3_128="string", bytes="u64")), normal_convention="string",
    notes=("list", "string"))
PARAMETERS = {
    "PROV": PROVENANCE,
    "NMPP": dict(
        width="u32", height="u32", intrinsic_roughness="f32", finest_variance="f32", levels=("list", LEVEL),
        max_error="f32", measured=dict(mean="f64", p95="f64", worst="f64", energy="f64"),
        pixel=dict(mean="f64", worst="f64", worst_sigma_texels="f64"), node_errors=("list", "f32")),
    "PLPP": dict(kind=("enum", ["Tiled", ("Stochastic", CELLS)]), palette_len="u32"),
    "LAYR": dict(coat="string", base="string", coat_f0="f32", base_f0=("array", 3, "f32")),
    "SDPP": dict(
        marginals="u32", levels="u32", entries="u32", alpha_dict="f64", lobe_std="f64", domain="f64", seed="u64",
        measured=dict(normalisation="f64", mean_l1_first_level="f64", ks_last_level="f64")),
    "GLPP": dict(
        slopes=("enum", ["Beckmann", "Ggx"]), alpha=PAIR, turn="f32", f0=RGB, density="f32", relative_area="f32", facet_area="f32",
        facet_spread="f32", sky_spread="f32", seed="u32", diffuse=RGB, coat="f32", coat_alpha="f32", colours=("list", RGB), table_mean_error="f64"),
    "ENPP": dict(
        face_size="u32", per_size="u32", kernel=("enum", ["Ndf", "GgxNl", "GgxSoft"]),
        roughness=("list", "f64"), radiance_scale="f64", levels=("list", "f64"),
        level_choice=("enum", ["Optimal", "LogUniform"]), coloured="bool", albedo_size="u32", look_ups="u32", source_width="u32",
        source_height="u32", negative_pixels="u64", mean_radiance=("array", 3, "f64"), filter_error="f64",
        max_error=("option", "f64"),
        measured=dict(reads=("list", dict(count="u32", relative="f64", of_mean="f64", worst="f64")),
                      texels=("list", dict(rmse="f64", worst="f64")), texels_measured="u32", energy="f64",
                      second_moment="f64", rounding=("list", "f64"))),
    "ALPP": dict(
        width="u32", height="u32", wrap=WRAP, base_roughness="f32", storage=("enum", ["F16", "Snorm8"]),
        anisotropic="bool", measured=dict(normal_angle="f64", roughness="f64", table_mean="f64")),
    "LOPP": dict(
        width="u32", height="u32", wrap=WRAP, filter=("enum", ["Linear", "Nearest"]), intrinsic_roughness="f32",
        storage=("enum", ["Packed", "Half"]), normals=("enum", ["Snorm16", "Unorm8"]),
        merge=("enum", ["KMeans", "Moments", "Runnalls"]), seeds="u32", lobes_per_cell="u32", step_texels="u32",
        normal_low=PAIR, normal_extent=PAIR, levels=("list", LOBES), rim_roughness="f32",
        measured_roughness="f32", measured=("list", dict(sigma_texels="f32", mean="f32", worst="f32"))),
    "SYPP": dict(
        sample_width="u32", sample_height="u32", wrap=WRAP, patch="u32", overlap="u32", alignment="u32", alpha="f32",
        error_tolerance="f32", seed="u64", layout=("enum", [("Patches", GRID), ("CornerTiles", TILES)]),
        measured=dict(seam_ratio="f64", distinct_offsets="u32")),
}
KINDS = set(PARAMETERS) | set(
    "NMUB NMND NMDE NMNO PLNO PLCL LAUB SDUB SDTB GLUB GLCO GLLI GLLT ENUB ENMI ENRA ENIN ENCO ENAL ALUB ALNM ALRO ALLI ALLT LOUB LOBE LONM SYPO "
    "SYSE".split())
TEXEL_BYTES = {9: 1, 10: 1, 13: 1, 16: 2, 17: 2, 37: 4, 38: 4, 41: 4, 70: 2, 71: 2, 74: 2, 76: 2, 77: 4, 78: 4, 81: 4,
               83: 4, 91: 8, 92: 8, 95: 8, 97: 8, 98: 4, 100: 4, 101: 8, 103: 8, 107: 16, 109: 16, 122: 4, 123: 4}


def check(holds, message):
    if not holds:
        raise ValueError(message)


class Decoder:
    def __init__(self, data): self.data, self.at = data, 0

    def take(self, count):
        check(count <= len(self.data) - self.at, "parameters end too early")
        self.at += count
        return self.data[self.at - count:self.at]

    def number(self, name): return struct.unpack(NUMBERS[name], self.take(struct.calcsize(NUMBERS[name])))[0]

    def value(self, of):
        if isinstance(of, dict):
            return {name: self.value(field) for name, field in of.items()}
        if of == "bool":
            return [False, True][self.number("u8")]
        if of == "string":
            return self.take(self.number("u64")).decode()
        if of == "f32":
            return f32(self.number("f32"))
        if isinstance(of, str):
            return self.number(of)
        if of[0] == "enum":
            variant = of[1][self.number("u32")]
            return variant if isinstance(variant, str) else {variant[0]: self.value(variant[1])}
        if of[0] == "option":
            return self.value(of[1]) if [False, True][self.number("u8")] else None
        count = of[1] if of[0] == "array" else self.number("u64")
        check(of[0] == "array" or count <= len(self.data), "a list is longer than its payload")
        return [self.value(of[-1]) for _ in range(count)]


def resource(words):
    if words[0] == 2:
        names = ("vk_format", "width", "height", "layers", "faces", "mips")
        check(min(words[2:7]) > 0 and words[5] in (1, 6) and words[7] == 0, "bad texture")
        check(words[5] == 1 or words[2] == words[3], "faces of a cube that are not square")
        check(words[6] <= max(words[2:4]).bit_length(), "more mips than a texture of this size has")
        return dict(type="texture", **dict(zip(names, words[1:7])))
    check(words[0] in (0, 1), f"unknown resource type {words[0]}")
    if words[0] == 1:
        check(words[1] > 0 and not any(words[4:]), "bad buffer")
        return dict(type="buffer", stride=words[1], count=words[2] | words[3] << 32)
    check(not any(words), "bad parameters")
    return dict(type="parameters")


def mip_bytes(of):
    """Bytes of each mip of a texture, all its layers and faces together; none where its format is not known."""
    if of["vk_format"] not in TEXEL_BYTES:
        return None
    sizes = [max(1, of["width"] >> m) * max(1, of["height"] >> m) for m in range(of["mips"])]
    return [TEXEL_BYTES[of["vk_format"]] * of["layers"] * of["faces"] * size for size in sizes]


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    check(len(data) >= 40 and data[:12] == b"\xabGLINTP\xbb\r\n\x1a\n", "not a glintpack")
    major, minor, count, flags, length, checksum = struct.unpack_from("<HHIIQQ", data, 12)
    check(major == 1 and flags == 0, "written by a newer program")
    end = 40 + 136 * count
    check(length == len(data) and end <= length, "cut short or extended")
    check(xxh3_64(data[:32] + bytes(8) + data[40:end]) == checksum, "header checksum differs")
    out = dict(file=path, bytes=length, version=[major, minor], sections=[], parameters=[], provenance=[], textures=[],
               left_out=["contents of textures and buffers"])
    for start in range(40, end, 136):
        kind, version, required, codec, offset, stored, raw, checksum = struct.unpack_from("<4sHBBQQQQ", data, start)
        of, size = resource(struct.unpack_from("<8I", data, start + 40)), data[start + 72]
        kind, name = kind.decode("ascii"), data[start + 73:start + 73 + size].decode()
        check(size <= 63 and not any(data[start + 73 + size:start + 136]), "bad name")
        check(all(c >= " " and not "\x7f" <= c < "\xa0" for c in name), "control characters in a name")
        check(required in (0, 1) and codec in (0, 1) and (codec == 1 or stored == raw), f"{kind}: bad entry")
        check(offset == -(-end // 256) * 256 and offset + stored <= length, f"{kind}: in the wrong place")
        check(not any(data[end:offset]), f"{kind}: padding is not zero")
        end = offset + stored
        payload = data[offset:end]
        check(xxh3_64(payload) == checksum, f"{kind}: checksum differs")
        check(all((kind, name) != (s["kind"], s["name"]) for s in out["sections"]), f"{kind}: there twice")
        out["sections"].append(dict(
            kind=kind, name=name, version=version, required=bool(required), codec=["none", "zstd"][codec], resource=of,
            offset=offset, stored_len=stored, raw_len=raw, checksum=f"{checksum:016x}"))
        check(of["type"] != "parameters" or raw <= 16 << 20, f"{kind}: parameters larger than 16 MiB")
        if codec == 1:
            try:
                from compression import zstd  # Python 3.14
                payload = zstd.ZstdDecompressor().decompress(payload, raw + 1)
                check(len(payload) == raw, f"{kind}: decompresses to another length")
            except ImportError:
                out["left_out"].append(f"decompression of {kind} {name}")
                continue
        if of["type"] == "texture":
            mips = mip_bytes(of)
            check(mips is None or sum(mips) == raw, f"{kind}: raw length differs")
            out["textures"].append(dict(kind=kind, name=name, mip_bytes=mips, **of))
        elif of["type"] == "buffer":
            check(of["stride"] * of["count"] == raw, f"{kind}: raw length differs")
        elif kind in PARAMETERS and version == 1:
            decoder = Decoder(payload)
            value = decoder.value(PARAMETERS[kind])
            check(decoder.at == len(payload), f"{kind}: bytes after the value")
            if kind == "PROV":
                out["provenance"].append(value)
            else:
                out["parameters"].append(dict(kind=kind, name=name, value=value))
        known = kind in KINDS and version == 1
        check(known or not required, f"{kind} version {version}: required, and not known here")
    check(end == length, "bytes after the last section")
    return out


if __name__ == "__main__":
    try:
        json.dump(read(sys.argv[1]), sys.stdout, indent=2, ensure_ascii=False)
    except (ValueError, LookupError, struct.error) as error:
        print(f"{sys.argv[1]}: {error}", file=sys.stderr)
        sys.exit(4)
