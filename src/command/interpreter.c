#include "command/interpreter.h"

enum err interpreter_init(struct interpreter *interp, struct fault *fault)
{
    *interp = (struct interpreter){0};
    history_init(&interp->history);
    const enum err err = session_new(&interp->session, fault);
    return err ? err : image_helper_new(&interp->helper, NULL, fault);
}

enum err interpreter_write_beside(struct interpreter *interp, struct fault *fault)
{
    return picture_writer_new(&interp->writer, NULL, fault);
}

void interpreter_release(struct interpreter *interp)
{
    picture_job_free(interp->job);
    picture_writer_free(interp->writer);
    journal_close(interp->journal);
    image_helper_free(interp->helper);
    history_release(&interp->history);
    session_free(interp->session);
    buf_release(&interp->home);
    buf_release(&interp->written);
    buf_release(&interp->goldens);
    buf_release(&interp->made);
    buf_release(&interp->placed);
    canvas_release(&interp->shown);
    *interp = (struct interpreter){0};
}

void interpreter_show(struct interpreter *interp, const struct canvas *picture)
{
    canvas_release(&interp->shown);
    interp->shown = *picture;
    interp->shows_picture = true;
}
