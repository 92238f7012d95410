/* Lists a glintpack and evaluates its slope dictionary, if it has one: example_list PACK
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Exit codes are those of glint-info: 2 wrong usage, 3 the file cannot be read, 4 the pack is damaged.
 */
#include "glint_pack.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

/* All bytes of a file; NULL where it cannot be read. A program of yours would rather map it. */
static unsigned char *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    unsigned char *bytes = NULL;
    long len = -1;
    if (!file)
        return NULL;
    if (fseek(file, 0, SEEK_END) == 0 && (len = ftell(file)) >= 0 && fseek(file, 0, SEEK_SET) == 0)
        bytes = (unsigned char *)malloc((size_t)len + 1);
    *size = bytes ? fread(bytes, 1, (size_t)len, file) : 0;
    fclose(file);
    return bytes;
}

/* One line: kind and name, what the section is, where it lies. */
static void print_section(const glint_pack_section *section) {
    const glint_pack_resource *of = &section->resource;
    int i;
    for (i = 0; i < 4; i++)
        putchar(section->kind[i] >= ' ' && section->kind[i] <= '~' ? section->kind[i] : '?');
    if (section->name[0] != 0)
        printf(" \"%s\"", section->name);
    if (of->type == GLINT_PACK_TEXTURE) {
        const char *format = glint_pack_format_name(of->vk_format, NULL);
        printf(": texture %s %" PRIu32 " x %" PRIu32 ", layers %" PRIu32 ", faces %" PRIu32 ", mips %" PRIu32,
               format ? format : "of unknown format", of->width, of->height, of->layers, of->faces, of->mips);
    } else if (of->type == GLINT_PACK_BUFFER) {
        printf(": buffer %" PRIu64 " x %" PRIu32 " bytes", of->count, of->stride);
    } else {
        printf(": parameters");
    }
    printf("; %" PRIu64 " bytes at %" PRIu64 ", %s, %" PRIu64 " raw, checksum %016" PRIx64 "\n", section->stored_len,
           section->offset, section->codec == GLINT_PACK_CODEC_NONE ? "plain" : "zstd", section->raw_len,
           section->checksum);
}

/* What SDUB holds, as far as a look-up needs it. */
typedef struct dictionary {
    uint32_t marginals, levels, entries;
    float domain, inv_spacing;
} dictionary;

/* Density P of one slope component in row `level * marginals + marginal`, with linear filtering as a shader has it. */
static float density(const dictionary *of, const unsigned char *words, size_t len, uint32_t row, float slope) {
    float x = slope < 0 ? -slope : slope;
    float p = x * of->inv_spacing - 0.5f;
    float last = (float)(of->entries - 1), low, high;
    uint32_t word;
    glint_pack_reader reader = glint_pack_reader_of(words, len);
    if (x > of->domain || !(p > 0))
        p = 0;
    if (p > last)
        p = last;
    word = (uint32_t)p;
    glint_pack_read_bytes(&reader, 4 * ((uint64_t)row * of->entries + word));
    low = glint_pack_read_f16(&reader);
    high = glint_pack_read_f16(&reader);
    return x > of->domain ? 0 : low + (high - low) * (p - (float)word);
}

/* Finds the dictionary's sections and prints the densities of its first marginal. */
static glint_pack_error print_dictionary(const glint_pack *pack) {
    glint_pack_section uniform, table;
    const unsigned char *bytes, *words;
    size_t bytes_len, words_len;
    glint_pack_reader reader;
    dictionary of;
    uint32_t level;
    glint_pack_error error = glint_pack_find(pack, "SDUB", NULL, &uniform);
    if (error)
        return GLINT_PACK_OK;
    error = glint_pack_find(pack, "SDTB", uniform.name, &table);
    if (!error)
        error = glint_pack_payload(pack, &uniform, &bytes, &bytes_len);
    if (!error)
        error = glint_pack_payload(pack, &table, &words, &words_len);
    if (error == GLINT_PACK_COMPRESSED) {
        printf("%s: decompress its sections with zstd to evaluate it\n", uniform.name);
        return GLINT_PACK_OK;
    }
    if (error)
        return error;
    reader = glint_pack_reader_of(bytes, bytes_len);
    of.marginals = glint_pack_read_u32(&reader);
    of.levels = glint_pack_read_u32(&reader);
    of.entries = glint_pack_read_u32(&reader);
    glint_pack_read_f32(&reader); /* alpha_dict */
    of.domain = glint_pack_read_f32(&reader);
    of.inv_spacing = glint_pack_read_f32(&reader);
    if (reader.failed || of.entries == 0)
        return GLINT_PACK_OK;
    printf("%s: %" PRIu32 " marginals, %" PRIu32 " levels, %" PRIu32 " entries up to slope %.5f\n", uniform.name,
           of.marginals, of.levels, of.entries, (double)of.domain);
    for (level = 0; level < of.levels; level++) {
        uint32_t row = level * of.marginals;
        printf("level %" PRIu32 ": P(0) = %.5f, P(0.1) = %.5f, P(-0.5) = %.5f\n", level,
               (double)density(&of, words, words_len, row, 0), (double)density(&of, words, words_len, row, 0.1f),
               (double)density(&of, words, words_len, row, -0.5f));
    }
    return GLINT_PACK_OK;
}

int main(int argc, char **argv) {
    size_t size;
    unsigned char *bytes;
    glint_pack pack;
    glint_pack_section section;
    glint_pack_error error;
    uint32_t index;
    if (argc != 2) {
        fprintf(stderr, "usage: %s PACK\n", argv[0]);
        return 2;
    }
    bytes = read_file(argv[1], &size);
    if (!bytes) {
        fprintf(stderr, "%s cannot be read\n", argv[1]);
        return 3;
    }
    error = glint_pack_open(bytes, size, &pack);
    if (!error)
        error = glint_pack_verify(&pack, NULL);
    for (index = 0; !error && glint_pack_section_at(&pack, index, &section) == GLINT_PACK_OK; index++)
        print_section(&section);
    if (!error)
        error = print_dictionary(&pack);
    if (error)
        fprintf(stderr, "%s: G%04d %s\n", argv[1], (int)error, glint_pack_error_text(error));
    free(bytes);
    return error ? 4 : 0;
}
