/*
 * Markers through whole sessions: overlaps, erasers, undo, redo, looking back, branches, restarts.
 *
 * The model knows nothing of how the program does it. It has a list of all that was ever put up,
 * each with its voxels and label; a state is the numbers of those that stand, one for each record.
 * The seeds of a state are what carrying those out, in order, gives. From the program it takes the
 * record that it went to (at=), and which seed's tree holds a voxel.
 */
#include "tests/small_scene.h"

enum { CELLS = 14 * 13 * 12, PUT_MOST = 400, RECORDS_MOST = 600, COMMANDS = 10 };

static struct put {
    int16_t label; /* or EDIT_ERASE */
    bool covers[CELLS];
} put[PUT_MOST];
static size_t put_count;

struct standing {
    bool has[PUT_MOST];
};
static struct standing state_after[RECORDS_MOST];

static struct interpreter interp;
static uint64_t seed = 2006;

static uint32_t below(uint32_t bound)
{
    return check_below(&seed, bound);
}

/* ---- the model ---- */

static void seeds_of(const struct standing *state, int16_t label[CELLS], uint32_t owner[CELLS])
{
    for (size_t c = 0; c < CELLS; c++) {
        label[c] = EDIT_ERASE;
        owner[c] = PUT_MOST;
    }
    for (uint32_t i = 0; i < put_count; i++)
        for (size_t c = 0; state->has[i] && c < CELLS; c++)
            if (put[i].covers[c]) {
                label[c] = put[i].label;
                owner[c] = i;
            }
}

static void planted_as(const struct standing *state, const char *when)
{
    int16_t label[CELLS];
    uint32_t owner[CELLS];
    bool same = true;
    seeds_of(state, label, owner);
    for (uint32_t c = 0; c < CELLS; c++) {
        const struct cell *cell = interp.session.scene->cell + c;
        same &= label[c] == (cell->flags & CELL_SEED ? cell->label : EDIT_ERASE);
    }
    if (!CHECK(same))
        printf("#   after %s\n", when);
}

static uint32_t cell_at(uint32_t x, uint32_t y, uint32_t z)
{
    return grid_cell(&interp.session.scene->grid, x, y, z);
}

static void put_up(int16_t label, struct standing *state)
{
    put[put_count].label = label;
    memset(put[put_count].covers, 0, sizeof put[put_count].covers);
    state->has[put_count++] = true;
}

/* A ball, by the sum of squares, as help says. */
static void plant(struct standing *state, const uint32_t at[3], int radius, int16_t label)
{
    put_up(label, state);
    for (int z = -radius; z <= radius; z++)
        for (int y = -radius; y <= radius; y++)
            for (int x = -radius; x <= radius; x++)
                if (x * x + y * y + z * z <= radius * radius &&
                    grid_contains(&interp.session.scene->grid, (int)at[0] + x, (int)at[1] + y,
                                  (int)at[2] + z))
                    put[put_count - 1].covers[cell_at(at[0] + (uint32_t)x, at[1] + (uint32_t)y,
                                                      at[2] + (uint32_t)z)] = true;
}

/* Which seed's tree holds a voxel, by the program; the rest by the model. */
static void take_away(struct standing *state, uint32_t cell, bool tree)
{
    int16_t label[CELLS];
    uint32_t owner[CELLS];
    const uint32_t root = key_root(interp.session.scene->cell[cell].key);
    seeds_of(state, label, owner);
    if (tree) {
        put_up(EDIT_ERASE, state);
        put[put_count - 1].covers[root] = true;
    } else {
        state->has[owner[root]] = false;
    }
}

/* ---- sessions ---- */

static struct standing now;

static void do_one(char line[80])
{
    const uint32_t at[3] = {below(size[0]), below(size[1]), below(size[2])};
    const uint32_t cell = cell_at(at[0], at[1], at[2]);
    struct record_word word;
    const unsigned what = below(10);
    struct standing next = now;
    if (what < 5) {
        const int radius = (int)below(4);
        const unsigned label = below(4);
        snprintf(line, 80, "seed %u,%u,%u %u radius=%d", at[0], at[1], at[2], label, radius);
        plant(&next, at, radius, (int16_t)label);
    } else if (what < 8) {
        if (!cell_is_reached(interp.session.scene->cell + cell))
            return;
        const bool tree = what == 7;
        snprintf(line, 80, "remove %u,%u,%u%s", at[0], at[1], at[2], tree ? " of=tree" : "");
        take_away(&next, cell, tree);
    } else {
        const char *const ways[] = {"undo", "undo 3", "redo", "redo 2", "goto main", "goto"};
        const char *way = ways[below(6)];
        snprintf(line, 80, "%s", way);
        if (strcmp(way, "goto") == 0)
            snprintf(line, 80, "goto %u", 5 + below((uint32_t)interp.history.records - 4));
    }
    const enum err err = execute(&interp, line);
    if (err && what >= 8)
        return; /* nothing to undo or to do again */
    if (!CHECK(err == OK))
        printf("#   %s: %s\n", line, fault.text);
    if (record_word_find(buf_text(&reply.words), "at", 2, &word))
        now = state_after[strtoul(word.value, NULL, 10)];
    else
        now = next;
    state_after[interp.history.records] = now;
}

static void begin(const char *journal)
{
    char line[PATH_MAX + 8];
    begin_interpreter(&interp);
    unlink(journal);
    interp.sync = FILE_SYNC_OFF;
    CHECK(interpreter_create_journal(&interp, journal, NULL) == OK);
    snprintf(line, sizeof line, "open %s", place("scene.nii"));
    must(&interp, line);
    must(&interp, "auto on");
    must(&interp, "size 16 16");
    must(&interp, "label 1 one");
    must(&interp, "label 2 two");
    put_count = 0;
    now = (struct standing){{0}};
    for (size_t i = 0; i <= interp.history.records; i++)
        state_after[i] = now;
}

/* Whoever resumes the journal has the same seeds, and goes to the same states. */
static void restart(const char *journal)
{
    char line[80];
    interpreter_release(&interp);
    begin_interpreter(&interp);
    if (!CHECK(interpreter_resume_journal(&interp, journal, NULL, &fault) == OK))
        printf("#   %s\n", fault.text);
    planted_as(&now, "a restart");
    for (int i = 0; i < 3; i++)
        do_one(line);
    planted_as(&now, line);
}

STORY(seeds_are_what_the_commands_that_stand_give)
{
    const char *factor = getenv("IFTTY_TEST_SCALE");
    const int rounds = 25 * (factor ? atoi(factor) : 1);
    char journal[PATH_MAX], line[80] = "";
    snprintf(journal, sizeof journal, "%s", place("markers.iftty"));
    for (int i = 0; i < rounds && check_failures < 5; i++) { /* each of 40 sessions */
        begin(journal);
        for (int k = 0; k < 40 && check_failures < 5; k++) {
            must(&interp, "goto 5"); /* with no seed */
            now = state_after[5];
            state_after[interp.history.records] = now;
            for (int n = 0; n < COMMANDS && put_count < PUT_MOST - 2; n++) {
                do_one(line);
                planted_as(&now, line);
            }
            if (put_count >= PUT_MOST - 2)
                break;
        }
        CHECK(forest_check(interp.session.forest, NULL));
        restart(journal);
        interpreter_release(&interp);
    }
}

int main(void)
{
    if (!make_folder(folder, "markers"))
        return 1;
    make_scene();
    const int status = RUN_STORIES(TELL(seeds_are_what_the_commands_that_stand_give));
    reply_release(&reply);
    return remove_folder(folder) | status;
}
