/* `iftty replay`: a journal carried out again, every command shown. */
#include <stdio.h>

#include "base/file.h"
#include "program/begin.h"
#include "program/console.h"
#include "program/programs.h"
#include "verify/replay_file.h"

static enum err replay_into(const struct options *o, const char *folder, struct fault *fault)
{
    struct interpreter interp;
    struct options here = *o;
    here.out = folder;
    enum err err = begin_interpreter(&interp, &here, fault);
    if (!err)
        err = replay_aloud(&interp, o->word[0], &console_printer, fault);
    interpreter_release(&interp);
    return err;
}

/* The folder that was made for the files: it goes where there are none. */
static void settle_folder(const char *folder)
{
    struct buf text = {0};
    if (!folder_release(folder))
        return;
    buf_add_safe_text(&text, folder);
    console_erase_progress();
    fprintf(stderr, "# files are in %s\n", buf_text(&text));
    buf_release(&text);
}

enum err run_replay(const struct options *o, struct fault *fault)
{
    struct buf fresh = {0};
    enum err err = o->out ? file_make_folder(o->out, fault) : folder_held(&fresh, NULL, fault);
    if (err)
        return err;
    const char *folder = o->out ? o->out : buf_text(&fresh);
    console_handle_interrupts();
    err = begin_confined(o, o->word[0], folder, NULL, fault);
    if (!err)
        err = replay_into(o, folder, fault);
    if (!o->out)
        settle_folder(folder);
    buf_release(&fresh);
    return err;
}
