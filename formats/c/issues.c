/* Prints what glint_pack.h makes of many packs, for the test that compares it with the Rust reader: issues < PACKS
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * PACKS is packs one after the other, each with its length before it as a u64, little-endian. Each has a line: the issue that
 * glint_pack_open found, else the one that glint_pack_verify found, else 0; the XXH3-64 of all its bytes; and what the issue is.
 * With an argument it reads nothing, and prints all texture formats that the header names.
 */
#include "glint_pack.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static void print_formats(void) {
    uint32_t number, texel_bytes;
    for (number = 0; number < 1000; number++) {
        const char *name = glint_pack_format_name(number, &texel_bytes);
        if (name)
            printf("%" PRIu32 " %s %" PRIu32 "\n", number, name, texel_bytes);
    }
}

int main(int argc, char **argv) {
    unsigned char prefix[8];
    (void)argv;
    if (argc > 1) {
        print_formats();
        return 0;
    }
    while (fread(prefix, 1, sizeof prefix, stdin) == sizeof prefix) {
        size_t size = (size_t)glint_pack_le64(prefix);
        /* No byte more than the pack has, so that a sanitizer sees the first read beyond them. */
        unsigned char *bytes = (unsigned char *)malloc(size);
        glint_pack pack;
        glint_pack_error error;
        if ((!bytes && size != 0) || fread(bytes, 1, size, stdin) != size)
            return 3;
        error = glint_pack_open(bytes, size, &pack);
        if (!error)
            error = glint_pack_verify(&pack, NULL);
        printf("%d %016" PRIx64 " %s\n", (int)error, glint_pack_xxh3_64(bytes, size), glint_pack_error_text(error));
        free(bytes);
    }
    return 0;
}
