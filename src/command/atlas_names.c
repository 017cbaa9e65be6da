#include "command/atlas_names.h"

#include <string.h>

enum { TABLE_BYTES_MOST = 1 << 20 };

static void name_table(struct buf *out, const char *atlas)
{
    buf_add(out, atlas, strlen(atlas) - (file_is_named(atlas, ".gz") ? 3 : 0));
    buf_add_text(out, ".txt");
}

struct label_table atlas_table(const struct act *act, const char *path)
{
    struct label_table table = {0};
    struct buf name = {0}, text = {0};
    name_table(&name, path);
    if (!interpreter_is_wary(act->interp) && file_exists(buf_text(&name)) &&
        file_read(&text, buf_text(&name), TABLE_BYTES_MOST, NULL) == OK)
        label_table_read(&table, buf_text(&text), text.length, NULL);
    buf_release(&text);
    buf_release(&name);
    return table;
}

static bool is_nameless(const struct act *act, const bool has[256])
{
    for (unsigned label = 1; label < 256; label++)
        if (has[label] && !*session_kept(act->session)->label_name[label])
            return true;
    return false;
}

static void write_advice(const struct act *act)
{
    struct buf *out = &act->reply->text, name = {0};
    name_table(&name, act_text(act, "FILE"));
    buf_add_text(out, "their names: `label-file ");
    buf_add_safe_text(out, buf_text(&name));
    if (act_has(act, "regions"))
        buf_printf(out, " regions=%s", act_text(act, "regions"));
    if (act_has(act, "as"))
        buf_printf(out, " as=%s", act_text(act, "as"));
    buf_add_text(out, "`\n");
    buf_release(&name);
}

void atlas_advise_names(const struct act *act, const bool has[256])
{
    struct buf path = {0};
    if (is_nameless(act, has) &&
        interpreter_find_file(act->interp, act_text(act, "FILE"), &path, NULL) == OK) {
        struct label_table table = atlas_table(act, buf_text(&path));
        if (table.count)
            write_advice(act);
        label_table_release(&table);
    }
    buf_release(&path);
}
