/* SPDX-License-Identifier: MIT */
/* `iftty apply`, and `iftty log --procedure`, which writes its input without the journal. */
#include <stdio.h>
#include <string.h>

#include "apply/apply.h"
#include "base/file.h"
#include "base/mem.h"
#include "program/programs.h"

static struct procedure_source source_of(const struct options *o)
{
    return (struct procedure_source){.path = o->word[0],
                                     .journal = {.scene_path = o->scene,
                                                 .begin = begin_one,
                                                 .context = (void *)(uintptr_t)o,
                                                 .watch = console_watch()}};
}

enum err run_apply(const struct options *o, struct fault *fault)
{
    struct options walls = *o; /* confinement of the procedure, which writes nothing */
    walls.out = NULL;
    const struct apply_options how = {.procedure = source_of(&walls),
                                      .scene = o->word + 1,
                                      .scenes = (size_t)o->words - 1,
                                      .by = o->by,
                                      .as = o->as,
                                      .fit = o->fit,
                                      .out = o->out,
                                      .orient = o->orient,
                                      .volume = o->volume,
                                      .landmarks = o->landmarks,
                                      .json = o->json};
    console_handle_interrupts();
    return apply_procedure(&how, &console_printer, fault);
}

enum err run_log_procedure(const struct options *o, struct fault *fault)
{
    const struct procedure_source source = source_of(o);
    OWNED(buf_release) struct buf text = {0};
    console_handle_interrupts();
    TRY(procedure_text(&text, NULL, &source, fault));
    if (strcmp(o->procedure, "-") == 0)
        fputs(buf_text(&text), stdout);
    else
        TRY(file_write(o->procedure, text.data, text.length, FILE_KEEP, fault));
    return OK;
}
