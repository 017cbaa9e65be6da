/* Seeds out of a file. */
#include "command/act.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "session/seed_file.h"

enum { LIST_BYTES_MOST = 64 << 20 };

/* The places of the parameters in the table. */
enum { FILE_NAME, LABEL, RANGE, REGIONS, ERODE, EACH, GENERATOR };

static int label_of(const struct value *value)
{
    return value[LABEL].given ? (int)value[LABEL].number : LABEL_OWN;
}

static enum err read_list(struct seeds *seeds, const struct act *act, const char *path)
{
    const struct session *session = act->session;
    const struct value *value = act->value;
    struct fault *fault = act->fault;
    struct buf text = {0};
    for (int i = REGIONS; i <= GENERATOR; i++)
        if (value[i].given)
            return fault_set(fault, ERR_USAGE,
                             "regions, erode, each and generator are for label maps, and %s is a "
                             "list; nothing was planted",
                             value[FILE_NAME].text);
    enum err err = file_read(&text, path, LIST_BYTES_MOST, fault);
    if (!err)
        err = act_naming(value[FILE_NAME].text,
                         seeds_from_list(seeds, buf_text(&text), text.length, &session->scene->grid,
                                         session->now.kept.label_name, label_of(value), fault),
                         fault);
    buf_release(&text);
    return err;
}

static enum err read_map(struct seeds *seeds, const struct act *act, const char *path)
{
    const struct session *session = act->session;
    const struct value *value = act->value;
    struct fault *fault = act->fault;
    struct buf *out = &act->reply->text;
    struct volume map = {0};
    struct region_tally tally;
    const struct region_choice choice = {
        .first = value[REGIONS].given ? value[REGIONS].place[0] : 1,
        .last = value[REGIONS].given ? value[REGIONS].place[1] : REGION_MOST,
        .label = label_of(value),
        .erode = (unsigned)value[ERODE].number,
        .each = (uint32_t)value[EACH].number,
        .generator = value[GENERATOR].given ? (uint64_t)value[GENERATOR].number : 1,
    };
    enum err err =
        map_read(&map, path, &session->scene->grid, &session->geometry, session->watch, fault);
    if (!err)
        err = act_naming(value[FILE_NAME].text,
                         seeds_from_map(seeds, &tally, &map, &session->scene->grid,
                                        &session->geometry, &choice, session->watch, fault),
                         fault);
    volume_release(&map);
    if (!err)
        buf_printf(out, "%u region%s\n", tally.regions, plural(tally.regions));
    if (!err && tally.eroded_away)
        buf_printf(out, "%u more region%s with no voxel left after erosion; the first is %u\n",
                   tally.eroded_away, plural(tally.eroded_away), tally.first_eroded_away);
    return err;
}

/* Each region is a marker. */
static enum err plant(const struct act *act, const struct seeds *seeds, struct planting *planting)
{
    uint32_t *cell = NULL;
    const int given = label_of(act->value);
    size_t *end = mem_array(REGION_MOST + 1, sizeof *end), begin = 0;
    enum err err = end ? seeds_by_region(seeds, &cell, end, act->session->watch, act->fault)
                       : fault_memory(act->fault, "the seeds of regions");
    for (uint32_t r = 0; !err && r <= REGION_MOST; begin = end[r++])
        err = act_plant(act, planting, cell + begin, end[r] - begin,
                        (uint8_t)(given == LABEL_OWN ? (int)r : given));
    free(end);
    free(cell);
    return err;
}

enum err act_seed_file(const struct act *act)
{
    struct buf path = {0};
    struct seeds seeds = {0};
    const char *name = act->value[FILE_NAME].text;
    const size_t length = strlen(name);
    enum err err = interpreter_find_file(act->interp, name, &path, act->fault);
    if (!err && length > 4 && strcmp(name + length - 4, ".csv") == 0)
        err = read_list(&seeds, act, buf_text(&path));
    else if (!err)
        err = read_map(&seeds, act, buf_text(&path));
    struct planting planting = act_begin_planting(act->session, &act->value[RANGE]);
    if (!err)
        err = plant(act, &seeds, &planting);
    buf_printf(&act->reply->words, "file=%016llx added=%zu",
               (unsigned long long)seeds_digest(&seeds), planting.planted);
    act_add_markers(act);
    buf_printf(&act->reply->text, "%zu seed%s\n", planting.planted, plural(planting.planted));
    if (!err)
        err = act_naming(name, act_write_planting(act, &planting), act->fault);
    seeds_release(&seeds);
    buf_release(&path);
    return err;
}
