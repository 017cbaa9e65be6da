/* SPDX-License-Identifier: MIT */
/* The command `labels`, which makes markers from an existing segmentation; and commands that remove
 * seeds and run. */
#include "show/label_report.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/mem.h"
#include "base/scan.h"
#include "base/sort.h"
#include "command/act.h"
#include "command/golden_files.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "session/map.h"
#include "session/markers.h"
#include "session/paint.h"
#include "session/seed_file.h"
#include "image/names.h"
#include "show/label_table.h"

enum { TAKEN_MOST = 256 }; /* seeds in the record of one command */

/* ---- eliminators ---- */

/* The tree of a voxel is known only in an up-to-date forest. */
static enum err find_removed(const struct act *act, struct voxels *v)
{
    TRY(session_catch_up(act->session, act->fault));
    return act_find_voxels(act, NULL, v);
}

/* ---- single trees ---- */

/* Read the removed seeds from a record; ERR_CHECK if the word is invalid. */
static enum err read_taken(const struct grid *grid, const struct record_word *word, uint32_t *seed,
                           size_t *count, struct fault *fault)
{
    const char *at = word->value, *end = word->value + word->value_length;
    bool fits = true;
    *count = 0;
    do {
        int64_t p[3];
        fits = *count < TAKEN_MOST && scan_three(&at, 0, 0, UINT32_MAX, p) &&
               grid_contains(grid, p[0], p[1], p[2]);
        if (fits)
            seed[(*count)++] = grid_cell(grid, (uint32_t)p[0], (uint32_t)p[1], (uint32_t)p[2]);
    } while (fits && scan_text(&at, ";"));
    return fits && at == end ? OK : fault_set(fault, ERR_CHECK, "took: expected X,Y,Z;X,Y,Z");
}

static enum err remove_trees(const struct act *act)
{
    struct session *session = act->session;
    uint32_t taken[TAKEN_MOST];
    struct record_word word;
    OWNED(voxels_release) struct voxels v = {0};
    size_t count;
    if (act_find_recorded(act, "took", &word)) {
        TRY(read_taken(&session->scene->grid, &word, taken, &count, act->fault));
        TRY(session_erase_seeds(session, taken, count, act->fault));
    } else {
        TRY(find_removed(act, &v));
        TRY(session_erase_trees(session, v.cell, v.count, act->fault));
    }
    /* Record the removed seeds: "took=X,Y,Z;X,Y,Z"; nothing if there are too many for a line. */
    const struct edit *edit = edits_first(&session->now.lists.pending);
    const size_t before = edits_count(&session->former.lists.pending),
                 now = session_pendings(session);
    for (size_t i = before; now - before <= TAKEN_MOST && i < now; i++) {
        const struct place p = grid_place(&session->scene->grid, edit[i].cell);
        buf_printf(&act->reply->words, "%s%u,%u,%u", i == before ? "took=" : ";", p.x, p.y, p.z);
    }
    return OK;
}

/* ---- markers ---- */

/* Read the removed markers from a record, an array that the caller frees. */
static enum err read_removed(const struct markers *markers, const struct record_word *word,
                             uint32_t **number, size_t *count, struct fault *fault)
{
    const char *at = word->value, *end = word->value + word->value_length;
    bool fits = true;
    *count = 0;
    *number = mem_array(markers->count + 1, sizeof **number);
    if (!*number)
        return fault_memory(fault, "markers");
    do {
        int64_t first, last;
        fits = scan_range(&at, 1, (int64_t)markers->count, &first, &last) &&
               *count + (size_t)(last - first) < markers->count;
        for (int64_t n = first; fits && n <= last; n++)
            (*number)[(*count)++] = (uint32_t)n;
    } while (fits && scan_text(&at, ","));
    return fits && at == end ? OK : fault_set(fault, ERR_CHECK, "removed: expected N,N-N");
}

static enum err remove_markers(const struct act *act)
{
    struct session *session = act->session;
    const struct markers *markers = &session->markers;
    struct record_word word;
    OWNED(voxels_release) struct voxels v = {0};
    OWNED(mem_release) uint32_t *number = NULL;
    size_t count, seeds = 0;
    if (act_find_recorded(act, "removed", &word)) {
        TRY(read_removed(markers, &word, &number, &count, act->fault));
    } else {
        TRY(find_removed(act, &v));
        TRY(session_find_markers(session, v.cell, v.count, &number, &count, act->fault));
    }
    /* Count the seeds of a whole stroke, or of an outline without its ring. */
    const uint32_t first = count == 1 ? number[0] : 0;
    for (uint32_t n = first; n; n = markers_next(markers, n))
        if (markers->marker[n - 1].label == markers->marker[first - 1].label)
            seeds += markers->marker[n - 1].voxels;
    TRY(session_remove_markers(session, number, count, act->fault));
    /* Record the removed markers: "removed=3,7-9", in order. */
    struct buf *words = &act->reply->words, *out = &act->reply->text;
    buf_add_blank(words);
    buf_add_text(words, "removed=");
    for (size_t i = 0, last; i < count; i = last + 1) {
        for (last = i; last + 1 < count && number[last + 1] == number[last] + 1;)
            last++;
        buf_printf(words, i ? ",%u" : "%u", number[i]);
        if (last > i)
            buf_printf(words, "-%u", number[last]);
    }
    if (count > 1) {
        buf_printf(out, "%zu markers removed\n", count);
    } else {
        buf_printf(out, "marker %u removed: %zu seed%s of label ", first, seeds, plural(seeds));
        label_report_write_name(out, session, (unsigned)markers->marker[first - 1].label);
        buf_add_char(out, '\n');
    }
    return OK;
}

/* Voxels without a tree are ignored, unless the ball has no others. */
enum err act_remove(const struct act *act)
{
    enum { MARKER };
    struct session *session = act->session;
    TRY(act_number_or(act, "of", MARKER) == MARKER ? remove_markers(act) : remove_trees(act));
    const uint32_t *p = act_place(act, "PLACE");
    const uint32_t cell = grid_cell(&session->scene->grid, p[0], p[1], p[2]);
    return session_note_eliminator(session, cell, act->fault);
}

/* ---- runs ---- */

enum err act_run(const struct act *act)
{
    return session_run(act->session, act->fault);
}

enum { LISTED_MOST = 10 };

/* Number of pieces from which a map may be noise; memory for a seed with all its data. */
enum { NOISE_PIECES = 1000, SEED_BYTES = 94 };

/* ---- the copy next to the journal ---- */

/* Find the path of the copy; empty if there is no journal. */
static enum err find_copy(struct buf *path, const struct act *act, const char *digest)
{
    const struct interpreter *interp = act->interp;
    buf_clear(path);
    if (!interp->home.length)
        return OK;
    TRY(golden_folder(path, buf_text(&interp->home), act->fault));
    buf_add_char(path, '/');
    label_copy_name(path, digest);
    return OK;
}

/* Write the copy, unless it exists: then its content is the same. Nothing is written for a journal
 * opened read-only. */
static enum err keep_copy(const struct act *act, const struct volume *map,
                          const struct label_table *names, const char *digest)
{
    struct interpreter *interp = act->interp;
    struct buf *path = act_buf(act);
    OWNED(golden_files_close) struct golden_files files = {.folder = -1};
    struct volume_label label[256] = {0};
    const bool only_looks = interp->journal && journal_only_looks(interp->journal);
    for (unsigned l = 0; l < 256; l++)
        label[l].name = label[l].code = "";
    for (size_t i = 0; i < names->count; i++) {
        const struct label_entry *entry = &names->entry[i];
        struct volume_label *of = &label[entry->number];
        *of = (struct volume_label){entry->name, entry->code, {0}, entry->number, true};
        memcpy(of->rgb, entry->rgb, sizeof of->rgb);
    }
    TRY(find_copy(path, act, digest));
    if (!path->length || only_looks || file_exists(buf_text(path)))
        return OK;
    TRY(golden_files_open(&files, buf_text(&interp->home), true, act->fault));
    TRY(interpreter_will_write(interp, buf_text(path), FILE_KEEP, act->fault));
    TRY(label_copy_write(buf_text(path), map, names->count ? label : NULL, &act->session->geometry,
                         act->session->watch, act->fault));
    act_write_file_line("copied to ", buf_text(path), act->reply);
    return OK;
}

/* ---- the labels ---- */

/* Number the labels by the record. */
static enum err apply_numbers(const struct act *act, const char *list)
{
    struct numbering_tally tally;
    struct buf *out = &act->reply->text;
    const enum err err =
        numbering_take(&act->next->kept, &tally, list, &act->session->markers, act->fault);
    if (err)
        return act_prefix_file(act, err);
    if (tally.added)
        buf_printf(out, "%u region%s of it %s label%s with the file's number%s\n", tally.added,
                   plural(tally.added), tally.added == 1 ? "is a" : "are", plural(tally.added),
                   plural(tally.added));
    if (tally.names)
        buf_printf(out, "%u label%s that had only a name made room\n", tally.names,
                   plural(tally.names));
    return OK;
}

/* Make labels of the chosen regions without one: `numbers`. */
static enum err number_regions(struct buf *numbers, const uint16_t *as, const struct act *act,
                               const struct volume *map, const struct label_table *names)
{
    OWNED(mem_release) bool *has = map_regions(map);
    if (!has)
        return fault_memory(act->fault, "the regions");
    numbering_list(numbers, as, map, has, &act->session->now.kept);
    TRY(numbers->length ? apply_numbers(act, buf_text(numbers)) : OK);
    if (!numbers->length || act_has(act, "regions") ||
        !file_is_named(act_text(act, "FILE"), ".seg.nrrd|.dcm"))
        return OK;
    struct kept *kept = &act->next->kept;
    for (size_t i = 0; i < names->count; i++) { /* segments without voxels */
        const uint32_t number = names->entry[i].number;
        if (!number || numbering_find(kept, number) != NUMBER_UNKNOWN)
            continue;
        const int label = numbering_add(kept, number, &act->session->markers);
        if (label == NUMBER_UNKNOWN)
            break;
        kept->label_is_region[label] = true;
        buf_printf(numbers, ",%u", number);
    }
    return OK;
}

/* `rest=keep`: the regions that are not chosen are written back as they were. */
enum { REST_NONE = 1, REST_KEEP = 2 };
static bool keeps_rest(const struct act *act)
{
    return act_number(act, "rest") == REST_KEEP;
}

/* Mark the regions that have become no label as kept. */
static enum err mark_kept(struct volume *map, const uint16_t *region, struct fault *fault)
{
    const size_t voxels = voxels_in(map->size);
    for (size_t i = 0; i < voxels; i++) {
        if (map->intensity[i] != REGION_NONE)
            continue;
        if (map->number || region[i] >= REGION_NONE - KEPT_FROM)
            return fault_set(fault, ERR_INPUT,
                             "region %u cannot be kept, since its number is above %d; nothing has "
                             "changed",
                             map_number(map, region[i]), REGION_NONE - 1 - KEPT_FROM);
        map->intensity[i] = (uint16_t)(KEPT_FROM + region[i]);
    }
    return OK;
}

/* Without `regions`, reject values that are no regions. */
static enum err find_regions(struct volume *map, const struct act *act)
{
    const uint64_t beyond = act_has(act, "regions") && !keeps_rest(act)
                                ? 0
                                : map_count_beyond(map, act->session->watch);
    if (beyond)
        return fault_set(act->fault, ERR_INPUT,
                         "%llu of its voxels hold%s numbers below 0 or above %u, which are no "
                         "regions%s; nothing was planted",
                         (unsigned long long)beyond, beyond == 1 ? "s" : "", UINT32_MAX,
                         keeps_rest(act)
                             ? " and cannot be kept"
                             : "; with regions=1-255, or others, these become background");
    return map_to_regions(map, 0, UINT32_MAX, act->session->watch, act->fault);
}

/* Read a table out of a map; one that is not a table is noted. */
static enum err read_names(struct label_table *names, const struct act *act, const struct buf *text)
{
    struct fault own = {.text = ""};
    const enum err err =
        text->length ? label_table_read(names, text->data, text->length, true, &own) : OK;
    if (err == ERR_MEMORY)
        return fault_memory(act->fault, "the names of labels");
    if (err)
        buf_printf(&act->reply->text, "the names of its labels are not read: %s\n", own.text);
    return OK;
}

/* Replace the numbers of a table by labels, as the map was, also of labels without voxels. Keep
 * none for a label of several entries. An entry without a colour has the present one. */
static void choose_names(struct label_table *names, const struct act *act,
                         const struct regions *regions)
{
    const int64_t one = act_number_or(act, "label", LABEL_OWN);
    struct label_entry of[256];
    unsigned entries[256] = {0};
    unsigned left = 0, partial = 0;
    for (size_t i = 0; i < names->count; i++) {
        uint32_t number = names->entry[i].number;
        if (!number)
            continue;
        if (!regions_choose(regions, number, &number)) {
            left += keeps_rest(act);
            continue;
        }
        const int64_t label = one == LABEL_OWN ? numbering_find(&act->next->kept, number) : one;
        if (label <= 0 || entries[label]++)
            continue;
        partial += names->entry[i].is_partial;
        of[label] = names->entry[i];
        of[label].number = (uint32_t)label;
        if (!of[label].has_colour)
            memcpy(of[label].rgb, act->next->kept.palette.rgb[label], sizeof of->rgb);
        of[label].has_colour = true;
    }
    names->count = 0;
    if (left)
        buf_printf(&act->reply->text, "%u name%s of other regions %s not kept\n", left,
                   plural(left), left == 1 ? "is" : "are");
    if (partial)
        buf_printf(
            &act->reply->text,
            "%u label%s with more in the file, which is not kept: IDs or tags of 3D Slicer, or "
            "the category, modifier or region of a code\n",
            partial, plural(partial));
    for (unsigned label = 1; label < 256; label++)
        if (entries[label] == 1)
            names->entry[names->count++] = of[label];
}

/* Name the labels of the map, and append the words of the table. */
static void apply_names(const struct act *act, const struct label_table *names)
{
    struct label_tally tally;
    struct buf *out = &act->reply->text;
    if (!names->count)
        return;
    label_table_fill(&act->next->kept, &tally, names);
    act_add_digest(act, "names", label_table_digest(&act->next->kept));
    if (tally.names && tally.names == tally.colours)
        buf_printf(out, "%u name%s and colours from the file\n", tally.names, plural(tally.names));
    else if (tally.names || tally.colours)
        buf_printf(out, "%u name%s and %u colour%s from the file\n", tally.names,
                   plural(tally.names), tally.colours, plural(tally.colours));
    if (tally.codes)
        buf_printf(out, "%u code%s from the file\n", tally.codes, plural(tally.codes));
    act_write_changed_names(act, &tally);
}

/* Append the table as it is part of the copy's digest. */
static void write_names(struct buf *out, const struct label_table *names)
{
    for (size_t i = 0; i < names->count; i++)
        names_add(out, names->entry[i].number, names->entry[i].rgb, names->entry[i].name,
                  strlen(names->entry[i].name), names->entry[i].code);
}

/* Set the voxels of a map to the present labels; in those of `beyond`, only to labels above 0. */
static enum err fill_with_labels(struct volume *map, const uint8_t *beyond, const struct act *act)
{
    struct session *session = act->session;
    struct labels labels = labels_of_forest(session->scene);
    uint16_t *to = map->intensity;
    TRY(session_catch_up(session, act->fault));
    if (act_is_yes(act, "finished"))
        TRY(session_labels(session, true, &labels, act->fault));
    for (struct grid_walk w = scene_walk(session->scene, "present labels", NULL, 0);
         grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++, to++)
            if (!beyond || (*beyond++ && labels_at(&labels, c)))
                *to = labels_at(&labels, c);
    return watch_fault(session->watch, act->fault);
}

/* Take the present labels as the map. */
static enum err read_here(struct volume *map, const struct act *act)
{
    const struct grid *grid = &act->session->scene->grid;
    map->intensity = mem_array(grid->voxels, sizeof *map->intensity);
    memcpy(map->size, grid->size, sizeof map->size);
    map->geometry = act->session->geometry;
    return map->intensity ? fill_with_labels(map, NULL, act)
                          : fault_memory(act->fault, "the present labels");
}

static enum err read_original(struct volume *map, struct label_table *names, const struct act *act,
                              struct buf *numbers)
{
    const struct session *session = act->session;
    const struct kept *kept = &act->next->kept;
    struct map_labels choice = {.label = (int)act_number_or(act, "label", LABEL_OWN)};
    OWNED(regions_release) struct regions regions = {0};
    OWNED(mem_release) uint16_t *as = NULL, *region = NULL;
    OWNED(mem_release) uint8_t *beyond = NULL;
    struct buf *text = act_buf(act), *path = act_buf(act);
    struct map_place place = act_map_place(act);
    place.choice.threshold = (uint32_t)act_number(act, "threshold");
    TRY(act_choose_regions(&regions, act, act_value(act, "label")));
    place.names = text;
    place.choice.segments = keeps_rest(act) ? NULL : act_text(act, "regions");
    if (act_has(act, "as"))
        TRY(regions_check(&regions, kept, act->fault));
    if (place.resample == REGRID_RESAMPLE &&
        !(place.beyond = beyond = mem_new(session->scene->grid.voxels)))
        return fault_memory(act->fault, "a map");
    TRY(interpreter_find_file(act->interp, act_text(act, "FILE"), path, act->fault));
    TRY(map_read(map, buf_text(path), &place, session->watch, act->fault));
    TRY(act_prefix_file(act, find_regions(map, act)));
    TRY(read_names(names, act, text));
    TRY(regions_table(&as, &regions, map, kept, act->fault));
    if (!act_has(act, "as|label"))
        TRY(number_regions(numbers, as, act, map, names));
    if (numbers->length) {
        free(as);
        TRY(regions_table(&as, &regions, map, kept, act->fault));
    }
    if (!act_has(act, "regions") || keeps_rest(act))
        as[0] = 0; /* the background */
    choice.as = as;
    if (keeps_rest(act)) { /* copy the regions before they become labels */
        const size_t voxels = voxels_in(map->size);
        region = mem_array(voxels, sizeof *region);
        if (!region)
            return fault_memory(act->fault, "the regions that are kept");
        memcpy(region, map->intensity, voxels * sizeof *region);
    }
    TRY(act_prefix_file(act, map_label(map, &choice, session->watch, act->fault)));
    if (region)
        TRY(act_prefix_file(act, mark_kept(map, region, act->fault)));
    if (beyond)
        TRY(fill_with_labels(map, beyond, act));
    choose_names(names, act, &regions);
    buf_add_text(&act->reply->text, map->notes);
    return OK;
}

static bool is_here(const struct act *act)
{
    return act_number(act, "FILE") == 0;
}

/* Remove all seeds that belong to no piece: the pieces take their place. */
static enum err erase_seeds(const struct act *act)
{
    struct session *session = act->session;
    OWNED(voxels_release) struct voxels seeds = {0};
    for (struct grid_walk w = scene_walk(session->scene, "seeds", NULL, 0); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            if (!(session->scene->cell[c].flags & CELL_SEED) || !markers_show(&session->markers, c))
                continue;
            if (!mem_grow(&seeds.cell, &seeds.capacity, seeds.count + 1, sizeof *seeds.cell))
                return fault_memory(act->fault, "seeds");
            seeds.cell[seeds.count++] = c;
        }
    TRY(watch_fault(session->watch, act->fault));
    if (!seeds.count)
        return OK;
    return session_plant(session, seeds.cell, seeds.count, EDIT_ERASE, 0, act->fault);
}

/* Read a copy on the scene's grid; its digest is checked by the caller. */
static enum err read_copy(struct volume *map, struct label_table *names, const struct act *act,
                          const char *path)
{
    const struct session *session = act->session;
    struct buf *text = act_buf(act);
    const struct map_place place = {.grid = &session->scene->grid,
                                    .geometry = &session->geometry,
                                    .is_copy = true,
                                    .names = text};
    bool leads_out;
    enum err err = interpreter_may_read(act->interp, path, &leads_out, act->fault);
    if (!err)
        err = map_read(map, path, &place, session->watch, act->fault);
    if (!err)
        err = map_to_regions(map, 0, keeps_rest(act) ? REGION_NONE - 1 : 255, session->watch,
                             act->fault);
    if (!err)
        err = read_names(names, act, text);
    for (size_t i = 0; !err && i < names->count; i++)
        if (names->entry[i].number > 255) /* they are labels, not numbers of regions */
            err = fault_set(act->fault, ERR_INPUT,
                            "%s names a label %u, above 255; nothing was planted", path,
                            names->entry[i].number);
    return err && err != ERR_MEMORY && err != ERR_CANCELLED && leads_out
               ? golden_refuse_link(path, act->fault)
               : err;
}

/* Read the recorded copy, or if it is missing, the file, which must be the same. */
static enum err read_recorded(struct volume *map, struct label_table *names, const struct act *act,
                              const char *recorded)
{
    const struct value *numbered = act_value(act, "numbers");
    struct buf *path = act_buf(act), *numbers = act_buf(act), *words = act_buf(act);
    char digest[LABEL_COPY_DIGEST];
    if (!scan_is_hex(recorded, LABEL_COPY_DIGEST - 1))
        return fault_set(act->fault, ERR_USAGE,
                         "copy: expected %d digits 0-9a-f, as a journal has them, not %s",
                         LABEL_COPY_DIGEST - 1, recorded);
    enum err err = find_copy(path, act, recorded);
    const bool has_copy = !err && path->length && file_exists(buf_text(path));
    if (!err)
        err = has_copy       ? read_copy(map, names, act, buf_text(path))
              : is_here(act) ? read_here(map, act)
                             : read_original(map, names, act, numbers);
    if (!err && has_copy && numbered->given)
        err = apply_numbers(act, numbered->text);
    if (err && !has_copy && path->length)
        fault_prefix(act->fault, err, "there is no copy %s", buf_text(path));
    TRY(err);
    write_names(words, names);
    TRY(label_copy_digest(digest, map, words, act->session->watch, act->fault));
    const bool same_numbers =
        has_copy || strcmp(buf_text(numbers), numbered->given ? numbered->text : "") == 0;
    return same_numbers && strcmp(digest, recorded) == 0
               ? OK
               : fault_set(act->fault, ERR_INPUT,
                           "%s holds labels other than recorded (%s, not %s); nothing was "
                           "planted",
                           has_copy ? buf_text(path) : act_text(act, "FILE"), digest, recorded);
}

/* Read the file; the record ends in copy=DIGEST. */
static enum err read_new(struct volume *map, struct label_table *names, const struct act *act,
                         char digest[LABEL_COPY_DIGEST])
{
    struct buf *numbers = act_buf(act), *words = act_buf(act);
    if (act_has(act, "numbers"))
        return fault_set(act->fault, ERR_USAGE,
                         "numbers: only in journals, with copy=DIGEST; regions= chooses regions");
    TRY(is_here(act) ? read_here(map, act) : read_original(map, names, act, numbers));
    write_names(words, names);
    TRY(label_copy_digest(digest, map, words, act->session->watch, act->fault));
    if (numbers->length)
        buf_printf(&act->reply->canonical, " numbers=%s", buf_text(numbers));
    buf_printf(&act->reply->canonical, " copy=%s", digest);
    return OK;
}

/* ---- markers ---- */

/* Report all labels in a line, then those with most pieces, which may be noise. */
static void write_pieces(const struct act *act, const struct piece_seeds *seeds, size_t planted)
{
    struct buf *out = &act->reply->text;
    const bool has_background = seeds->labels[0] > 0;
    uint32_t left[256];
    unsigned labels = 0;
    memcpy(left, seeds->labels, sizeof left);
    for (unsigned label = 0; label < 256; label++)
        labels += left[label] > 0;
    buf_add_safe_text(out, act_text(act, "FILE"));
    buf_printf(out, ": %u label%s%s, %zu marker%s, %zu seed%s\n", labels - has_background,
               plural(labels - has_background), has_background ? " and the background" : "",
               seeds->pieces, plural(seeds->pieces), planted, plural(planted));
    for (unsigned i = 0; i < labels && i < LISTED_MOST; i++) {
        unsigned label = 0; /* the lowest one of equals */
        for (unsigned other = 1; other < 256; other++)
            label = left[other] > left[label] ? other : label;
        buf_add_text(out, "label ");
        label_report_write_name(out, act->session, label);
        buf_printf(out, ": %u marker%s\n", left[label], plural(left[label]));
        left[label] = 0;
    }
    if (labels > LISTED_MOST)
        buf_printf(out,
                   "%u more label%s, of as many markers or fewer; after `run`, `stats` lists "
                   "all\n",
                   labels - LISTED_MOST, plural(labels - LISTED_MOST));
    if (seeds->left_out)
        buf_printf(out, "%zu piece%s of fewer voxels left to the trees around\n", seeds->left_out,
                   plural(seeds->left_out));
    if (seeds->small)
        buf_printf(out, "%zu piece%s too small for the erosion: the innermost voxels alone\n",
                   seeds->small, plural(seeds->small));
}

/* True for a seed of an older object in the background of regions that are not chosen. It is kept,
 * so that these regions do not overwrite regions chosen before. */
static bool keeps_seed(const struct act *act, const struct volume *map, uint32_t cell)
{
    const struct session *session = act->session;
    const uint32_t number = markers_at(&session->markers, cell);
    return number && number <= session->former_markers &&
           session->markers.marker[number - 1].label > 0 &&
           map->intensity[grid_voxel(&session->scene->grid, cell)] == REGION_NONE;
}

/* Add the voxels of a piece that have seeds of other labels, except for the first `own`, its own
 * seeds. */
static enum err add_overruled(struct voxels *out, const struct act *act, const struct piece *piece,
                              struct marker_run run, size_t own)
{
    const struct markers *markers = &act->session->markers;
    for (uint32_t c = run.first; c < run.end; c++) {
        const int16_t label = markers_seed(markers, c);
        if (label == EDIT_ERASE || label == piece->label ||
            bsearch(&c, out->cell, own, sizeof c, sort_compare_32))
            continue;
        if (!mem_grow(&out->cell, &out->capacity, out->count + 1, sizeof *out->cell))
            return fault_memory(act->fault, "seeds of pieces");
        out->cell[out->count++] = c;
    }
    return OK;
}

/* Find the voxels where a piece plants: all its own seeds, and, since it decides in all of it,
 * those with seeds of other labels. */
static enum err find_voxels(struct voxels *out, const struct act *act,
                            const struct piece_seeds *seeds, const struct volume *map, size_t i)
{
    const struct piece *piece = &seeds->piece[i];
    const size_t begin = i ? piece[-1].end : 0, first = i ? piece[-1].run_end : 0;
    const size_t own = piece->end - begin;
    struct task task = task_begin(act->session->watch, "seeds of pieces", 0);
    out->count = 0;
    if (!mem_grow(&out->cell, &out->capacity, own, sizeof *out->cell))
        return fault_memory(act->fault, "seeds of pieces");
    for (size_t k = begin; k < piece->end; k++)
        out->cell[out->count++] = seeds->cell[k];
    if (!act->session->former_markers)
        return OK;
    for (size_t r = first; r < piece->run_end && task_advance(&task, 1); r++)
        TRY(add_overruled(out, act, piece, seeds->run[r], own));
    size_t kept = 0;
    for (size_t k = 0; k < out->count && piece->label == 0; k++)
        if (!keeps_seed(act, map, out->cell[k]))
            out->cell[kept++] = out->cell[k];
    out->count = piece->label == 0 ? kept : out->count;
    return watch_fault(act->session->watch, act->fault);
}

static enum err plant_pieces(const struct act *act, const struct piece_seeds *seeds,
                             const struct volume *map)
{
    struct planting planting = act_begin_planting(act->session, NULL);
    OWNED(voxels_release) struct voxels voxels = {0};
    uint64_t digest = 0;
    planting.yields = true;
    for (size_t i = 0; i < seeds->pieces; i++) {
        const struct piece *piece = &seeds->piece[i];
        const size_t run = i ? piece[-1].run_end : 0;
        planting.run = seeds->run + run;
        planting.runs = piece->run_end - run;
        TRY(find_voxels(&voxels, act, seeds, map, i));
        for (size_t k = 0; k < voxels.count; k++)
            digest += hash_mix_at(voxels.cell[k], piece->label);
        TRY(act_plant(act, &planting, voxels.cell, voxels.count, piece->label));
    }
    act->next->lists = act->session->now.lists;
    for (unsigned label = 1; label < 256 && !is_here(act) && !act_has(act, "as|label"); label++)
        act->next->kept.label_is_region[label] |= seeds->labels[label] > 0;
    if (!kept_equals(&act->next->kept, &act->session->now.kept))
        TRY(act_go(act)); /* to the numbers of the labels */
    write_pieces(act, seeds, planting.planted);
    bool has[256];
    for (unsigned label = 0; label < 256; label++)
        has[label] = seeds->labels[label] > 0;
    if (!act_has(act, "label"))
        atlas_advise_names(act, has);
    act_add_digest(act, "file", digest);
    buf_printf(&act->reply->words, " added=%zu", planting.planted);
    act_add_markers(act);
    return act_prefix_file(act, act_write_planting(act, &planting));
}

static enum err refuse_empty(const struct act *act)
{
    return fault_set(act->fault, ERR_INPUT, "%s has no voxel of these regions; nothing was planted",
                     act_text(act, "FILE"));
}

/* Put the regions that are kept out of the region of interest, and out of the map. */
static enum err keep_rest(const struct act *act, struct volume *map)
{
    struct session *session = act->session;
    const struct roi *roi = &session->roi;
    const size_t voxels = voxels_in(map->size);
    OWNED(mem_release) uint64_t *mask = mem_new(mask_bytes(&session->scene->grid));
    OWNED(mem_release) uint16_t *rest = mem_array(voxels, sizeof *rest);
    size_t kept = 0, chosen = 0;
    if (!mask || !rest)
        return fault_memory(act->fault, "the regions that are kept");
    for (size_t i = 0; i < voxels; i++) {
        const uint16_t value = map->intensity[i];
        const bool is_kept = value >= KEPT_FROM && value != REGION_NONE;
        rest[i] = is_kept ? (uint16_t)(value - KEPT_FROM) : 0;
        map->intensity[i] = is_kept ? REGION_NONE : value;
        kept += is_kept;
        chosen += value > 0 && value < KEPT_FROM;
    }
    if (!chosen)
        return refuse_empty(act);
    const uint16_t *at = rest;
    for (struct grid_walk w = scene_walk(session->scene, "regions that are kept", NULL, 0);
         grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++)
            if (!*at++ && (!roi->mask || roi->mask[c >> 6] >> (c & 63) & 1))
                mask[c >> 6] |= UINT64_C(1) << (c & 63);
    TRY(session_set_mask(session, mask, act_text(act, "FILE"), (const uint32_t[]){0, 0}, rest,
                         act->fault));
    struct kept *next = &act->next->kept;
    const struct kept *now = &session->now.kept;
    next->mask = now->mask;
    next->rest = now->rest;
    memcpy(next->mask_file, now->mask_file, sizeof next->mask_file);
    memcpy(next->mask_regions, now->mask_regions, sizeof next->mask_regions);
    buf_printf(&act->reply->text,
               "%zu voxel%s of other regions %s outside the region of interest; `save labels` "
               "writes them back\n",
               kept, plural(kept), kept == 1 ? "is" : "are");
    return OK;
}

/* Warn before planting if most voxels would be seeds: the file is probably no segmentation. */
static void warn_of_noise(const struct act *act, const struct piece_seeds *seeds)
{
    const struct session *session = act->session;
    const size_t voxels = session->scene->grid.voxels;
    if (seeds->pieces < NOISE_PIECES || seeds->count < voxels / 2)
        return;
    watch_announce(session->watch,
                   "%s is more like noise, or a picture, than a segmentation: %zu pieces, of %.1f "
                   "voxels each; seeds in %zu voxels take some %.0f MB (Ctrl-C stops; `labels FILE "
                   "least=100` leaves out pieces of fewer voxels)",
                   file_name(act_text(act, "FILE")), seeds->pieces,
                   (double)voxels / (double)seeds->pieces, seeds->count,
                   (double)seeds->count * SEED_BYTES / 1e6);
}

static enum err plant_labels(const struct act *act)
{
    const struct session *session = act->session;
    const unsigned rounds = (unsigned)act_number(act, "erode");
    const struct piece_choice choice = {rounds, (uint32_t)act_number(act, "least"),
                                        act_number(act, "rest") >= REST_NONE ? REGION_NONE : 0};
    OWNED(volume_release) struct volume map = {0};
    OWNED(label_table_release) struct label_table names = {0};
    OWNED(piece_seeds_release) struct piece_seeds seeds = {0};
    if (!act_has(act, "erode"))
        buf_printf(&act->reply->canonical, " erode=%u", rounds);
    const char *copy = act_text(act, "copy");
    char digest[LABEL_COPY_DIGEST];
    TRY(copy ? read_recorded(&map, &names, act, copy) : read_new(&map, &names, act, digest));
    if (act->interp->mode == MODE_LIVE)
        TRY(keep_copy(act, &map, &names, copy ? copy : digest));
    if (keeps_rest(act))
        TRY(keep_rest(act, &map));
    const size_t voxels = voxels_in(map.size);
    size_t empty = 0;
    while (empty < voxels && map.intensity[empty] == REGION_NONE)
        empty++;
    if (empty == voxels)
        return refuse_empty(act);
    TRY(piece_seeds_make(&seeds, map.intensity, &session->scene->grid, &choice, session->watch,
                         act->fault));
    if (!seeds.pieces)
        return fault_set(act->fault, ERR_INPUT, "no piece of it has %u voxels; nothing was planted",
                         choice.least);
    warn_of_noise(act, &seeds);
    TRY(is_here(act) ? erase_seeds(act) : OK);
    apply_names(act, &names);
    return plant_pieces(act, &seeds, &map);
}

/* The record of `labels here` says whether the labels are finished. */
enum err act_labels(const struct act *act)
{
    struct call said = *act->call;
    struct act with = *act;
    if (keeps_rest(act) && (!act_has(act, "regions") || act->session->now.kept.rest))
        return fault_set(act->fault, ERR_USAGE, "rest=keep: %s; nothing was planted",
                         act->session->now.kept.rest
                             ? "regions are kept already; `undo` to before that command, and give "
                               "all regions to correct at once"
                             : "needs `regions`, as in regions=5; it keeps the others");
    if (!is_here(act) && act_has(act, "finished"))
        return fault_set(act->fault, ERR_USAGE,
                         "finished: only with `labels here`; nothing was planted");
    if (is_here(act) && act_has(act, "regions|as|label|rest|resample|volume|data|numbers"))
        return fault_set(act->fault, ERR_USAGE,
                         "here: only with finished, erode and least; nothing was planted");
    if (is_here(act) && !act_has(act, "finished")) {
        const bool finished = act->interp->has_pilot && session_shows_finished(act->session);
        call_set(&said, "finished", !finished, finished ? "yes" : "no");
        buf_clear(&act->reply->canonical);
        command_write(&act->reply->canonical, &said);
        with.call = &said;
    }
    /* the present labels may belong to the map */
    const bool runs = is_here(act) || act_is_yes(act, "resample");
    TRY(runs ? session_run(act->session, act->fault) : OK);
    return plant_labels(&with);
}
