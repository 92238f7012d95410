/* Damages packs in memory and runs all of glint_pack.h on them, for a build with sanitizers: mutate COUNT SEED PACK...
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * COUNT damaged copies are made of the packs in turn. Half of them get right checksums again, so that what lies behind the
 * checksums is reached. Every byte that the header hands out is read. Equal arguments do equal work. Exit codes: 0 all is well,
 * 1 the header contradicts itself, 2 wrong usage, 3 a pack cannot be read.
 */
#include "glint_pack.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

/* Largest copy, and so twice the largest pack. */
#define CAPACITY ((size_t)1 << 20)

typedef struct input {
    unsigned char *bytes;
    size_t size;
} input;

/* State of all random numbers. */
static uint64_t state;
/* What was read, so that no compiler leaves a read out. */
static volatile unsigned sink;

static void check(int holds, const char *what) {
    if (!holds) {
        fprintf(stderr, "not so: %s\n", what);
        exit(1);
    }
}

/* Next random number (splitmix64). */
static uint64_t next(void) {
    uint64_t z = state += 0x9E3779B97F4A7C15ull;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ z >> 27) * 0x94D049BB133111EBull;
    return z ^ z >> 31;
}

/* Random number below `end`; 0 where `end` is. */
static size_t below(uint64_t end) {
    return end ? (size_t)(next() % end) : 0;
}

/* Reads bytes that lie in a copy. A sanitizer looks at all that memcpy reads, and faster than at reads one by one. */
static void touch(const unsigned char *bytes, size_t len) {
    static unsigned char read[CAPACITY];
    if (len != 0) {
        memcpy(read, bytes, len);
        sink = read[len / 2];
    }
}

/* Writes the lowest `width` bytes of a number, the least first. */
static void put(unsigned char *at, uint64_t value, size_t width) {
    size_t i;
    for (i = 0; i < width; i++)
        at[i] = (unsigned char)(value >> (8 * i));
}

/* ---- Damage ---- */

/* A number at which something may change over. */
static uint64_t interesting(uint64_t size) {
    switch (below(12)) {
    case 0: return below(8);
    case 1: return (uint64_t)1 << below(64);
    case 2: return ((uint64_t)1 << below(64)) - 1;
    case 3: return UINT64_MAX - below(300);
    case 4: return size;
    case 5: return size - 8 + below(17);
    case 6: return (uint64_t)GLINT_PACK_ALIGNMENT * below(size / GLINT_PACK_ALIGNMENT + 2);
    case 7: return GLINT_PACK_HEADER_BYTES + (uint64_t)GLINT_PACK_ENTRY_BYTES * below(40);
    case 8: return below(size + 1);
    case 9: return below(200);
    case 10: return 62 + below(4);
    default: return next();
    }
}

/* A place to damage: in the header, in the first entries, or anywhere. */
static size_t place(size_t size) {
    size_t header = GLINT_PACK_HEADER_BYTES, table = header + 4 * GLINT_PACK_ENTRY_BYTES;
    switch (below(8)) {
    case 0: return below(header < size ? header : size);
    case 1:
    case 2:
    case 3: return below((table < size ? table : size) / 4) * 4;
    default: return below(size);
    }
}

/* Changes `bytes` once; returns how many there are then. */
static size_t damage(unsigned char *bytes, size_t size, const input *other) {
    size_t at = place(size), len, width, from, to;
    if (size == 0)
        return below(300);
    switch (below(16)) {
    case 0: /* a bit flips */
        bytes[at] ^= (unsigned char)(1u << below(8));
        return size;
    case 1: /* a byte is another */
        bytes[at] = (unsigned char)next();
        return size;
    case 2: /* the end is missing */
        return below(size + 1);
    case 3: /* bytes are added */
        len = below(600);
        if (size + len > CAPACITY)
            return size;
        memset(bytes + size, (int)below(2), len);
        return size + len;
    case 4: /* a range of another pack, or of this one, lies over one of this */
        len = below((size < other->size ? size : other->size) + 1);
        to = below(size - len + 1);
        from = below(other->size - len + 1);
        memcpy(bytes + to, other->bytes + from, len);
        return size;
    case 5: /* an entry lies over another one, shifted or not */
        if (size < GLINT_PACK_HEADER_BYTES + 4 * GLINT_PACK_ENTRY_BYTES)
            return size;
        to = GLINT_PACK_HEADER_BYTES + GLINT_PACK_ENTRY_BYTES * below(4);
        from = GLINT_PACK_HEADER_BYTES + GLINT_PACK_ENTRY_BYTES * below(4);
        memmove(bytes + to, bytes + from, GLINT_PACK_ENTRY_BYTES - below(100));
        return size;
    default: /* a number is an interesting one */
        width = (size_t)1 << below(4);
        if (width > size - at)
            width = 1;
        put(bytes + at, interesting(size), width);
        return size;
    }
}

/* Makes the raw length of an entry what its descriptor gives, and calls it compressed where the stored length is another. */
static void reconcile(unsigned char *entry) {
    glint_pack_section section;
    uint64_t raw_len;
    int says;
    glint_pack_impl_entry(entry, &section);
    if (glint_pack_impl_raw_len(&section.resource, &says, &raw_len) != GLINT_PACK_OK || !says)
        return;
    put(entry + 24, raw_len, 8);
    entry[7] = raw_len != section.stored_len;
}

/* Makes length and checksums right, as far as there are bytes that they are of. */
static void reseal(unsigned char *bytes, size_t size) {
    uint64_t table_end;
    size_t at;
    if (size < GLINT_PACK_HEADER_BYTES)
        return;
    put(bytes + 24, size, 8);
    table_end = GLINT_PACK_HEADER_BYTES + (uint64_t)glint_pack_le32(bytes + 16) * GLINT_PACK_ENTRY_BYTES;
    if (table_end > size)
        return;
    for (at = GLINT_PACK_HEADER_BYTES; at < table_end; at += GLINT_PACK_ENTRY_BYTES) {
        uint64_t offset, len;
        if (next() & 1)
            reconcile(bytes + at);
        offset = glint_pack_le64(bytes + at + 8);
        len = glint_pack_le64(bytes + at + 16);
        if (offset <= size && len <= size - offset)
            put(bytes + at + 32, glint_pack_xxh3_64(bytes + offset, (size_t)len), 8);
    }
    memset(bytes + 32, 0, 8);
    put(bytes + 32, glint_pack_xxh3_64(bytes, (size_t)table_end), 8);
}

/* ---- Use ---- */

/* Reads values until there are none left. */
static void read_values(const unsigned char *bytes, size_t len) {
    glint_pack_reader reader = glint_pack_reader_of(bytes, len);
    const char *text;
    size_t text_len;
    while (!reader.failed) {
        switch (below(9)) {
        case 0: sink = glint_pack_read_u8(&reader); break;
        case 1: sink = glint_pack_read_u16(&reader); break;
        case 2: sink = glint_pack_read_u32(&reader); break;
        case 3: sink = (unsigned)glint_pack_read_u64(&reader); break;
        case 4: sink = glint_pack_read_f16(&reader) > 0; break;
        case 5: sink = glint_pack_read_f32(&reader) > 0; break;
        case 6: sink = glint_pack_read_f64(&reader) > 0; break;
        case 7: glint_pack_read_bytes(&reader, interesting(len)); break;
        default:
            text = glint_pack_read_string(&reader, &text_len);
            check((text == NULL) == (reader.failed != 0), "a string is there or was asked for in vain");
            touch((const unsigned char *)text, text_len);
        }
        check(reader.at <= len, "a reader stays within its bytes");
    }
    check(glint_pack_read_u64(&reader) == 0 && glint_pack_read_bytes(&reader, 0) == NULL, "a reader that failed reads 0");
}

/* Asks for images of a texture, those at its ends and some others; `bytes` is its payload or NULL, `sound` whether the
 * entry is one of an open pack. */
static void read_images(const glint_pack_section *section, const unsigned char *bytes, int sound) {
    const glint_pack_resource *of = &section->resource;
    int i;
    for (i = 0; i < 8; i++) {
        glint_pack_image image;
        uint32_t mip = (uint32_t)below((uint64_t)of->mips + 1), layer = (uint32_t)interesting(of->layers);
        uint32_t face = (uint32_t)below((uint64_t)of->faces + 1);
        if (i == 0) {
            mip = of->mips - 1;
            layer = of->layers - 1;
            face = of->faces - 1;
        }
        if (glint_pack_image_at(section, mip, layer, face, &image) != GLINT_PACK_OK)
            continue;
        check(image.offset <= section->raw_len && image.len <= section->raw_len - image.offset, "images lie in the payload");
        check(image.row_len * image.height == image.len && image.len != 0, "an image is its rows");
        check(!sound || i != 0 || image.offset + image.len == section->raw_len, "the last image ends the payload");
        if (bytes)
            touch(bytes + image.offset, (size_t)image.len);
    }
}

/* Everything that can be asked of a section. */
static void use_section(const glint_pack *pack, const glint_pack_section *section, int verified) {
    const unsigned char *stored, *payload;
    size_t stored_len, payload_len;
    glint_pack_section found;
    glint_pack_error error;
    check(glint_pack_stored(pack, section, &stored, &stored_len) == GLINT_PACK_OK, "sections of an open pack lie in it");
    check(stored_len == section->stored_len, "the stored bytes are as many as the entry says");
    touch(stored, stored_len);
    read_values(stored, stored_len);
    error = glint_pack_payload(pack, section, &payload, &payload_len);
    if (section->codec == GLINT_PACK_CODEC_NONE)
        check(!error && payload == stored && payload_len == section->raw_len, "what is stored plainly is the payload");
    else
        check(error == GLINT_PACK_COMPRESSED && !payload && payload_len == 0, "what is compressed is not the payload");
    read_images(section, payload, 1);
    if (verified && below(8) == 0)
        check(glint_pack_verify_section(pack, section) == GLINT_PACK_OK, "a sound pack is of sound sections");
    if (glint_pack_find(pack, section->kind, section->name, &found) == GLINT_PACK_OK)
        check(found.offset == section->offset && found.checksum == section->checksum, "kind and name find the section");
    else
        check(strlen(section->kind) < 4 || strlen(section->name) < 64, "sections are found by kind and name");
    sink = glint_pack_find(pack, section->kind, NULL, &found) == GLINT_PACK_OK;
    sink = glint_pack_find_nth(pack, section->kind, (uint32_t)below(3), &found) == GLINT_PACK_OK;
    touch((const unsigned char *)section->name, strlen(section->name));
}

/* Entries that no pack has, as a program that mixes packs up would pass them. */
static void use_foreign_section(const glint_pack *pack, const glint_pack_section *section) {
    glint_pack_section foreign = *section;
    const unsigned char *bytes;
    size_t len;
    foreign.offset = interesting(pack->size);
    foreign.stored_len = interesting(pack->size);
    foreign.resource.width = (uint32_t)interesting(pack->size);
    foreign.resource.mips = (uint32_t)interesting(32);
    foreign.resource.layers = (uint32_t)interesting(pack->size);
    if (glint_pack_stored(pack, &foreign, &bytes, &len) == GLINT_PACK_OK)
        touch(bytes, len);
    sink = glint_pack_verify_section(pack, &foreign) == GLINT_PACK_OK;
    read_images(&foreign, NULL, 0);
}

/* Everything that can be asked of a pack; adds to the number of those that open and of those whose checksums are right. */
static void use(const unsigned char *bytes, size_t size, uint64_t *opened, uint64_t *sound) {
    glint_pack pack;
    glint_pack_section section;
    glint_pack_error error = glint_pack_open(bytes, size, &pack);
    uint32_t index;
    touch((const unsigned char *)glint_pack_error_text(error), 4);
    if (error) {
        check(pack.bytes == NULL && pack.section_count == 0, "a pack that was refused has no sections");
        check(glint_pack_section_at(&pack, 0, &section) == GLINT_PACK_NOT_FOUND, "nor gives it any");
        return;
    }
    ++*opened;
    error = glint_pack_verify(&pack, &index);
    check(!error || index < pack.section_count, "the section that differs is one of the pack");
    *sound += !error;
    for (index = 0; index < pack.section_count; index++) {
        check(glint_pack_section_at(&pack, index, &section) == GLINT_PACK_OK, "sections are as many as the header says");
        use_section(&pack, &section, !error);
        use_foreign_section(&pack, &section);
    }
    check(glint_pack_section_at(&pack, index, &section) == GLINT_PACK_NOT_FOUND, "and no more");
    check(glint_pack_section_at(&pack, UINT32_MAX, &section) == GLINT_PACK_NOT_FOUND, "nor has it the last index");
}

static int read_file(const char *path, input *out) {
    FILE *file = fopen(path, "rb");
    out->bytes = (unsigned char *)malloc(CAPACITY / 2);
    if (!file || !out->bytes)
        return 0;
    out->size = fread(out->bytes, 1, CAPACITY / 2, file);
    fclose(file);
    return 1;
}

int main(int argc, char **argv) {
    static unsigned char copy[CAPACITY];
    uint64_t count, run, opened = 0, sound = 0;
    size_t inputs = argc > 3 ? (size_t)argc - 3 : 0, i;
    input *packs = (input *)calloc(inputs + 1, sizeof *packs);
    if (!inputs || !packs) {
        fprintf(stderr, "usage: %s COUNT SEED PACK...\n", argv[0]);
        return 2;
    }
    count = strtoull(argv[1], NULL, 10);
    state = strtoull(argv[2], NULL, 10);
    for (i = 0; i < inputs; i++) {
        if (!read_file(argv[3 + i], &packs[i])) {
            fprintf(stderr, "%s cannot be read\n", argv[3 + i]);
            return 3;
        }
    }
    for (run = 0; run < count; run++) {
        const input *pack = &packs[run % inputs];
        size_t size = pack->size, changes = 1 + below(1 + below(3)), shift;
        unsigned char *exact;
        memcpy(copy, pack->bytes, size);
        for (i = 0; i < changes; i++)
            size = damage(copy, size, &packs[below(inputs)]);
        if (next() & 1)
            reseal(copy, size);
        /* No byte more than the pack has, so that a sanitizer sees the first read beyond them; at any address. */
        shift = below(4) ? 0 : below(16);
        exact = (unsigned char *)malloc(size + shift);
        if (!exact)
            return 3;
        memcpy(exact + shift, copy, size);
        use(exact + shift, size, &opened, &sound);
        free(exact);
    }
    printf("%" PRIu64 " damaged packs: %" PRIu64 " open, %" PRIu64 " of them with right checksums\n", count, opened, sound);
    for (i = 0; i < inputs; i++)
        free(packs[i].bytes);
    free(packs);
    return 0;
}
