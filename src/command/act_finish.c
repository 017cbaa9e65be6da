/* The commands `finish` and `finished`, and how commands get the labels that come of it. */
#include "command/act.h"

#include "session/session.h"
#include "show/draw.h"

/* The places of the parameters in the table. */
enum { FINISH_STEP, FINISH_RADIUS, FINISH_VOXELS, FINISH_SWEEPS, FINISH_LABEL };

void act_write_finish(struct buf *out, const struct session *session)
{
    if (!session_kept(session)->finish.count)
        return;
    buf_add_text(out, "finish    ");
    finish_write(out, &session_kept(session)->finish);
    buf_add_text(out, session_outlook(session)->shows_finished ? "; pictures show it\n" : "\n");
}

/* What is given beside the name: what the row takes, and nothing else. */
static enum err take_argument(struct finish_step *step, const struct value *value,
                              struct fault *fault)
{
    static const struct {
        const char *name;
        enum finish_argument takes;
    } argument[] = {[FINISH_RADIUS] = {"radius", FINISH_TAKES_RADIUS},
                    [FINISH_VOXELS] = {"voxels", FINISH_TAKES_VOXELS},
                    [FINISH_SWEEPS] = {"sweeps", FINISH_TAKES_SWEEPS}};
    const struct finish_row *row = &finish_table[step->kind];
    step->argument = row->usual;
    for (int i = FINISH_RADIUS; i <= FINISH_SWEEPS; i++) {
        if (value[i].given && row->takes != argument[i].takes)
            return fault_set(fault, ERR_USAGE, "%s: `finish %s` has none", argument[i].name,
                             row->name);
        if (row->takes != argument[i].takes)
            continue;
        if (!value[i].given && !row->usual)
            return fault_set(fault, ERR_USAGE, "%s: `finish %s` needs it", argument[i].name,
                             row->name);
        if (value[i].given)
            step->argument = (uint32_t)value[i].number;
        step->in_nm = value[i].in_mm;
    }
    return OK;
}

static enum err add_step(struct finish_list *list, const struct act *act)
{
    const struct value *label = &act->value[FINISH_LABEL];
    struct finish_step step = {.kind = (uint32_t)act->value[FINISH_STEP].number,
                               .label = label->given ? (uint32_t)label->number : FINISH_ALL_LABELS};
    const enum err err = take_argument(&step, act->value, act->fault);
    if (err)
        return err;
    if (list->count == FINISH_STEPS_MOST)
        return fault_set(act->fault, ERR_LIMIT,
                         "the finish has %d steps, and no room for more; `finish none` removes "
                         "them, `undo` the last one",
                         FINISH_STEPS_MOST);
    list->step[list->count++] = step;
    return finish_check(list, session_scene(act->session), act->fault);
}

enum err act_finish(const struct act *act)
{
    const struct value *step = &act->value[FINISH_STEP];
    struct finish_list *list = &act->next->kept.finish;
    const bool clears = step->given && step->number == FINISH_KIND_COUNT;
    for (int i = FINISH_RADIUS; i <= FINISH_LABEL && (clears || !step->given); i++)
        if (act->value[i].given)
            return fault_set(act->fault, ERR_USAGE, "expected a step: " FINISH_KINDS);
    if (clears)
        *list = (struct finish_list){0};
    enum err err = step->given && !clears ? add_step(list, act) : OK;
    if (!err)
        err = act_go(act);
    if (err)
        return err;
    if (!list->count)
        buf_add_text(&act->reply->text, "finish    none\n");
    act_write_finish(&act->reply->text, act->session);
    return OK;
}

static enum err take(const struct act *act, bool finished, struct labels *labels)
{
    struct session *session = act->session;
    *labels = labels_of_forest(session_scene(session));
    if (session_skims(session) || !finished)
        return OK;
    const enum err err = session_labels(session, true, labels, act->fault);
    if (!err) {
        buf_add_blank(&act->reply->words);
        buf_printf(&act->reply->words, "finished=%016llx",
                   (unsigned long long)session_finished_digest(session));
    }
    return err;
}

enum err act_take_labels(const struct act *act, const struct value *finished, struct labels *labels)
{
    return take(act, act_is_yes(finished), labels);
}

enum err act_take_shown(const struct act *act, const struct value *finished, struct labels *labels)
{
    return take(act, finished->given ? act_is_yes(finished) : session_shows_finished(act->session),
                labels);
}
