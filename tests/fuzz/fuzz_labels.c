/* SPDX-License-Identifier: MIT */
/* Tables of labels: what is read gives labels names that a command can hold, and colours; what is
 * written can be read again. */
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

#include "base/safe.h"
#include "show/label_table.h"
#include "session/setting.h"
#include "session/map.h"

static void check_names(const struct kept *kept)
{
    for (unsigned l = 0; l < 256; l++) {
        const char *name = kept->label_name[l];
        const size_t length = strnlen(name, LABEL_NAME_BYTES);
        HOLDS(length < LABEL_NAME_BYTES);
        for (size_t i = length; i < LABEL_NAME_BYTES; i++)
            HOLDS(name[i] == '\0');
        HOLDS(!*name || label_name_fits(name));
    }
}

static bool take(struct kept *kept, const struct label_table *table)
{
    struct label_tally tally;
    uint16_t *as = NULL;
    HOLDS(regions_new(&as, NULL, NULL, NULL) == OK);
    const enum err err = label_table_apply(kept, &tally, table, as, NULL);
    free(as);
    return err == OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    static const enum label_table_format format[] = {TABLE_ITKSNAP, TABLE_SLICER, TABLE_FREESURFER};
    static const bool used[256] = {[7] = true};
    struct state state = state_default();
    struct label_table table, again;
    struct label_writing writing;
    struct buf text = {0}, written = {0};
    buf_add(&text, bytes, length);
    if (label_table_read_lut(&table, bytes, length, NULL) == OK)
        HOLDS(take(&state.kept, &table));
    label_table_release(&table);
    if (label_table_read(&table, buf_text(&text), length, NULL) == OK &&
        take(&state.kept, &table)) {
        check_names(&state.kept);
        for (size_t i = 0; i < sizeof format / sizeof format[0]; i++) {
            buf_clear(&written);
            label_table_write(&written, &writing, format[i], &state.kept, used);
            HOLDS(label_table_read(&again, buf_text(&written), written.length, NULL) == OK);
            label_table_release(&again);
        }
    }
    label_table_release(&table);
    buf_release(&text);
    buf_release(&written);
    return 0;
}
