/* SPDX-License-Identifier: MIT */
/* The command `seed-file`. */
#include "command/act.h"

#include "base/mem.h"
#include "show/label_report.h"
#include "show/label_table.h"
#include "session/seed_file.h"

enum { LIST_BYTES_MOST = 64 << 20, LISTED_MOST = 12 };

static int label_of(const struct act *act)
{
    return (int)act_number_or(act, "label", LABEL_OWN);
}

static enum err read_list(struct seeds *seeds, const struct act *act, const char *path)
{
    const struct session *session = act->session;
    struct fault *fault = act->fault;
    struct buf *text = act_buf(act);
    if (act_has(act, "regions|as|erode|each|generator|resample|volume|data"))
        return fault_set(
            fault, ERR_USAGE,
            "regions, as, erode, each, generator, resample, volume and data are for label maps, "
            "and %s is a list; nothing was planted",
            act_text(act, "FILE"));
    TRY(file_read(text, path, LIST_BYTES_MOST, fault));
    return act_prefix_file(act, seeds_from_list(seeds, buf_text(text), text->length,
                                                &session->scene->grid, &session->now.kept,
                                                label_of(act), session->watch, fault));
}

/* Read the parameters about regions; the caller frees the labels `as`. */
static enum err choose_regions(struct region_choice *choice, uint16_t **as, const struct act *act,
                               const struct volume *map)
{
    const struct kept *kept = &act->session->now.kept;
    OWNED(regions_release) struct regions regions = {0};
    *choice = (struct region_choice){
        .first = REGION_MOST,
        .label = label_of(act),
        .erode = (unsigned)act_number(act, "erode"),
        .each = (uint32_t)act_number(act, "each"),
        .generator = (uint64_t)act_number_or(act, "generator", 1),
    };
    TRY(act_choose_regions(&regions, act, act_value(act, "label")));
    if (act_has(act, "as"))
        TRY(regions_check(&regions, kept, act->fault));
    TRY(regions_table(as, &regions, map, kept, act->fault));
    for (uint32_t r = 0; r <= REGION_MOST; r++)
        if ((*as)[r] != REGION_NONE) {
            choice->first = r < choice->first ? r : choice->first;
            choice->last = r;
        }
    choice->as = *as;
    return OK;
}

/* The caller releases the map, whose voxels are invalid afterwards, and frees `as`. */
static enum err read_map(struct seeds *seeds, struct volume *map, const struct act *act,
                         struct region_choice *choice, uint16_t **as)
{
    const struct session *session = act->session;
    struct buf *out = &act->reply->text;
    struct region_tally tally;
    TRY(act_read_map(act, map, 0, UINT32_MAX));
    TRY(choose_regions(choice, as, act, map));
    TRY(act_prefix_file(act, seeds_from_map(seeds, &tally, map, &session->scene->grid, choice,
                                            session->watch, act->fault)));
    buf_printf(out, "%u region%s\n", tally.regions, plural(tally.regions));
    if (tally.eroded_away)
        buf_printf(out, "%u more region%s with no voxel left after erosion; the first is %u\n",
                   tally.eroded_away, plural(tally.eroded_away),
                   map_number(map, tally.first_eroded_away));
    return OK;
}

/* Add "region 2001 Precentral_L is label 1, 13 seeds". */
static void write_region(const struct act *act, const struct label_table *table, uint32_t region,
                         unsigned label, size_t count)
{
    struct buf *out = &act->reply->text;
    buf_printf(out, "region %u", region);
    for (size_t i = 0; i < table->count; i++)
        if (table->entry[i].number == region) {
            buf_add_char(out, ' ');
            buf_add_safe_text(out, table->entry[i].name);
            break;
        }
    buf_add_text(out, " is label ");
    label_report_write_name(out, act->session, label);
    buf_printf(out, ", %zu seed%s\n", count, plural(count));
}

/* With `as`: report the label of each region. `end` has the end of each region. */
static void write_regions(const struct act *act, const char *atlas, const struct volume *map,
                          const uint16_t *as, const size_t *end)
{
    OWNED(label_table_release) struct label_table table = atlas_table(act, atlas);
    unsigned count = 0;
    size_t begin = 0;
    for (uint32_t r = 0; r <= REGION_MOST; begin = end[r++]) {
        if (end[r] == begin)
            continue;
        if (count++ < LISTED_MOST)
            write_region(act, &table, map_number(map, r), as[r], end[r] - begin);
    }
    if (count > LISTED_MOST)
        buf_printf(&act->reply->text, "%u more region%s\n", count - LISTED_MOST,
                   plural(count - LISTED_MOST));
}

/* Plant a region; a group of a list may have a reach, which `within` replaces. */
static enum err plant_region(const struct act *act, struct planting *planting,
                             const struct seeds *seeds, const struct region_choice *choice,
                             uint32_t region, const struct voxels *at)
{
    struct session *session = act->session;
    const bool is_group = region >= SEED_GROUPS_FROM && region - SEED_GROUPS_FROM < seeds->groups;
    int16_t label = (uint8_t)region_label(choice, region);
    planting->reach = 0;
    if (is_group) {
        const struct seed_group *group = &seeds->group[region - SEED_GROUPS_FROM];
        struct reach reach = group->reach;
        if (!reach.unit[0] && session->geometry.spacing_unknown)
            return fault_set(act->fault, ERR_INPUT,
                             "it has a distance in millimetres, but voxel size is unknown; nothing "
                             "was planted");
        for (int a = 0; a < 3; a++)
            reach.unit[a] = reach.unit[a] ? reach.unit[a] : session->scene->spacing_nm[a];
        TRY(session_add_reach(session, &reach, &planting->reach, act->fault));
        label = group->label;
    }
    TRY(act_find_exact(planting, act));
    return act_plant(act, planting, at->cell, at->count, label);
}

/* Plant each region as a marker. */
static enum err plant_regions(const struct act *act, const struct seeds *seeds, const char *path,
                              const struct volume *map, const struct region_choice *choice,
                              struct planting *planting)
{
    OWNED(mem_release) uint32_t *cell = NULL;
    OWNED(mem_release) size_t *end = mem_array(REGION_MOST + 1, sizeof *end);
    struct session *session = act->session;
    size_t begin = 0;
    TRY(end ? seeds_by_region(seeds, &cell, end, session->watch, act->fault)
            : fault_memory(act->fault, "the seeds of regions"));
    struct voxels all = {.cell = cell, .count = seeds->count};
    TRY(act_begin_exact(planting, act, &all, end, REGION_MOST + 1));
    for (uint32_t r = 0; r <= REGION_MOST; begin = end[r++]) {
        const struct voxels at = {.cell = cell + begin, .count = end[r] - begin};
        TRY(plant_region(act, planting, seeds, choice, r, &at));
    }
    if (act_has(act, "as"))
        write_regions(act, path, map, choice->as, end);
    if (!act_has(act, "label")) {
        bool has[256] = {false};
        begin = 0;
        for (uint32_t r = 0; r <= REGION_MOST; begin = end[r++])
            if (end[r] > begin &&
                region_label(choice, r) < 256) /* higher numbers are groups of a list */
                has[region_label(choice, r)] = true;
        atlas_advise_names(act, has);
    }
    return OK;
}

enum err act_seed_file(const struct act *act)
{
    struct buf *path = act_buf(act);
    OWNED(seeds_release) struct seeds seeds = {0};
    OWNED(volume_release) struct volume map = {0};
    OWNED(mem_release) uint16_t *as = NULL;
    struct region_choice choice = {.label = label_of(act)}; /* for a list, only the label is used */
    const char *name = act_text(act, "FILE");
    TRY(interpreter_find_file(act->interp, name, path, act->fault));
    if (file_is_named(name, ".csv"))
        TRY(read_list(&seeds, act, buf_text(path)));
    else
        TRY(read_map(&seeds, &map, act, &choice, &as));
    struct planting planting = act_begin_planting(act->session, act_value(act, "range"));
    TRY(plant_regions(act, &seeds, buf_text(path), &map, &choice, &planting));
    act_add_digest(act, "file", seeds_digest(&seeds));
    buf_printf(&act->reply->words, " added=%zu", planting.planted);
    act_add_markers(act);
    buf_printf(&act->reply->text, "%zu seed%s\n", planting.planted, plural(planting.planted));
    return act_prefix_file(act, act_write_planting(act, &planting));
}
