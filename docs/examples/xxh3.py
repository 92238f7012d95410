"""XXH3-64 with seed 0 and the default secret: the checksum of a glintpack (see docs/FORMAT.md), in plain Python."""
import struct

MASK = 2**64 - 1
P32 = (2654435761, 2246822519, 3266489917)
P64 = (11400714785074694791, 14029467366897019727, 1609587929392839161, 9650029242287828579, 2870177450012600261)
SECRET = bytes.fromhex(
    "b8fe6c3923a44bbe7c01812cf721ad1cded46de9839097db7240a4a4b7b3671fcb79e64eccc0e578825ad07dccff7221"
    "b8084674f743248ee03590e6813a264c3c2852bb91c300cb88d0658b1b532ea371644897a20df94e3819ef46a9deacd8"
    "a8fa763fe39c343ff9dcbbc7c70b4f1d8a51e04bcdb45931c89f7ec9d9787364eac5ac8334d3ebc3c581a0fffa1363eb"
    "170ddd51b7f0da49d316552629d4689e2b16be587d47a1fc8ff8b8d17ad031ce45cb3a8f95160428afd7fbcabb4b407e")


def u32(data, at): return struct.unpack_from("<I", data, at)[0]
def u64(data, at): return struct.unpack_from("<Q", data, at)[0]
def swap(value, size): return int.from_bytes(value.to_bytes(size, "little"), "big")
def fold(a, b): return (a * b & MASK) ^ (a * b >> 64)
def secret(a, b): return u64(SECRET, a) ^ u64(SECRET, b)


def avalanche(h):
    h = (h ^ h >> 37) * 0x165667919E3779F9 & MASK
    return h ^ h >> 32


def avalanche64(h):
    h = (h ^ h >> 33) * P64[1] & MASK
    h = (h ^ h >> 29) * P64[2] & MASK
    return h ^ h >> 32


def mix16(d, at, s): return fold(u64(d, at) ^ u64(SECRET, s), u64(d, at + 8) ^ u64(SECRET, s + 8))


def xxh3_64(d):
    n = len(d)
    if n == 0:
        return avalanche64(secret(56, 64))
    if n <= 3:
        return avalanche64((d[0] << 16 | d[n >> 1] << 24 | d[-1] | n << 8) ^ u32(SECRET, 0) ^ u32(SECRET, 4))
    if n <= 8:
        h = (u32(d, n - 4) + (u32(d, 0) << 32)) ^ secret(8, 16)
        h ^= (h << 49 | h >> 15) & MASK ^ (h << 24 | h >> 40) & MASK
        h = h * 0x9FB21C651E98DF25 & MASK
        h = (h ^ (h >> 35) + n) * 0x9FB21C651E98DF25 & MASK
        return h ^ h >> 28
    if n <= 16:
        low, high = u64(d, 0) ^ secret(24, 32), u64(d, n - 8) ^ secret(40, 48)
        return avalanche(n + swap(low, 8) + high + fold(low, high) & MASK)
    acc = n * P64[0]
    if n <= 128:
        for i in range((n - 1) // 32 + 1):
            acc += mix16(d, 16 * i, 32 * i) + mix16(d, n - 16 * (i + 1), 32 * i + 16)
        return avalanche(acc & MASK)
    if n <= 240:
        acc = avalanche(acc + sum(mix16(d, 16 * i, 16 * i) for i in range(8)) & MASK)
        acc += sum(mix16(d, 16 * i, 16 * (i - 8) + 3) for i in range(8, n // 16)) + mix16(d, n - 16, 119)
        return avalanche(acc & MASK)
    lanes = [P32[2], P64[0], P64[1], P64[2], P64[3], P32[1], P64[4], P32[0]]

    def stripe(at, s):
        values, keys = struct.unpack_from("<8Q", d, at), struct.unpack_from("<8Q", SECRET, s)
        for i in range(8):
            key = values[i] ^ keys[i]
            lanes[i ^ 1] += values[i]
            lanes[i] = lanes[i] + (key & 0xFFFFFFFF) * (key >> 32) & MASK

    for number in range((n - 1) // 64):
        stripe(64 * number, 8 * (number % 16))
        if number % 16 == 15:
            keys = struct.unpack_from("<8Q", SECRET, 128)
            lanes = [((a & MASK) ^ (a & MASK) >> 47 ^ k) * P32[0] & MASK for a, k in zip(lanes, keys)]
    stripe(n - 64, 121)
    for i in range(4):
        acc += fold(lanes[2 * i] & MASK ^ u64(SECRET, 11 + 16 * i), lanes[2 * i + 1] & MASK ^ u64(SECRET, 19 + 16 * i))
    return avalanche(acc & MASK)
