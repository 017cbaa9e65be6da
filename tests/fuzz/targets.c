/* SPDX-License-Identifier: MIT */
/* The table of fuzz targets, and that of libFuzzer's: the one that FUZZ_TARGET names. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

/* Fewer changes for the slowest targets. */
static const struct fuzz_target target[] = {
    {"command", fuzz_command, 6000}, {"config", fuzz_config, 6000},
    {"csa", fuzz_csa, 6000},         {"exr", fuzz_exr, 2000},
    {"helper", fuzz_helper, 3000},   {"journal", fuzz_journal, 6000},
    {"keys", fuzz_keys, 6000},       {"labels", fuzz_labels, 6000},
    {"line", fuzz_line, 6000},       {"mgh", fuzz_mgh, 3000},
    {"nifti", fuzz_nifti, 2000},     {"nrrd", fuzz_nrrd, 3000},
    {"png", fuzz_png, 6000},         {"procedure", fuzz_procedure, 3000},
    {"raw", fuzz_raw, 3000},         {"request", fuzz_request, 6000},
    {"seeds", fuzz_seeds, 6000},     {"seg", fuzz_seg, 1000},
    {"surface", fuzz_surface, 100},  {"transform", fuzz_transform, 6000}};

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
