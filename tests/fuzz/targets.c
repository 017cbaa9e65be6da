/* SPDX-License-Identifier: MIT */
/* The table of fuzz targets, and that of libFuzzer's: the one that FUZZ_TARGET names. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

/* Fewer changes for the slowest targets. */
static const struct fuzz_target target[] = {
    {"command", fuzz_command, 1500}, {"config", fuzz_config, 1500},
    {"csa", fuzz_csa, 1500},         {"exr", fuzz_exr, 500},
    {"helper", fuzz_helper, 750},    {"journal", fuzz_journal, 1500},
    {"keys", fuzz_keys, 1500},       {"labels", fuzz_labels, 1500},
    {"line", fuzz_line, 1500},       {"mgh", fuzz_mgh, 750},
    {"nifti", fuzz_nifti, 500},      {"nrrd", fuzz_nrrd, 750},
    {"png", fuzz_png, 1500},         {"procedure", fuzz_procedure, 750},
    {"raw", fuzz_raw, 750},          {"request", fuzz_request, 1500},
    {"seeds", fuzz_seeds, 1500},     {"seg", fuzz_seg, 250},
    {"surface", fuzz_surface, 25},   {"transform", fuzz_transform, 1500}};

const struct fuzz_target *fuzz_find(const char *name)
{
    for (size_t i = 0; i < sizeof target / sizeof *target; i++)
        if (strcmp(target[i].name, name) == 0)
            return &target[i];
    for (size_t i = 0; i < sizeof target / sizeof *target; i++)
        puts(target[i].name);
    return NULL;
}

/* Always 0. The name is libFuzzer's. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    const char *name = getenv("FUZZ_TARGET");
    const struct fuzz_target *found = fuzz_find(name ? name : "");
    HOLDS(found);
    found->read(bytes, length);
    return 0;
}
