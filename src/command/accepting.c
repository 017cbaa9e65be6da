#include "command/accepting.h"

#include <string.h>
#include <unistd.h>

#include "journal/golden.h"

const char *accepting_source(const struct accepting *accepting, const char *path)
{
    const char *at = buf_text(&accepting->drafts), *end = at + accepting->drafts.length;
    while (at < end) {
        const char *draft = at, *place = at + strlen(at) + 1;
        if (strcmp(place, path) == 0)
            return draft;
        at = place + strlen(place) + 1;
    }
    return path;
}

/* One file, whole, under a name of its own. */
static enum err draw_up(struct accepting *accepting, struct desk *desk, const char *path,
                        const struct picture *picture, struct fault *fault)
{
    struct buf draft = {0};
    enum err err = file_draft(&draft, path, FILE_REPLACE, fault);
    if (!err) {
        err = image_write(desk->helper, buf_text(&draft), FILE_KEEP, picture, fault);
        buf_add(&accepting->drafts, buf_text(&draft), draft.length + 1);
        buf_add(&accepting->drafts, path, strlen(path) + 1);
        if (!err && accepting->drafts.failed) {
            file_discard(buf_text(&draft));
            err = fault_memory(fault, "the names of files");
        }
    }
    buf_release(&draft);
    return err;
}

static enum err note_origin(const struct accepting *accepting, const struct desk *desk,
                            struct picture *picture, struct fault *fault)
{
    const char *journal = file_name(buf_text(&desk->home));
    enum err err = picture_note(picture, "iftty:journal", journal, fault);
    return err ? err : picture_note(picture, "iftty:chain", accepting->chain.hex, fault);
}

enum err accepting_take(struct accepting *accepting, struct desk *desk, const char *name,
                        const char *path, struct picture *picture, struct fault *fault)
{
    struct buf folder = {0};
    if (accepting_source(accepting, path) != path)
        return fault_set(fault, ERR_CHECK,
                         "golden image %s is given twice, and the pictures are not the same", name);
    buf_clear(&accepting->note);
    buf_add_text(&accepting->note, fault->text);
    enum err err = golden_folder(&folder, buf_text(&desk->home), fault);
    if (!err)
        err = file_make_folder(buf_text(&folder), fault);
    if (!err)
        err = note_origin(accepting, desk, picture, fault);
    if (!err)
        err = draw_up(accepting, desk, path, picture, fault);
    if (!err) {
        buf_printf(&folder, "/%s.png", name);
        err = folder.failed ? fault_memory(fault, "a path")
                            : draw_up(accepting, desk, buf_text(&folder), picture, fault);
    }
    if (!err) {
        accepting->images++;
        fault->text[0] = '\0';
    }
    buf_release(&folder);
    return err;
}

enum err accepting_publish(struct accepting *accepting, struct desk *desk, struct fault *fault)
{
    const char *at = buf_text(&accepting->drafts), *end = at + accepting->drafts.length;
    enum err err = OK;
    while (!err && at < end) {
        const char *draft = at, *place = at + strlen(at) + 1;
        err = desk_will_write(desk, place, FILE_REPLACE, fault);
        if (!err)
            err = file_publish(draft, place, FILE_REPLACE, fault);
        at = place + strlen(place) + 1;
    }
    return err;
}

void accepting_release(struct accepting *accepting)
{
    const char *at = buf_text(&accepting->drafts), *end = at + accepting->drafts.length;
    while (at < end) {
        const char *place = at + strlen(at) + 1;
        file_discard(at); /* not there any more where it was published */
        at = place + strlen(place) + 1;
    }
    buf_release(&accepting->drafts);
    buf_release(&accepting->note);
}
