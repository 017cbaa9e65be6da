#include "verify/golden_accept.h"

#include <string.h>
#include <unistd.h>

#include "journal/golden.h"

const char *golden_accept_source(const struct golden_accept *golden_accept, const char *path)
{
    const char *at = buf_text(&golden_accept->drafts), *end = at + golden_accept->drafts.length;
    while (at < end) {
        const char *draft = at, *place = at + strlen(at) + 1;
        if (strcmp(place, path) == 0)
            return draft;
        at = place + strlen(place) + 1;
    }
    return path;
}

/* One file, whole, under a name of its own. */
static enum err draw_up(struct golden_accept *golden_accept, struct interpreter *interp,
                        const char *path, const struct picture *picture, struct fault *fault)
{
    struct buf draft = {0};
    enum err err = file_draft(&draft, path, FILE_REPLACE, fault);
    if (!err) {
        err = image_write(interp->helper, buf_text(&draft), FILE_KEEP, picture, fault);
        buf_add(&golden_accept->drafts, buf_text(&draft), draft.length + 1);
        buf_add(&golden_accept->drafts, path, strlen(path) + 1);
        if (!err && golden_accept->drafts.failed) {
            file_discard(buf_text(&draft));
            err = fault_memory(fault, "the names of files");
        }
    }
    buf_release(&draft);
    return err;
}

static enum err note_origin(const struct golden_accept *golden_accept,
                            const struct interpreter *interp, struct picture *picture,
                            struct fault *fault)
{
    const char *journal = file_name(buf_text(&interp->home));
    enum err err = picture_note(picture, "iftty:journal", journal, fault);
    return err ? err : picture_note(picture, "iftty:chain", golden_accept->chain.hex, fault);
}

enum err golden_accept_take(struct golden_accept *golden_accept, struct interpreter *interp,
                            const char *name, const char *path, struct picture *picture,
                            struct fault *fault)
{
    struct buf folder = {0};
    if (golden_accept_source(golden_accept, path) != path)
        return fault_set(fault, ERR_CHECK,
                         "golden image %s is given twice, and the pictures are not the same", name);
    buf_clear(&golden_accept->note);
    buf_add_text(&golden_accept->note, fault->text);
    enum err err = golden_folder(&folder, buf_text(&interp->home), fault);
    if (!err)
        err = file_make_folder(buf_text(&folder), fault);
    if (!err)
        err = note_origin(golden_accept, interp, picture, fault);
    if (!err)
        err = draw_up(golden_accept, interp, path, picture, fault);
    if (!err) {
        buf_printf(&folder, "/%s.png", name);
        err = folder.failed ? fault_memory(fault, "a path")
                            : draw_up(golden_accept, interp, buf_text(&folder), picture, fault);
    }
    if (!err) {
        golden_accept->images++;
        fault->text[0] = '\0';
    }
    buf_release(&folder);
    return err;
}

enum err golden_accept_publish(struct golden_accept *golden_accept, struct interpreter *interp,
                               struct fault *fault)
{
    const char *at = buf_text(&golden_accept->drafts), *end = at + golden_accept->drafts.length;
    enum err err = OK;
    while (!err && at < end) {
        const char *draft = at, *place = at + strlen(at) + 1;
        err = interpreter_will_write(interp, place, FILE_REPLACE, fault);
        if (!err)
            err = file_publish(draft, place, FILE_REPLACE, fault);
        at = place + strlen(place) + 1;
    }
    return err;
}

void golden_accept_release(struct golden_accept *golden_accept)
{
    const char *at = buf_text(&golden_accept->drafts), *end = at + golden_accept->drafts.length;
    while (at < end) {
        const char *place = at + strlen(at) + 1;
        file_discard(at); /* not there any more where it was published */
        at = place + strlen(place) + 1;
    }
    buf_release(&golden_accept->drafts);
    buf_release(&golden_accept->note);
}
