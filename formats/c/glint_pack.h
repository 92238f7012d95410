/* glint_pack.h: reads a glintpack (the pack of GPU data that glint-bake writes) that lies in memory. C99 or C++11.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * All that there is to it is this file. It allocates nothing, calls nothing but memcpy and memcmp, takes bytes at any
 * address on hosts of either byte order, and never reads outside the bytes that it was given. The bytes are the caller's:
 * a file that was read or mapped. They stay where they are and as they are for as long as the pack is used.
 * docs/FORMAT.md describes every byte; the words here are its words.
 *
 *     glint_pack pack;
 *     glint_pack_section table;
 *     const unsigned char *words;
 *     size_t len;
 *     glint_pack_error error = glint_pack_open(file, file_len, &pack);
 *     if (!error) error = glint_pack_verify(&pack, NULL);
 *     if (!error) error = glint_pack_find(&pack, "SDTB", "dictionary", &table);
 *     if (!error) error = glint_pack_payload(&pack, &table, &words, &len);
 *     if (error) printf("G%04d %s\n", (int)error, glint_pack_error_text(error));
 *
 * Not done here: decompression (a section may be one Zstandard frame, which glint_pack_stored gives) and checks of what the
 * payloads of a method say (glint-info does those).
 */
#ifndef GLINT_PACK_H
#define GLINT_PACK_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Limits on what a file may ask of its reader; define them before the include to have others. The time of glint_pack_open grows
 * with the square of the number of sections, to 0.2 s for 65536. */

/* Most bytes of a file. */
#ifndef GLINT_PACK_MAX_FILE_BYTES
#define GLINT_PACK_MAX_FILE_BYTES ((uint64_t)4 << 30)
#endif
/* Most sections of a file. */
#ifndef GLINT_PACK_MAX_SECTIONS
#define GLINT_PACK_MAX_SECTIONS ((uint32_t)65536)
#endif
/* Most bytes that all sections may have together once they are decompressed. */
#ifndef GLINT_PACK_MAX_RAW_BYTES
#define GLINT_PACK_MAX_RAW_BYTES ((uint64_t)4 << 30)
#endif

/* Bytes of the header. */
#define GLINT_PACK_HEADER_BYTES 40
/* Bytes of an entry of the section table. */
#define GLINT_PACK_ENTRY_BYTES 136
/* Payloads start at multiples of this many bytes. */
#define GLINT_PACK_ALIGNMENT 256
/* Longest name of a section in bytes. */
#define GLINT_PACK_MAX_NAME_BYTES 63

#ifdef __cplusplus
extern "C" {
#endif

/* What went wrong. Numbers from 1001 on are the issues of docs/FORMAT.md, written there as G1001. */
typedef enum glint_pack_error {
    GLINT_PACK_OK = 0,
    /* A question of the caller's that the pack has no answer to. */
    GLINT_PACK_NOT_FOUND = 1,
    GLINT_PACK_COMPRESSED = 2,
    GLINT_PACK_NO_IMAGE = 3,
    /* The pack is not sound. */
    GLINT_PACK_FILE_TOO_SHORT = 1001,
    GLINT_PACK_BAD_MAGIC = 1002,
    GLINT_PACK_OVERLAPS_HEADER = 1003,
    GLINT_PACK_UNSUPPORTED_MAJOR = 1004,
    GLINT_PACK_FILE_LENGTH = 1005,
    GLINT_PACK_UNKNOWN_FLAGS = 1006,
    GLINT_PACK_TABLE_OUT_OF_FILE = 1007,
    GLINT_PACK_HEADER_CHECKSUM = 1008,
    GLINT_PACK_FILE_TOO_LARGE = 1009,
    GLINT_PACK_TOO_MANY_SECTIONS = 1010,
    GLINT_PACK_RAW_TOO_LARGE = 1011,
    GLINT_PACK_BAD_NAME = 1012,
    GLINT_PACK_DUPLICATE_SECTION = 1013,
    GLINT_PACK_UNKNOWN_CODEC = 1014,
    GLINT_PACK_BAD_REQUIRED_FLAG = 1015,
    GLINT_PACK_UNKNOWN_RESOURCE = 1016,
    GLINT_PACK_BAD_RESOURCE = 1017,
    GLINT_PACK_UNUSED_BYTES = 1018,
    GLINT_PACK_RAW_LENGTH = 1019,
    GLINT_PACK_STORED_LENGTH = 1020,
    GLINT_PACK_MISALIGNED = 1021,
    GLINT_PACK_SECTIONS_OVERLAP = 1022,
    GLINT_PACK_SECTION_GAP = 1023,
    GLINT_PACK_SECTION_OUT_OF_FILE = 1024,
    GLINT_PACK_TRAILING_BYTES = 1025,
    GLINT_PACK_PADDING_NOT_ZERO = 1026,
    GLINT_PACK_SECTION_CHECKSUM = 1027,
    GLINT_PACK_UNKNOWN_REQUIRED = 1030,
    GLINT_PACK_UNSUPPORTED_SECTION_VERSION = 1032
} glint_pack_error;

/* A pack that glint_pack_open found sound. Read its fields, do not write them. */
typedef struct glint_pack {
    const unsigned char *bytes; /* the caller's bytes */
    size_t size;                /* how many */
    uint16_t major;             /* version of the format: 1 */
    uint16_t minor;             /* a newer one than 0 adds kinds and nothing else */
    uint32_t section_count;     /* number of sections */
} glint_pack;

/* What a section holds, in the terms of a graphics API: the type of its resource descriptor. */
typedef enum glint_pack_resource_type {
    GLINT_PACK_PARAMETERS = 0, /* values one after the other, see "Parameters" in docs/FORMAT.md */
    GLINT_PACK_BUFFER = 1,     /* records of equal size */
    GLINT_PACK_TEXTURE = 2     /* texels, in the order that glint_pack_image_at knows */
} glint_pack_resource_type;

/* Resource descriptor of a section. Fields that its type does not use are 0. */
typedef struct glint_pack_resource {
    glint_pack_resource_type type;
    uint32_t stride;    /* buffer: bytes of a record, at least 1 */
    uint64_t count;     /* buffer: number of records */
    uint32_t vk_format; /* texture: VkFormat number, see glint_pack_format_name */
    uint32_t width;     /* texture: of mip 0 in texels, at least 1 */
    uint32_t height;    /* texture: of mip 0 in texels, at least 1 */
    uint32_t layers;    /* texture: array layers, at least 1 */
    uint32_t faces;     /* texture: 1, or 6 for a cube in the order +X -X +Y -Y +Z -Z */
    uint32_t mips;      /* texture: mips, at least 1 */
} glint_pack_resource;

/* How a payload is stored. */
typedef enum glint_pack_codec {
    GLINT_PACK_CODEC_NONE = 0, /* as it is */
    GLINT_PACK_CODEC_ZSTD = 1  /* one Zstandard frame */
} glint_pack_codec;

/* Entry of a section in the table. */
typedef struct glint_pack_section {
    char kind[5];  /* four characters and a zero; characters that do not print are possible where `known` is 0 */
    char name[64]; /* material that it belongs to, UTF-8 and a zero; empty for a section of the whole pack */
    uint16_t version; /* version of this kind's own layout */
    int required;     /* 1: a program that does not know the kind refuses the pack; 0: it skips the section */
    int known;        /* 1: format 1.0 has this kind in this version; 0: skip it, unless you know it from elsewhere */
    glint_pack_codec codec;
    glint_pack_resource resource;
    uint64_t offset;     /* where the stored payload starts, in bytes from the start of the file */
    uint64_t stored_len; /* bytes of the payload in the file */
    uint64_t raw_len;    /* bytes of the payload once it is decompressed */
    uint64_t checksum;   /* XXH3-64 of the stored bytes */
} glint_pack_section;

/* One image of a texture: one mip of one layer of one face. */
typedef struct glint_pack_image {
    uint32_t width;   /* texels */
    uint32_t height;  /* texels */
    uint64_t offset;  /* where it starts, in bytes from the start of the decompressed payload */
    uint64_t len;     /* bytes; rows follow each other without padding, the top one first */
    uint64_t row_len; /* bytes of a row */
} glint_pack_image;

/* ---- Little-endian numbers ---- */

/* The two bytes at `p` as a number, the first one the least. The caller answers for their being there. */
static inline uint16_t glint_pack_le16(const unsigned char *p) {
    return (uint16_t)((unsigned)p[0] | (unsigned)p[1] << 8);
}

/* The four bytes at `p` as a number, the first one the least. The caller answers for their being there. */
static inline uint32_t glint_pack_le32(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* The eight bytes at `p` as a number, the first one the least. The caller answers for their being there. */
static inline uint64_t glint_pack_le64(const unsigned char *p) {
    return (uint64_t)p[0] | (uint64_t)p[1] << 8 | (uint64_t)p[2] << 16 | (uint64_t)p[3] << 24 | (uint64_t)p[4] << 32 |
           (uint64_t)p[5] << 40 | (uint64_t)p[6] << 48 | (uint64_t)p[7] << 56;
}

/* The number that the bits of a half float (IEEE 754 binary16) stand for; exact, infinities and NaN too. */
static inline float glint_pack_half(uint16_t bits) {
    uint32_t sign = (uint32_t)(bits & 0x8000u) << 16;
    uint32_t exponent = (bits >> 10) & 31u;
    uint32_t fraction = bits & 1023u;
    uint32_t single;
    float value;
    if (exponent == 0) {
        /* A subnormal counts steps of 2^-24, which single floats hold exactly. */
        value = (float)fraction * (1.0f / 16777216.0f);
        return sign ? -value : value;
    }
    single = exponent == 31 ? 0x7F800000u : (exponent + 112u) << 23;
    single |= sign | fraction << 13;
    memcpy(&value, &single, sizeof value);
    return value;
}

/* ---- Checksum: XXH3-64 with seed 0 and the default secret, after xxHash's specification ---- */

#define GLINT_PACK_IMPL_PRIME32_1 0x9E3779B1ull
#define GLINT_PACK_IMPL_PRIME32_2 0x85EBCA77ull
#define GLINT_PACK_IMPL_PRIME32_3 0xC2B2AE3Dull
#define GLINT_PACK_IMPL_PRIME64_1 0x9E3779B185EBCA87ull
#define GLINT_PACK_IMPL_PRIME64_2 0xC2B2AE3D27D4EB4Full
#define GLINT_PACK_IMPL_PRIME64_3 0x165667B19E3779F9ull
#define GLINT_PACK_IMPL_PRIME64_4 0x85EBCA77C2B2AE63ull
#define GLINT_PACK_IMPL_PRIME64_5 0x27D4EB2F165667C5ull

/* The default secret, from byte `at` on; it has 192 bytes. */
static inline const unsigned char *glint_pack_impl_secret(size_t at) {
    static const unsigned char secret[192] = {
        0xb8, 0xfe, 0x6c, 0x39, 0x23, 0xa4, 0x4b, 0xbe, 0x7c, 0x01, 0x81, 0x2c, 0xf7, 0x21, 0xad, 0x1c,
        0xde, 0xd4, 0x6d, 0xe9, 0x83, 0x90, 0x97, 0xdb, 0x72, 0x40, 0xa4, 0xa4, 0xb7, 0xb3, 0x67, 0x1f,
        0xcb, 0x79, 0xe6, 0x4e, 0xcc, 0xc0, 0xe5, 0x78, 0x82, 0x5a, 0xd0, 0x7d, 0xcc, 0xff, 0x72, 0x21,
        0xb8, 0x08, 0x46, 0x74, 0xf7, 0x43, 0x24, 0x8e, 0xe0, 0x35, 0x90, 0xe6, 0x81, 0x3a, 0x26, 0x4c,
        0x3c, 0x28, 0x52, 0xbb, 0x91, 0xc3, 0x00, 0xcb, 0x88, 0xd0, 0x65, 0x8b, 0x1b, 0x53, 0x2e, 0xa3,
        0x71, 0x64, 0x48, 0x97, 0xa2, 0x0d, 0xf9, 0x4e, 0x38, 0x19, 0xef, 0x46, 0xa9, 0xde, 0xac, 0xd8,
        0xa8, 0xfa, 0x76, 0x3f, 0xe3, 0x9c, 0x34, 0x3f, 0xf9, 0xdc, 0xbb, 0xc7, 0xc7, 0x0b, 0x4f, 0x1d,
        0x8a, 0x51, 0xe0, 0x4b, 0xcd, 0xb4, 0x59, 0x31, 0xc8, 0x9f, 0x7e, 0xc9, 0xd9, 0x78, 0x73, 0x64,
        0xea, 0xc5, 0xac, 0x83, 0x34, 0xd3, 0xeb, 0xc3, 0xc5, 0x81, 0xa0, 0xff, 0xfa, 0x13, 0x63, 0xeb,
        0x17, 0x0d, 0xdd, 0x51, 0xb7, 0xf0, 0xda, 0x49, 0xd3, 0x16, 0x55, 0x26, 0x29, 0xd4, 0x68, 0x9e,
        0x2b, 0x16, 0xbe, 0x58, 0x7d, 0x47, 0xa1, 0xfc, 0x8f, 0xf8, 0xb8, 0xd1, 0x7a, 0xd0, 0x31, 0xce,
        0x45, 0xcb, 0x3a, 0x8f, 0x95, 0x16, 0x04, 0x28, 0xaf, 0xd7, 0xfb, 0xca, 0xbb, 0x4b, 0x40, 0x7e};
    return secret + at;
}

/* Eight bytes of the secret as a number. */
static inline uint64_t glint_pack_impl_secret64(size_t at) {
    return glint_pack_le64(glint_pack_impl_secret(at));
}

/* Bits turned to the left, by 1 to 63. */
static inline uint64_t glint_pack_impl_rotate(uint64_t value, unsigned by) {
    return value << by | value >> (64 - by);
}

/* Lower half of the product xor its upper half; by halves, as C has no product of 128 bits. */
static inline uint64_t glint_pack_impl_fold(uint64_t a, uint64_t b) {
    uint64_t a0 = a & 0xFFFFFFFFull, a1 = a >> 32, b0 = b & 0xFFFFFFFFull, b1 = b >> 32;
    uint64_t low = a0 * b0;
    uint64_t middle = a1 * b0 + (low >> 32);
    uint64_t other = a0 * b1 + (middle & 0xFFFFFFFFull);
    uint64_t high = a1 * b1 + (middle >> 32) + (other >> 32);
    return (other << 32 | (low & 0xFFFFFFFFull)) ^ high;
}

/* Last step of XXH3. */
static inline uint64_t glint_pack_impl_avalanche(uint64_t h) {
    h = (h ^ h >> 37) * 0x165667919E3779F9ull;
    return h ^ h >> 32;
}

/* Last step of XXH64, which the shortest inputs take. */
static inline uint64_t glint_pack_impl_avalanche64(uint64_t h) {
    h = (h ^ h >> 33) * GLINT_PACK_IMPL_PRIME64_2;
    h = (h ^ h >> 29) * GLINT_PACK_IMPL_PRIME64_3;
    return h ^ h >> 32;
}

/* Sixteen bytes of input with sixteen of the secret. */
static inline uint64_t glint_pack_impl_mix16(const unsigned char *p, size_t secret) {
    return glint_pack_impl_fold(glint_pack_le64(p) ^ glint_pack_impl_secret64(secret),
                                glint_pack_le64(p + 8) ^ glint_pack_impl_secret64(secret + 8));
}

/* Inputs of 0 to 16 bytes. */
static inline uint64_t glint_pack_impl_xxh3_16(const unsigned char *p, size_t n) {
    if (n > 8) {
        uint64_t low = glint_pack_le64(p) ^ glint_pack_impl_secret64(24) ^ glint_pack_impl_secret64(32);
        uint64_t high = glint_pack_le64(p + n - 8) ^ glint_pack_impl_secret64(40) ^ glint_pack_impl_secret64(48);
        uint64_t turned = 0;
        unsigned i;
        for (i = 0; i < 8; i++)
            turned = turned << 8 | (low >> (8 * i) & 0xFFu);
        return glint_pack_impl_avalanche(n + turned + high + glint_pack_impl_fold(low, high));
    }
    if (n > 3) {
        uint64_t h = (uint64_t)glint_pack_le32(p) << 32 | glint_pack_le32(p + n - 4);
        h ^= glint_pack_impl_secret64(8) ^ glint_pack_impl_secret64(16);
        h ^= glint_pack_impl_rotate(h, 49) ^ glint_pack_impl_rotate(h, 24);
        h *= 0x9FB21C651E98DF25ull;
        h ^= (h >> 35) + n;
        h *= 0x9FB21C651E98DF25ull;
        return h ^ h >> 28;
    }
    if (n > 0) {
        uint32_t all = (uint32_t)p[0] << 16 | (uint32_t)p[n >> 1] << 24 | (uint32_t)p[n - 1] | (uint32_t)n << 8;
        uint32_t key = glint_pack_le32(glint_pack_impl_secret(0)) ^ glint_pack_le32(glint_pack_impl_secret(4));
        return glint_pack_impl_avalanche64(all ^ key);
    }
    return glint_pack_impl_avalanche64(glint_pack_impl_secret64(56) ^ glint_pack_impl_secret64(64));
}

/* Inputs of 0 to 240 bytes. */
static inline uint64_t glint_pack_impl_xxh3_240(const unsigned char *p, size_t n) {
    uint64_t sum = n * GLINT_PACK_IMPL_PRIME64_1;
    size_t i;
    if (n <= 16)
        return glint_pack_impl_xxh3_16(p, n);
    if (n <= 128) {
        /* Pairs of sixteen bytes from both ends towards the middle. */
        for (i = 0; i <= (n - 1) / 32; i++) {
            sum += glint_pack_impl_mix16(p + 16 * i, 32 * i);
            sum += glint_pack_impl_mix16(p + n - 16 * (i + 1), 32 * i + 16);
        }
        return glint_pack_impl_avalanche(sum);
    }
    for (i = 0; i < 8; i++)
        sum += glint_pack_impl_mix16(p + 16 * i, 16 * i);
    sum = glint_pack_impl_avalanche(sum);
    for (i = 8; i < n / 16; i++)
        sum += glint_pack_impl_mix16(p + 16 * i, 16 * (i - 8) + 3);
    sum += glint_pack_impl_mix16(p + n - 16, 136 - 17);
    return glint_pack_impl_avalanche(sum);
}

/* Adds a stripe of 64 bytes to the eight sums of long inputs. */
static inline void glint_pack_impl_stripe(uint64_t sums[8], const unsigned char *p, const unsigned char *secret) {
    size_t i;
    for (i = 0; i < 8; i++) {
        uint64_t value = glint_pack_le64(p + 8 * i);
        uint64_t keyed = value ^ glint_pack_le64(secret + 8 * i);
        sums[i ^ 1] += value;
        sums[i] += (keyed & 0xFFFFFFFFull) * (keyed >> 32);
    }
}

/* Inputs of more than 240 bytes. The first 64 of them are taken from `first`, which is `p` but for the header. */
static inline uint64_t glint_pack_impl_xxh3_long(const unsigned char *first, const unsigned char *p, size_t n) {
    uint64_t sums[8] = {GLINT_PACK_IMPL_PRIME32_3, GLINT_PACK_IMPL_PRIME64_1, GLINT_PACK_IMPL_PRIME64_2,
                        GLINT_PACK_IMPL_PRIME64_3, GLINT_PACK_IMPL_PRIME64_4, GLINT_PACK_IMPL_PRIME32_2,
                        GLINT_PACK_IMPL_PRIME64_5, GLINT_PACK_IMPL_PRIME32_1};
    uint64_t sum = n * GLINT_PACK_IMPL_PRIME64_1;
    size_t stripe, i;
    for (stripe = 0; stripe < (n - 1) / 64; stripe++) {
        size_t place = stripe % 16;
        glint_pack_impl_stripe(sums, stripe == 0 ? first : p + 64 * stripe, glint_pack_impl_secret(8 * place));
        if (place == 15) {
            /* Sixteen stripes are a block, after which the sums are scrambled. */
            for (i = 0; i < 8; i++) {
                uint64_t keyed = sums[i] ^ sums[i] >> 47 ^ glint_pack_impl_secret64(128 + 8 * i);
                sums[i] = keyed * GLINT_PACK_IMPL_PRIME32_1;
            }
        }
    }
    glint_pack_impl_stripe(sums, p + n - 64, glint_pack_impl_secret(192 - 64 - 7));
    for (i = 0; i < 4; i++)
        sum += glint_pack_impl_fold(sums[2 * i] ^ glint_pack_impl_secret64(11 + 16 * i),
                                    sums[2 * i + 1] ^ glint_pack_impl_secret64(19 + 16 * i));
    return glint_pack_impl_avalanche(sum);
}

/* XXH3-64 (seed 0) of `size` bytes: the checksum of packs. Any size, 0 too. */
static inline uint64_t glint_pack_xxh3_64(const void *bytes, size_t size) {
    const unsigned char *p = (const unsigned char *)bytes;
    return size <= 240 ? glint_pack_impl_xxh3_240(p, size) : glint_pack_impl_xxh3_long(p, p, size);
}

/* XXH3-64 of header and table, `size` bytes, with zeros in place of the checksum itself. At least 40 bytes. */
static inline uint64_t glint_pack_impl_header_checksum(const unsigned char *bytes, size_t size) {
    static const unsigned char zeros[8] = {0};
    unsigned char head[240];
    memcpy(head, bytes, size < sizeof head ? size : sizeof head);
    memcpy(head + 32, zeros, sizeof zeros);
    return size <= sizeof head ? glint_pack_impl_xxh3_240(head, size) : glint_pack_impl_xxh3_long(head, bytes, size);
}

/* ---- Texture formats ---- */

/* Name of a VkFormat without the VK_FORMAT_ in front, as R8_UNORM, and the bytes of a texel. NULL, and 0 bytes, for a number
 * that packs of version 1.0 do not use. `texel_bytes` may be NULL. */
static inline const char *glint_pack_format_name(uint32_t vk_format, uint32_t *texel_bytes) {
    static const struct {
        uint32_t number, texel_bytes;
        const char *name;
    } formats[] = {
        {9, 1, "R8_UNORM"},
        {10, 1, "R8_SNORM"},
        {13, 1, "R8_UINT"},
        {16, 2, "R8G8_UNORM"},
        {17, 2, "R8G8_SNORM"},
        {37, 4, "R8G8B8A8_UNORM"},
        {38, 4, "R8G8B8A8_SNORM"},
        {41, 4, "R8G8B8A8_UINT"},
        {70, 2, "R16_UNORM"},
        {71, 2, "R16_SNORM"},
        {74, 2, "R16_UINT"},
        {76, 2, "R16_SFLOAT"},
        {77, 4, "R16G16_UNORM"},
        {78, 4, "R16G16_SNORM"},
        {81, 4, "R16G16_UINT"},
        {83, 4, "R16G16_SFLOAT"},
        {91, 8, "R16G16B16A16_UNORM"},
        {92, 8, "R16G16B16A16_SNORM"},
        {95, 8, "R16G16B16A16_UINT"},
        {97, 8, "R16G16B16A16_SFLOAT"},
        {98, 4, "R32_UINT"},
        {100, 4, "R32_SFLOAT"},
        {101, 8, "R32G32_UINT"},
        {103, 8, "R32G32_SFLOAT"},
        {107, 16, "R32G32B32A32_UINT"},
        {109, 16, "R32G32B32A32_SFLOAT"},
        {122, 4, "B10G11R11_UFLOAT_PACK32"},
        {123, 4, "E5B9G9R9_UFLOAT_PACK32"},
    };
    size_t i;
    for (i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        if (formats[i].number == vk_format) {
            if (texel_bytes)
                *texel_bytes = formats[i].texel_bytes;
            return formats[i].name;
        }
    }
    if (texel_bytes)
        *texel_bytes = 0;
    return NULL;
}

/* Whether format 1.0 has the kind of these four bytes. All its kinds have section version 1. */
static inline int glint_pack_impl_kind_is_known(const unsigned char *kind) {
    static const char kinds[] = "PROV" "NMPP" "NMUB" "NMND" "NMDE" "NMNO" "PLPP" "PLNO" "PLCL" "LAYR" "LAUB" "SDPP" "SDUB"
                                "SDTB" "GLPP" "GLUB" "GLCO" "GLLI" "GLLT" "ENPP" "ENUB" "ENMI" "ENRA" "ENIN" "ENCO" "ENAL"
                                "ALPP" "ALUB" "ALNM" "ALRO" "ALLI" "ALLT" "LOPP" "LOUB" "LOBE" "LONM" "SYPP" "SYPO" "SYSE";
    size_t i;
    for (i = 0; i + 4 < sizeof kinds; i += 4) {
        if (memcmp(kinds + i, kind, 4) == 0)
            return 1;
    }
    return 0;
}

/* ---- Opening ---- */

/* Multiplies `value` by `by`; 0 where the product would not fit 64 bits. */
static inline int glint_pack_impl_multiply(uint64_t *value, uint64_t by) {
    if (by != 0 && *value > UINT64_MAX / by)
        return 0;
    *value *= by;
    return 1;
}

/* Length of an edge, in texels, at a mip below 32. */
static inline uint32_t glint_pack_impl_mip_edge(uint32_t edge, uint32_t mip) {
    return edge >> mip ? edge >> mip : 1;
}

/* Whether a texture of such sizes can be. */
static inline int glint_pack_impl_texture_is_possible(const glint_pack_resource *of) {
    uint32_t edge = of->width > of->height ? of->width : of->height;
    uint32_t full_mips = 0;
    if (of->width == 0 || of->height == 0 || of->layers == 0)
        return 0;
    if (of->faces != 1 && (of->faces != 6 || of->width != of->height))
        return 0;
    for (; edge != 0; edge >>= 1)
        full_mips++;
    return of->mips >= 1 && of->mips <= full_mips;
}

/* Bytes of a payload of this resource; `*says` is 0 where the descriptor does not tell, which is so for parameters and for
 * textures of an unknown VkFormat. */
static inline glint_pack_error glint_pack_impl_raw_len(const glint_pack_resource *of, int *says, uint64_t *len) {
    uint32_t texel_bytes, mip;
    *says = 0;
    *len = 0;
    if (of->type == GLINT_PACK_BUFFER) {
        *says = 1;
        *len = of->count;
        return of->stride != 0 && glint_pack_impl_multiply(len, of->stride) ? GLINT_PACK_OK : GLINT_PACK_BAD_RESOURCE;
    }
    if (of->type != GLINT_PACK_TEXTURE)
        return GLINT_PACK_OK;
    if (!glint_pack_impl_texture_is_possible(of))
        return GLINT_PACK_BAD_RESOURCE;
    if (!glint_pack_format_name(of->vk_format, &texel_bytes))
        return GLINT_PACK_OK;
    *says = 1;
    for (mip = 0; mip < of->mips; mip++) {
        uint64_t texels = glint_pack_impl_mip_edge(of->width, mip);
        texels *= glint_pack_impl_mip_edge(of->height, mip);
        if (*len > UINT64_MAX - texels)
            return GLINT_PACK_BAD_RESOURCE;
        *len += texels;
    }
    if (!glint_pack_impl_multiply(len, of->layers) || !glint_pack_impl_multiply(len, of->faces) ||
        !glint_pack_impl_multiply(len, texel_bytes))
        return GLINT_PACK_BAD_RESOURCE;
    return GLINT_PACK_OK;
}

/* Whether a name field of 64 bytes, its length first, holds UTF-8 without control characters and then zeros. */
static inline int glint_pack_impl_name_is_good(const unsigned char *field) {
    const unsigned char *name = field + 1;
    size_t len = field[0], at = 0, i;
    if (len > GLINT_PACK_MAX_NAME_BYTES)
        return 0;
    for (i = len; i < GLINT_PACK_MAX_NAME_BYTES; i++) {
        if (name[i] != 0)
            return 0;
    }
    while (at < len) {
        uint32_t code = name[at++], least = 0;
        size_t more = 0;
        if (code >= 0xF8 || (code >= 0x80 && code < 0xC0))
            return 0;
        if (code >= 0xF0) {
            more = 3;
            least = 0x10000;
            code &= 7;
        } else if (code >= 0xE0) {
            more = 2;
            least = 0x800;
            code &= 15;
        } else if (code >= 0xC0) {
            more = 1;
            least = 0x80;
            code &= 31;
        }
        if (more > len - at)
            return 0;
        for (i = 0; i < more; i++) {
            uint32_t byte = name[at++];
            if ((byte & 0xC0) != 0x80)
                return 0;
            code = code << 6 | (byte & 0x3F);
        }
        /* Longer than it need be, half of a surrogate pair, beyond Unicode. */
        if (code < least || (code >= 0xD800 && code < 0xE000) || code > 0x10FFFF)
            return 0;
        if (code < 0x20 || (code >= 0x7F && code < 0xA0))
            return 0;
    }
    return 1;
}

/* Takes the 136 bytes of an entry apart, sound or not. */
static inline void glint_pack_impl_entry(const unsigned char *entry, glint_pack_section *out) {
    uint32_t type = glint_pack_le32(entry + 40);
    glint_pack_resource none = {GLINT_PACK_PARAMETERS, 0, 0, 0, 0, 0, 0, 0, 0};
    memcpy(out->kind, entry, 4);
    out->kind[4] = 0;
    memcpy(out->name, entry + 73, GLINT_PACK_MAX_NAME_BYTES);
    out->name[GLINT_PACK_MAX_NAME_BYTES] = 0;
    out->version = glint_pack_le16(entry + 4);
    out->required = entry[6] != 0;
    out->known = out->version == 1 && glint_pack_impl_kind_is_known(entry);
    out->codec = entry[7] == 0 ? GLINT_PACK_CODEC_NONE : GLINT_PACK_CODEC_ZSTD;
    out->resource = none;
    if (type == GLINT_PACK_BUFFER) {
        out->resource.type = GLINT_PACK_BUFFER;
        out->resource.stride = glint_pack_le32(entry + 44);
        out->resource.count = glint_pack_le64(entry + 48);
    } else if (type == GLINT_PACK_TEXTURE) {
        out->resource.type = GLINT_PACK_TEXTURE;
        out->resource.vk_format = glint_pack_le32(entry + 44);
        out->resource.width = glint_pack_le32(entry + 48);
        out->resource.height = glint_pack_le32(entry + 52);
        out->resource.layers = glint_pack_le32(entry + 56);
        out->resource.faces = glint_pack_le32(entry + 60);
        out->resource.mips = glint_pack_le32(entry + 64);
    }
    out->offset = glint_pack_le64(entry + 8);
    out->stored_len = glint_pack_le64(entry + 16);
    out->raw_len = glint_pack_le64(entry + 24);
    out->checksum = glint_pack_le64(entry + 32);
}

/* What can be said of one entry without the others. */
static inline glint_pack_error glint_pack_impl_check_entry(const unsigned char *entry) {
    /* First byte of the resource descriptor that each of its types leaves zero. */
    static const size_t unused[3] = {4, 16, 28};
    glint_pack_section section;
    glint_pack_error error;
    uint64_t expected;
    int says;
    size_t i;
    if (!glint_pack_impl_name_is_good(entry + 72))
        return GLINT_PACK_BAD_NAME;
    if (entry[6] > 1)
        return GLINT_PACK_BAD_REQUIRED_FLAG;
    if (entry[7] > 1)
        return GLINT_PACK_UNKNOWN_CODEC;
    if (glint_pack_le32(entry + 40) > 2)
        return GLINT_PACK_UNKNOWN_RESOURCE;
    for (i = unused[glint_pack_le32(entry + 40)]; i < 32; i++) {
        if (entry[40 + i] != 0)
            return GLINT_PACK_UNUSED_BYTES;
    }
    glint_pack_impl_entry(entry, &section);
    error = glint_pack_impl_raw_len(&section.resource, &says, &expected);
    if (error)
        return error;
    if (says && expected != section.raw_len)
        return GLINT_PACK_RAW_LENGTH;
    if (section.codec == GLINT_PACK_CODEC_NONE && section.stored_len != section.raw_len)
        return GLINT_PACK_STORED_LENGTH;
    return GLINT_PACK_OK;
}

/* The entry of a section of the pack, whose index the caller has checked. */
static inline const unsigned char *glint_pack_impl_entry_at(const glint_pack *pack, uint32_t index) {
    return pack->bytes + GLINT_PACK_HEADER_BYTES + (size_t)index * GLINT_PACK_ENTRY_BYTES;
}

/* Whether two entries have the same kind and name. */
static inline int glint_pack_impl_same_key(const unsigned char *a, const unsigned char *b) {
    return memcmp(a, b, 4) == 0 && memcmp(a + 72, b + 72, 64) == 0;
}

/* Whether two sections have the same kind and name. Without memory for all of them, 512 sections at a time are kept in a hash
 * table, in which those after them are looked up. */
static inline int glint_pack_impl_has_duplicates(const glint_pack *pack) {
    uint32_t first, index;
    for (first = 0; first < pack->section_count; first += 512) {
        uint16_t places[1024] = {0}; /* 0: empty; else 1 + position of a section among the 512 */
        for (index = first; index < pack->section_count; index++) {
            const unsigned char *entry = glint_pack_impl_entry_at(pack, index);
            uint64_t hash = glint_pack_xxh3_64(entry + 72, 64) ^ glint_pack_le32(entry) * GLINT_PACK_IMPL_PRIME64_1;
            size_t place = (size_t)(hash >> 54);
            while (places[place] != 0) {
                if (glint_pack_impl_same_key(glint_pack_impl_entry_at(pack, first + places[place] - 1u), entry))
                    return 1;
                place = (place + 1) % 1024;
            }
            if (index - first < 512)
                places[place] = (uint16_t)(index - first + 1);
        }
    }
    return 0;
}

/* Whether payloads fill the file from the table's end on as the one allowed layout says. */
static inline glint_pack_error glint_pack_impl_check_layout(const glint_pack *pack) {
    uint64_t table_end = GLINT_PACK_HEADER_BYTES + (uint64_t)pack->section_count * GLINT_PACK_ENTRY_BYTES;
    uint64_t end = table_end, at;
    uint32_t index;
    for (index = 0; index < pack->section_count; index++) {
        glint_pack_section section;
        glint_pack_impl_entry(glint_pack_impl_entry_at(pack, index), &section);
        if (section.offset < table_end)
            return GLINT_PACK_OVERLAPS_HEADER;
        if (section.offset < end)
            return GLINT_PACK_SECTIONS_OVERLAP;
        if (section.offset % GLINT_PACK_ALIGNMENT != 0)
            return GLINT_PACK_MISALIGNED;
        if (section.offset - end >= GLINT_PACK_ALIGNMENT)
            return GLINT_PACK_SECTION_GAP;
        if (section.offset > pack->size || section.stored_len > pack->size - section.offset)
            return GLINT_PACK_SECTION_OUT_OF_FILE;
        for (at = end; at < section.offset; at++) {
            if (pack->bytes[at] != 0)
                return GLINT_PACK_PADDING_NOT_ZERO;
        }
        end = section.offset + section.stored_len;
    }
    return end == pack->size ? GLINT_PACK_OK : GLINT_PACK_TRAILING_BYTES;
}

/* Whether the sections together keep to the limit, and whether those that are required are known. */
static inline glint_pack_error glint_pack_impl_check_sections(const glint_pack *pack) {
    uint64_t total = 0;
    uint32_t index;
    for (index = 0; index < pack->section_count; index++) {
        uint64_t raw_len = glint_pack_le64(glint_pack_impl_entry_at(pack, index) + 24);
        if (raw_len > GLINT_PACK_MAX_RAW_BYTES || total > GLINT_PACK_MAX_RAW_BYTES - raw_len)
            return GLINT_PACK_RAW_TOO_LARGE;
        total += raw_len;
    }
    for (index = 0; index < pack->section_count; index++) {
        const unsigned char *entry = glint_pack_impl_entry_at(pack, index);
        glint_pack_section section;
        glint_pack_impl_entry(entry, &section);
        if (section.required && !section.known)
            return glint_pack_impl_kind_is_known(entry) ? GLINT_PACK_UNSUPPORTED_SECTION_VERSION
                                                        : GLINT_PACK_UNKNOWN_REQUIRED;
    }
    return GLINT_PACK_OK;
}

/* What can be said of the header, `out` filled from it. */
static inline glint_pack_error glint_pack_impl_check_header(const unsigned char *bytes, size_t size, glint_pack *out) {
    static const unsigned char magic[12] = {0xAB, 'G', 'L', 'I', 'N', 'T', 'P', 0xBB, '\r', '\n', 0x1A, '\n'};
    uint64_t largest = size, stated_len, table_end;
    if (size < GLINT_PACK_HEADER_BYTES)
        return GLINT_PACK_FILE_TOO_SHORT;
    if (memcmp(bytes, magic, sizeof magic) != 0)
        return GLINT_PACK_BAD_MAGIC;
    out->bytes = bytes;
    out->size = size;
    out->major = glint_pack_le16(bytes + 12);
    out->minor = glint_pack_le16(bytes + 14);
    out->section_count = glint_pack_le32(bytes + 16);
    stated_len = glint_pack_le64(bytes + 24);
    /* The version comes first, as another one may lay out the rest in another way. */
    if (out->major != 1)
        return GLINT_PACK_UNSUPPORTED_MAJOR;
    if (stated_len > largest)
        largest = stated_len;
    if (largest > GLINT_PACK_MAX_FILE_BYTES)
        return GLINT_PACK_FILE_TOO_LARGE;
    if (stated_len != size)
        return GLINT_PACK_FILE_LENGTH;
    if (out->section_count > GLINT_PACK_MAX_SECTIONS)
        return GLINT_PACK_TOO_MANY_SECTIONS;
    table_end = GLINT_PACK_HEADER_BYTES + (uint64_t)out->section_count * GLINT_PACK_ENTRY_BYTES;
    if (table_end > size)
        return GLINT_PACK_TABLE_OUT_OF_FILE;
    if (glint_pack_impl_header_checksum(bytes, (size_t)table_end) != glint_pack_le64(bytes + 32))
        return GLINT_PACK_HEADER_CHECKSUM;
    if (glint_pack_le32(bytes + 20) != 0)
        return GLINT_PACK_UNKNOWN_FLAGS;
    return GLINT_PACK_OK;
}

/* All that glint_pack_open checks. */
static inline glint_pack_error glint_pack_impl_check(const unsigned char *bytes, size_t size, glint_pack *out) {
    glint_pack_error error = glint_pack_impl_check_header(bytes, size, out);
    uint32_t index;
    if (error)
        return error;
    for (index = 0; index < out->section_count; index++) {
        error = glint_pack_impl_check_entry(glint_pack_impl_entry_at(out, index));
        if (error)
            return error;
    }
    if (glint_pack_impl_has_duplicates(out))
        return GLINT_PACK_DUPLICATE_SECTION;
    error = glint_pack_impl_check_layout(out);
    if (error)
        return error;
    return glint_pack_impl_check_sections(out);
}

/* Opens a pack of `size` bytes and checks all but the payloads: header, its checksum, every entry of the table, layout,
 * padding, the limits above, and that required sections are of known kinds. Time is that of reading header and table.
 * GLINT_PACK_OK, or the first error that was found; `out` is then a pack without sections. `bytes` may have any address; NULL
 * is allowed with size 0. */
static inline glint_pack_error glint_pack_open(const void *bytes, size_t size, glint_pack *out) {
    static const glint_pack empty = {NULL, 0, 0, 0, 0};
    glint_pack_error error;
    *out = empty;
    error = glint_pack_impl_check((const unsigned char *)bytes, size, out);
    if (error)
        *out = empty;
    return error;
}

/* ---- Sections ---- */

/* Entry of the section with this index, 0 to section_count - 1, in the order of the table. GLINT_PACK_NOT_FOUND beyond, which
 * leaves `out` as it was. */
static inline glint_pack_error glint_pack_section_at(const glint_pack *pack, uint32_t index, glint_pack_section *out) {
    if (index >= pack->section_count)
        return GLINT_PACK_NOT_FOUND;
    glint_pack_impl_entry(glint_pack_impl_entry_at(pack, index), out);
    return GLINT_PACK_OK;
}

/* Whether a string of four characters is the kind of a section. */
static inline int glint_pack_is_kind(const glint_pack_section *section, const char *kind) {
    size_t i;
    for (i = 0; i < 4; i++) {
        if (kind[i] == 0 || kind[i] != section->kind[i])
            return 0;
    }
    return kind[4] == 0;
}

/* The section of a kind, as "SDTB", and a name; a pack has one at most. `name` is the material's, "" for sections of the whole
 * pack; NULL stands for any name, and gives the first section of the kind. GLINT_PACK_NOT_FOUND where there is none, which
 * leaves `out` as it was. Time grows with the number of sections. */
static inline glint_pack_error glint_pack_find(const glint_pack *pack, const char *kind, const char *name,
                                               glint_pack_section *out) {
    glint_pack_section section;
    uint32_t index;
    for (index = 0; glint_pack_section_at(pack, index, &section) == GLINT_PACK_OK; index++) {
        size_t i = 0;
        if (!glint_pack_is_kind(&section, kind))
            continue;
        while (name && section.name[i] != 0 && section.name[i] == name[i])
            i++;
        if (!name || section.name[i] == name[i]) {
            *out = section;
            return GLINT_PACK_OK;
        }
    }
    return GLINT_PACK_NOT_FOUND;
}

/* The section of a kind that comes `nth`, from 0, among those of this kind: for packs of several materials. Its name is in
 * `out`. GLINT_PACK_NOT_FOUND where the kind has fewer, which leaves `out` as it was. */
static inline glint_pack_error glint_pack_find_nth(const glint_pack *pack, const char *kind, uint32_t nth,
                                                   glint_pack_section *out) {
    glint_pack_section section;
    uint32_t index;
    for (index = 0; glint_pack_section_at(pack, index, &section) == GLINT_PACK_OK; index++) {
        if (glint_pack_is_kind(&section, kind) && nth-- == 0) {
            *out = section;
            return GLINT_PACK_OK;
        }
    }
    return GLINT_PACK_NOT_FOUND;
}

/* The bytes of a section as the file stores them, `*len` of them: the payload, or its Zstandard frame where the section is
 * compressed. GLINT_PACK_SECTION_OUT_OF_FILE where the entry is not of this pack; `*bytes` is then NULL and `*len` 0. */
static inline glint_pack_error glint_pack_stored(const glint_pack *pack, const glint_pack_section *section,
                                                 const unsigned char **bytes, size_t *len) {
    *bytes = NULL;
    *len = 0;
    if (!pack->bytes || section->offset > pack->size || section->stored_len > pack->size - section->offset)
        return GLINT_PACK_SECTION_OUT_OF_FILE;
    *bytes = pack->bytes + (size_t)section->offset;
    *len = (size_t)section->stored_len;
    return GLINT_PACK_OK;
}

/* The payload of a section, `*len` bytes, which lie in the caller's bytes at a multiple of 256 from their start: upload them as
 * they are. GLINT_PACK_COMPRESSED where they have to be decompressed first, from glint_pack_stored into raw_len bytes, and
 * GLINT_PACK_SECTION_OUT_OF_FILE where the entry is not of this pack; `*bytes` is then NULL and `*len` 0. */
static inline glint_pack_error glint_pack_payload(const glint_pack *pack, const glint_pack_section *section,
                                                  const unsigned char **bytes, size_t *len) {
    *bytes = NULL;
    *len = 0;
    if (section->codec != GLINT_PACK_CODEC_NONE)
        return GLINT_PACK_COMPRESSED;
    return glint_pack_stored(pack, section, bytes, len);
}

/* Compares a section's stored bytes with its checksum: GLINT_PACK_OK, GLINT_PACK_SECTION_CHECKSUM where they were changed, or
 * GLINT_PACK_SECTION_OUT_OF_FILE where the entry is not of this pack. */
static inline glint_pack_error glint_pack_verify_section(const glint_pack *pack, const glint_pack_section *section) {
    const unsigned char *bytes;
    size_t len;
    glint_pack_error error = glint_pack_stored(pack, section, &bytes, &len);
    if (error)
        return error;
    return glint_pack_xxh3_64(bytes, len) == section->checksum ? GLINT_PACK_OK : GLINT_PACK_SECTION_CHECKSUM;
}

/* Compares all sections with their checksums: GLINT_PACK_OK, or the error of the first one that differs, whose index is then in
 * `*index`, which may be NULL. Reads every byte of the pack. glint_pack_open has compared header and table already. */
static inline glint_pack_error glint_pack_verify(const glint_pack *pack, uint32_t *index) {
    glint_pack_section section;
    uint32_t i;
    for (i = 0; glint_pack_section_at(pack, i, &section) == GLINT_PACK_OK; i++) {
        glint_pack_error error = glint_pack_verify_section(pack, &section);
        if (error) {
            if (index)
                *index = i;
            return error;
        }
    }
    return GLINT_PACK_OK;
}

/* Where one image of a texture lies in its decompressed payload, which ends no earlier than the image. `mip`, `layer` and `face`
 * count from 0. GLINT_PACK_NO_IMAGE where the section is no texture, its VkFormat has no name here or the texture has fewer
 * of them; `out` is then left as it was. */
static inline glint_pack_error glint_pack_image_at(const glint_pack_section *section, uint32_t mip, uint32_t layer,
                                                   uint32_t face, glint_pack_image *out) {
    const glint_pack_resource *of = &section->resource;
    uint64_t before = 0, all, images;
    uint32_t texel_bytes, i;
    int says;
    if (of->type != GLINT_PACK_TEXTURE || mip >= of->mips || layer >= of->layers || face >= of->faces)
        return GLINT_PACK_NO_IMAGE;
    /* All bytes of the texture fit 64 bits, so those of its parts do. */
    if (glint_pack_impl_raw_len(of, &says, &all) != GLINT_PACK_OK || !says || all > section->raw_len)
        return GLINT_PACK_NO_IMAGE;
    glint_pack_format_name(of->vk_format, &texel_bytes);
    images = (uint64_t)of->layers * of->faces;
    for (i = 0; i < mip; i++)
        before += (uint64_t)glint_pack_impl_mip_edge(of->width, i) * glint_pack_impl_mip_edge(of->height, i) * images;
    out->width = glint_pack_impl_mip_edge(of->width, mip);
    out->height = glint_pack_impl_mip_edge(of->height, mip);
    out->row_len = (uint64_t)out->width * texel_bytes;
    out->len = out->row_len * out->height;
    out->offset = before * texel_bytes + ((uint64_t)layer * of->faces + face) * out->len;
    return GLINT_PACK_OK;
}

/* ---- Reading values ---- */

/* Reads values of a payload one after the other. Once it was asked for more bytes than there are, `failed` is 1 and all that it
 * reads is 0: read what you need, then look at `failed`. */
typedef struct glint_pack_reader {
    const unsigned char *bytes;
    size_t len; /* how many there are */
    size_t at;  /* how many were read */
    int failed;
} glint_pack_reader;

/* Reader of `len` bytes from their start. */
static inline glint_pack_reader glint_pack_reader_of(const void *bytes, size_t len) {
    glint_pack_reader reader;
    reader.bytes = (const unsigned char *)bytes;
    reader.len = len;
    reader.at = 0;
    reader.failed = 0;
    return reader;
}

/* The next `len` bytes where they lie, which are thereby read; NULL where so many are not left. Also skips bytes. */
static inline const unsigned char *glint_pack_read_bytes(glint_pack_reader *reader, uint64_t len) {
    const unsigned char *bytes;
    if (reader->failed || !reader->bytes || len > reader->len - reader->at) {
        reader->failed = 1;
        return NULL;
    }
    bytes = reader->bytes + reader->at;
    reader->at += (size_t)len;
    return bytes;
}

/* The next byte: a u8, a bool (0 or 1) or the mark of an option (0: nothing follows, 1: its value follows). */
static inline uint8_t glint_pack_read_u8(glint_pack_reader *reader) {
    const unsigned char *p = glint_pack_read_bytes(reader, 1);
    return p ? *p : (uint8_t)0;
}

/* The next two bytes as a u16. */
static inline uint16_t glint_pack_read_u16(glint_pack_reader *reader) {
    const unsigned char *p = glint_pack_read_bytes(reader, 2);
    return p ? glint_pack_le16(p) : (uint16_t)0;
}

/* The next four bytes as a u32, or as the number of an enum's variant. */
static inline uint32_t glint_pack_read_u32(glint_pack_reader *reader) {
    const unsigned char *p = glint_pack_read_bytes(reader, 4);
    return p ? glint_pack_le32(p) : 0;
}

/* The next eight bytes as a u64, or as the number of a list's elements. */
static inline uint64_t glint_pack_read_u64(glint_pack_reader *reader) {
    const unsigned char *p = glint_pack_read_bytes(reader, 8);
    return p ? glint_pack_le64(p) : 0;
}

/* The next two bytes as a half float. */
static inline float glint_pack_read_f16(glint_pack_reader *reader) {
    return glint_pack_half(glint_pack_read_u16(reader));
}

/* The next four bytes as a single float, of any value, NaN too. */
static inline float glint_pack_read_f32(glint_pack_reader *reader) {
    uint32_t bits = glint_pack_read_u32(reader);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The next eight bytes as a double float, of any value, NaN too. */
static inline double glint_pack_read_f64(glint_pack_reader *reader) {
    uint64_t bits = glint_pack_read_u64(reader);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* A string: its length in bytes and where its UTF-8 lies, which no zero follows and which was not checked. NULL, with length 0,
 * where it is not all there. */
static inline const char *glint_pack_read_string(glint_pack_reader *reader, size_t *len) {
    uint64_t stated = glint_pack_read_u64(reader);
    const unsigned char *bytes = glint_pack_read_bytes(reader, stated);
    *len = bytes ? (size_t)stated : 0;
    return (const char *)bytes;
}

/* ---- Errors ---- */

/* What an error is, in a few words, which docs/FORMAT.md explains; never NULL, whatever the number. */
static inline const char *glint_pack_error_text(glint_pack_error error) {
    switch (error) {
    case GLINT_PACK_OK: return "no error";
    case GLINT_PACK_NOT_FOUND: return "no such section";
    case GLINT_PACK_COMPRESSED: return "section is compressed";
    case GLINT_PACK_NO_IMAGE: return "no such image";
    case GLINT_PACK_FILE_TOO_SHORT: return "file shorter than the header";
    case GLINT_PACK_BAD_MAGIC: return "not a glintpack";
    case GLINT_PACK_OVERLAPS_HEADER: return "section overlaps header";
    case GLINT_PACK_UNSUPPORTED_MAJOR: return "unsupported major version";
    case GLINT_PACK_FILE_LENGTH: return "file length differs from header";
    case GLINT_PACK_UNKNOWN_FLAGS: return "unknown header flags";
    case GLINT_PACK_TABLE_OUT_OF_FILE: return "section table past end of file";
    case GLINT_PACK_HEADER_CHECKSUM: return "header checksum differs";
    case GLINT_PACK_FILE_TOO_LARGE: return "file larger than limit";
    case GLINT_PACK_TOO_MANY_SECTIONS: return "more sections than limit";
    case GLINT_PACK_RAW_TOO_LARGE: return "decompressed size larger than limit";
    case GLINT_PACK_BAD_NAME: return "invalid section name";
    case GLINT_PACK_DUPLICATE_SECTION: return "duplicate section";
    case GLINT_PACK_UNKNOWN_CODEC: return "unknown codec";
    case GLINT_PACK_BAD_REQUIRED_FLAG: return "invalid required flag";
    case GLINT_PACK_UNKNOWN_RESOURCE: return "unknown resource type";
    case GLINT_PACK_BAD_RESOURCE: return "impossible resource descriptor";
    case GLINT_PACK_UNUSED_BYTES: return "unused descriptor bytes not zero";
    case GLINT_PACK_RAW_LENGTH: return "raw length differs from descriptor";
    case GLINT_PACK_STORED_LENGTH: return "stored length differs from raw length";
    case GLINT_PACK_MISALIGNED: return "section not aligned";
    case GLINT_PACK_SECTIONS_OVERLAP: return "sections overlap";
    case GLINT_PACK_SECTION_GAP: return "gap before section";
    case GLINT_PACK_SECTION_OUT_OF_FILE: return "section past end of file";
    case GLINT_PACK_TRAILING_BYTES: return "bytes after last section";
    case GLINT_PACK_PADDING_NOT_ZERO: return "padding not zero";
    case GLINT_PACK_SECTION_CHECKSUM: return "section checksum differs";
    case GLINT_PACK_UNKNOWN_REQUIRED: return "unknown required section";
    case GLINT_PACK_UNSUPPORTED_SECTION_VERSION: return "unsupported section version";
    }
    return "unknown error";
}

#ifdef __cplusplus
}
#endif

#endif
