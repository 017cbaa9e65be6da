/* Commands that open a scene and change its forest. */
#include "command/act.h"
#include "command/near.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "journal/record.h"
#include "session/map.h"

enum { TAKEN_MOST = 256 }; /* seeds that one record says were removed */

/* The answer of a command that gave the session its scene. */
static void write_scene(const struct act *act)
{
    const struct session *session = act->session;
    struct reply *reply = act->reply;
    const struct scene *scene = session->scene;
    const uint32_t *size = scene->grid.size, *nm = scene->spacing_nm;
    buf_printf(&reply->words, "scene=%016llx size=%u,%u,%u spacing-nm=%u,%u,%u weights=%016llx",
               (unsigned long long)session->scene_digest, size[0], size[1], size[2], nm[0], nm[1],
               nm[2], (unsigned long long)session->weight_digest);
    buf_printf(&reply->text, "%ux%ux%u voxels of %gx%gx%g mm, %.1f MB\n", size[0], size[1], size[2],
               nm[0] / 1e6, nm[1] / 1e6, nm[2] / 1e6, (double)session_memory(session) / 1e6);
}

enum err act_open(const struct act *act)
{
    struct buf path = {0};
    struct session *session = act->session;
    enum err err = interpreter_find_scene(act->interp, act->value[0].text, &path, act->fault);
    if (!err)
        err = session_open(session, buf_text(&path), act->fault);
    buf_release(&path);
    if (!err)
        write_scene(act);
    if (!err && *session->proof)
        buf_printf(&act->reply->words, " sha256=%s", session->proof);
    return err;
}

enum err act_interpolate(const struct act *act)
{
    unsigned doubled = 0;
    for (unsigned a = 0; a < 3; a++)
        doubled |= (unsigned)(act->value[a].number == 2) << a;
    enum err err = session_interpolate(act->session, doubled, act->fault);
    if (!err)
        write_scene(act);
    return err;
}

/* After a command that may have changed weights: what they are now. */
static enum err add_weights(const struct act *act, enum err err)
{
    if (!err)
        buf_printf(&act->reply->words, "weights=%016llx",
                   (unsigned long long)act->session->weight_digest);
    return err;
}

static enum err weigh_by_file(const struct act *act, const char *name)
{
    struct session *session = act->session;
    struct fault *fault = act->fault;
    struct volume map = {0};
    struct buf path = {0};
    enum err err = interpreter_find_file(act->interp, name, &path, fault);
    if (err) {
        struct near near = near_to(name);
        near_try_choices(&near, WEIGHT_KINDS);
        fault_prefix(fault, err, "expected " WEIGHT_KINDS " or a file");
        near_append(&near, "", fault);
    }
    if (!err)
        err = map_read(&map, buf_text(&path), &session->scene->grid, &session->geometry,
                       session->watch, fault);
    if (!err)
        err = act_naming(name, map_to_weights(&map, fault), fault);
    if (!err)
        err = session_set_weight_map(session, name, map.intensity, fault);
    volume_release(&map);
    buf_release(&path);
    return err;
}

#define ARGUMENT_NAME(name, type, least, most) name

/* What is given beside the name: what the row takes, and nothing else. */
static enum err take_argument(struct weight_choice *choice, const struct value *value,
                              struct fault *fault)
{
    static const char *const name[] = {WEIGHT_ARGUMENTS(ARGUMENT_NAME, ARGUMENT_NAME)};
    const struct weight_row *row = &weight_table[choice->kind];
    for (unsigned i = 0; i < WEIGHT_ARGUMENT_COUNT; i++)
        if (value[i].given && row->takes != i)
            return fault_set(fault, ERR_USAGE, "%s: `weight %s` has none", name[i], row->name);
    if (row->takes == WEIGHT_TAKES_NOTHING)
        return OK;
    const struct value *given = &value[row->takes];
    if (!given->given && !row->usual)
        return fault_set(fault, ERR_USAGE, "%s: `weight %s` needs one", name[row->takes],
                         row->name);
    choice->argument = given->given ? (uint32_t)given->number : row->usual;
    return OK;
}

enum err act_weight(const struct act *act)
{
    const bool is_file = act->value[0].number < 0;
    struct kept *kept = &act->next->kept;
    kept->weight =
        (struct weight_choice){is_file ? WEIGHT_FILE : (enum weight_kind)act->value[0].number, 0};
    const enum err err = take_argument(&kept->weight, act->value + 1, act->fault);
    if (err)
        return err;
    if (is_file)
        return add_weights(act, weigh_by_file(act, act->value[0].text));
    kept->weight_map = NULL;
    memset(kept->weight_file, 0, sizeof kept->weight_file);
    return add_weights(act, act_go(act));
}

enum err act_polarity(const struct act *act)
{
    act->next->kept.polarity[act->value[0].number] = (int8_t)act->value[1].number;
    if (act->next->kept.weight.kind != WEIGHT_POLARITY)
        buf_add_text(&act->reply->text, "used only under `weight polarity`\n");
    return add_weights(act, act_go(act));
}

enum err act_adjacency(const struct act *act)
{
    act->next->kept.adjacency = act->value[0].number == 0 ? 6 : 26;
    return add_weights(act, act_go(act));
}

bool act_name_is_fit(const char *name, size_t room)
{
    const unsigned char first = (unsigned char)*name;
    if (strlen(name) >= room || (first < 0x80 && !isalpha(first)))
        return false;
    for (size_t left = strlen(name); left > 0;) {
        size_t n = safe_character(name, left);
        if (n == 0 || *name == ' ' || *name == '=' || *name == '"' || *name == '\\')
            return false;
        name += n;
        left -= n;
    }
    return true;
}

enum err act_label(const struct act *act)
{
    struct kept *kept = &act->next->kept;
    const size_t label = (size_t)act->value[0].number;
    if (!act_name_is_fit(act->value[1].text, LABEL_NAME_BYTES))
        return fault_set(act->fault, ERR_USAGE,
                         "NAME: expected a word of at most %d bytes that begins with a letter, "
                         "not %s",
                         LABEL_NAME_BYTES - 1, act->value[1].text);
    for (size_t other = 0; other < 256; other++)
        if (other != label && strcmp(kept->label_name[other], act->value[1].text) == 0)
            return fault_set(act->fault, ERR_USAGE, "label %zu is already called %s", other,
                             act->value[1].text);
    memset(kept->label_name[label], 0, LABEL_NAME_BYTES);
    memcpy(kept->label_name[label], act->value[1].text, strlen(act->value[1].text));
    for (int k = 0; act->value[2].given && k < 3; k++)
        kept->palette.rgb[label][k] = (uint8_t)(act->value[2].number >> (16 - 8 * k));
    return act_go(act);
}

/* Voxels, as a list that grows. */
struct voxels {
    uint32_t *cell;
    size_t count, capacity;
};

/* Adds the voxels of the scene within `radius` of a place, plane by plane, without those within as
 * much of `but` (NULL for none), which are there already. False when out of memory. */
static bool add_ball(struct voxels *v, const struct grid *grid, const int64_t place[3],
                     const int64_t *but, int64_t radius)
{
    const size_t side = (size_t)(2 * radius + 1);
    if (!mem_grow(&v->cell, &v->capacity, v->count + side * side * side, sizeof *v->cell))
        return false;
    for (int64_t z = -radius; z <= radius; z++)
        for (int64_t y = -radius; y <= radius; y++)
            for (int64_t x = -radius; x <= radius; x++) {
                const int64_t at[3] = {place[0] + x, place[1] + y, place[2] + z};
                int64_t far = radius * radius + 1;
                for (int a = 0; but && a < 3; a++)
                    far = (a ? far : 0) + (at[a] - but[a]) * (at[a] - but[a]);
                if (x * x + y * y + z * z <= radius * radius && far > radius * radius &&
                    grid_contains(grid, at[0], at[1], at[2]))
                    v->cell[v->count++] =
                        grid_cell(grid, (uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]);
            }
    return true;
}

/* `from` plus `part` of `parts` of the way to `to`, to the nearest voxel. */
static void step_to(int64_t at[3], const uint32_t from[3], const uint32_t to[3], int64_t part,
                    int64_t parts)
{
    for (int a = 0; a < 3; a++) {
        const int64_t way = (int64_t)to[a] - from[a], twice = 2 * way * part;
        at[a] = from[a] + (parts ? (twice + (twice < 0 ? -parts : parts)) / (2 * parts) : 0);
    }
}

/* A ball at each step of the straight line between two places. */
static bool add_stroke(struct voxels *v, const struct grid *grid, const uint32_t from[3],
                       const uint32_t to[3], int64_t radius)
{
    int64_t steps = 0, at[3], before[3];
    for (int a = 0; a < 3; a++) {
        const int64_t way = from[a] < to[a] ? to[a] - from[a] : from[a] - to[a];
        steps = way > steps ? way : steps;
    }
    bool fits = true;
    for (int64_t i = 0; fits && i <= steps; i++) {
        step_to(at, from, to, i, steps);
        fits = add_ball(v, grid, at, i ? before : NULL, radius);
        memcpy(before, at, sizeof at);
    }
    return fits;
}

static struct voxels ball(const struct grid *grid, const uint32_t place[3], int64_t radius,
                          enum err *err, struct fault *fault)
{
    struct voxels v = {0};
    if (!add_stroke(&v, grid, place, place, radius))
        *err = fault_memory(fault, "a ball of voxels");
    return v;
}

enum err act_seed(const struct act *act)
{
    struct session *session = act->session;
    const struct grid *grid = &session->scene->grid;
    const uint32_t *to = act->value[3].given ? act->value[3].place : act->value[0].place;
    struct voxels v = {0};
    size_t inside = 0;
    enum err err = add_stroke(&v, grid, act->value[0].place, to, act->value[2].number)
                       ? OK
                       : fault_memory(act->fault, "a stroke of seeds");
    for (size_t i = 0; !err && i < v.count; i++)
        if (!act_is_outside(session, v.cell[i]))
            v.cell[inside++] = v.cell[i];
    if (!err && inside)
        err = session_plant(session, v.cell, inside, (uint8_t)act->value[1].number, act->fault);
    free(v.cell);
    return err ? err : act_write_outside(act, inside, v.count - inside);
}

/* Which seeds an eliminator removed, for the journal: "took=X,Y,Z;X,Y,Z". Nothing where they are
 * more than a line should hold. */
static void add_taken(const struct session *session, struct reply *reply)
{
    const struct edit *edit = edits_first(&session->now.pending);
    const size_t before = edits_count(&session->former.pending), now = session_pendings(session);
    const char *between = "took=";
    if (now - before > TAKEN_MOST)
        return;
    for (size_t i = before; i < now; i++) {
        const struct place p = grid_place(&session->scene->grid, edit[i].cell);
        buf_printf(&reply->words, "%s%u,%u,%u", between, p.x, p.y, p.z);
        between = ";";
    }
}

/* The seeds that a record says were removed; ERR_CHECK where it does not say it so. */
static enum err read_taken(const struct grid *grid, const struct record_word *word, uint32_t *seed,
                           size_t *count, struct fault *fault)
{
    const char *at = word->value, *end = word->value + word->value_length;
    bool goes_on = true;
    for (*count = 0; goes_on && *count < TAKEN_MOST; goes_on = scan_text(&at, ";")) {
        int64_t place[3];
        if (!scan_integer(&at, 0, grid->size[0] - 1, &place[0]) || !scan_text(&at, ",") ||
            !scan_integer(&at, 0, grid->size[1] - 1, &place[1]) || !scan_text(&at, ",") ||
            !scan_integer(&at, 0, grid->size[2] - 1, &place[2]))
            break;
        seed[(*count)++] =
            grid_cell(grid, (uint32_t)place[0], (uint32_t)place[1], (uint32_t)place[2]);
    }
    return at == end ? OK : fault_set(fault, ERR_CHECK, "took: expected X,Y,Z;X,Y,Z");
}

/* In a ball, voxels that no tree holds are ignored, unless that is all of them. Only a forest that
 * is up to date knows which tree holds a voxel; a session that skims a journal reads there which
 * seeds were removed, and where that is not recorded has to catch up. */
static enum err eliminate(const struct act *act)
{
    struct session *session = act->session;
    struct fault *fault = act->fault;
    const char *recorded = act->interp->recorded_words;
    uint32_t taken[TAKEN_MOST];
    struct record_word word;
    size_t count;
    enum err err = OK;
    if (session->skims && recorded && record_word_find(recorded, "took", 4, &word)) {
        err = read_taken(&session->scene->grid, &word, taken, &count, fault);
        return err ? err : session_erase_seeds(session, taken, count, fault);
    }
    if (session->skims)
        err = session_catch_up(session, fault);
    if (err)
        return err;
    const struct voxels v =
        ball(&session->scene->grid, act->value[0].place, act->value[1].number, &err, fault);
    if (!err)
        err = session_erase_trees(session, v.cell, v.count, fault);
    free(v.cell);
    return err;
}

enum err act_remove(const struct act *act)
{
    struct session *session = act->session;
    const enum err err = eliminate(act);
    if (err)
        return err;
    add_taken(session, act->reply);
    const uint32_t *p = act->value[0].place;
    const uint32_t cell = grid_cell(&session->scene->grid, p[0], p[1], p[2]);
    return session_note_eliminator(session, cell, act->fault);
}

enum err act_run(const struct act *act)
{
    return session_run(act->session, act->fault);
}

enum err act_auto(const struct act *act)
{
    act->next->outlook.runs_by_itself = act->value[0].number == 0;
    return act_go(act);
}
