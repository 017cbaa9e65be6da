/* Names and colours of labels out of a file. */
#include "command/act.h"

#include <stdlib.h>

#include "report/label_table.h"
#include "session/map.h"

enum { TABLE_BYTES_MOST = 16 << 20 };

/* The places of the parameters in the table. */
enum { FILE_NAME, REGIONS, AS };

static enum err read_table(struct label_table *table, const struct act *act)
{
    const char *name = act->value[FILE_NAME].text;
    struct buf path = {0}, text = {0};
    enum err err = interpreter_find_file(act->interp, name, &path, act->fault);
    if (!err)
        err = file_read(&text, buf_text(&path), TABLE_BYTES_MOST, act->fault);
    if (!err)
        err = file_is_named(name, ".lut")
                  ? label_table_read_lut(table, (const uint8_t *)text.data, text.length, act->fault)
                  : label_table_read(table, buf_text(&text), text.length, act->fault);
    buf_release(&text);
    buf_release(&path);
    return act_naming(name, err, act->fault);
}

static void write_tally(const struct act *act, const struct label_tally *tally)
{
    struct buf *out = &act->reply->text;
    buf_printf(out, "%u name%s and %u colour%s of labels\n", tally->names, plural(tally->names),
               tally->colours, plural(tally->colours));
    if (tally->beyond && !act->value[REGIONS].given)
        buf_printf(out, "%u more entr%s for no label 1..255; choose with regions=A,B as=1,2\n",
                   tally->beyond, tally->beyond == 1 ? "y is" : "ies are");
    if (tally->changed) {
        buf_printf(out, "%u name%s had to be changed to fit; the first is of label ",
                   tally->changed, plural(tally->changed));
        buf_printf(out, "%u, now ", tally->first_changed);
        buf_add_safe_text(out, act->next->kept.label_name[tally->first_changed]);
        buf_add_char(out, '\n');
    }
}

enum err act_label_file(const struct act *act)
{
    struct label_table table = {0};
    struct label_tally tally;
    uint16_t *as = NULL;
    enum err err = act_choose_regions(&as, act, &act->value[REGIONS], &act->value[AS], NULL);
    if (!err)
        err = read_table(&table, act);
    if (!err)
        err = act_naming(act->value[FILE_NAME].text,
                         label_table_apply(&act->next->kept, &tally, &table, as, act->fault),
                         act->fault);
    free(as);
    label_table_release(&table);
    if (err)
        return err;
    write_tally(act, &tally);
    buf_printf(&act->reply->words, "names=%016llx",
               (unsigned long long)label_table_digest(&act->next->kept));
    return act_go(act);
}
