/* SPDX-License-Identifier: MIT */
/* The finish: each step is compared with a plain model written from the description in
 * engine/finish.h. The model shares no code with the engine: it loops over all voxels, fills, and
 * tests every ball. */
#include "engine/labels.h"
#include "tests/finish_fails.h"

enum { SIDE = 9, VOXELS = SIDE * SIDE * SIDE };

/* ---- the model: a volume of at most SIDE voxels a side ---- */

struct volume {
    int size[3];
    uint32_t nm[3];
    uint8_t at[SIDE][SIDE][SIDE]; /* [z][y][x] */
};

static bool is_in(const struct volume *v, int x, int y, int z)
{
    return x >= 0 && y >= 0 && z >= 0 && x < v->size[0] && y < v->size[1] && z < v->size[2];
}

#define EACH_VOXEL(v, x, y, z)                                                                     \
    for (int z = 0; z < (v)->size[2]; z++)                                                         \
        for (int y = 0; y < (v)->size[1]; y++)                                                     \
            for (int x = 0; x < (v)->size[0]; x++)

static bool is_for(const struct finish_step *step, int label)
{
    return step->label == FINISH_ALL_LABELS || (int)step->label == label;
}

static const int side_of[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                  {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};

static void model_majority(struct volume *v, const struct finish_step *step)
{
    const struct volume before = *v;
    int reach[3];
    for (int a = 0; a < 3; a++)
        reach[a] = (int)(step->in_nm ? step->argument / v->nm[a] : step->argument);
    EACH_VOXEL(&before, x, y, z)
    {
        int count[256] = {0}, best = before.at[z][y][x];
        EACH_VOXEL(&before, i, j, k)
        if (abs(i - x) <= reach[0] && abs(j - y) <= reach[1] && abs(k - z) <= reach[2])
            count[before.at[k][j][i]]++;
        for (int label = 255; label >= 0; label--)
            if (count[label] > count[best] ||
                (count[label] == count[best] && best != before.at[z][y][x]))
                best = label;
        if (is_for(step, best) || is_for(step, before.at[z][y][x]))
            v->at[z][y][x] = (uint8_t)best;
    }
}

/* The pieces of a volume: piece[z][y][x] counts from 1 in the order of first voxels. */
struct pieces {
    int of[SIDE][SIDE][SIDE];
    int count, voxels[VOXELS + 1];
    uint8_t label[VOXELS + 1];
    bool at_edge[VOXELS + 1];
};

static void flood(const struct volume *v, struct pieces *p, int x, int y, int z)
{
    p->of[z][y][x] = p->count;
    p->voxels[p->count]++;
    for (int f = 0; f < 6; f++) {
        const int i = x + side_of[f][0], j = y + side_of[f][1], k = z + side_of[f][2];
        if (!is_in(v, i, j, k))
            p->at_edge[p->count] = true;
        else if (v->at[k][j][i] == v->at[z][y][x] && !p->of[k][j][i])
            flood(v, p, i, j, k);
    }
}

static void find_pieces(const struct volume *v, struct pieces *p)
{
    memset(p, 0, sizeof *p);
    EACH_VOXEL(v, x, y, z)
    if (!p->of[z][y][x]) {
        p->label[++p->count] = v->at[z][y][x];
        flood(v, p, x, y, z);
    }
}

static void model_give_away(struct volume *v, const struct pieces *p, bool *waits, int taker)
{
    for (bool any = true; any;) {
        static int faces[VOXELS + 1][256];
        const struct volume before = *v;
        bool gone[VOXELS + 1] = {false};
        any = false;
        memset(faces, 0, sizeof faces);
        EACH_VOXEL(v, x, y, z)
        for (int f = 0; f < 6 && waits[p->of[z][y][x]]; f++) {
            const int i = x + side_of[f][0], j = y + side_of[f][1], k = z + side_of[f][2];
            if (is_in(v, i, j, k) && !waits[p->of[k][j][i]] &&
                before.at[k][j][i] != p->label[p->of[z][y][x]])
                faces[p->of[z][y][x]][before.at[k][j][i]]++;
        }
        for (int n = 1; n <= p->count; n++) {
            int best = 0;
            for (int label = 1; label < 256; label++)
                best = faces[n][label] > faces[n][best] ? label : best;
            if (!waits[n] || !faces[n][best])
                continue;
            gone[n] = any = true;
            EACH_VOXEL(v, x, y, z)
            if (p->of[z][y][x] == n && (taker == FINISH_ALL_LABELS || taker == best))
                v->at[z][y][x] = (uint8_t)best;
        }
        for (int n = 1; n <= p->count; n++)
            waits[n] = waits[n] && !gone[n];
    }
}

static void model_pieces(struct volume *v, const struct finish_step *step)
{
    static struct pieces p;
    bool waits[VOXELS + 1] = {false};
    find_pieces(v, &p);
    for (int n = 1; n <= p.count; n++) {
        bool is_largest = true;
        for (int m = 1; m <= p.count; m++)
            if (p.label[m] == p.label[n] &&
                (p.voxels[m] > p.voxels[n] || (p.voxels[m] == p.voxels[n] && m < n)))
                is_largest = false;
        if (step->kind == FINISH_HOLES)
            waits[n] = p.label[n] == 0 && !p.at_edge[n];
        else
            waits[n] =
                p.label[n] != 0 && is_for(step, p.label[n]) &&
                (step->kind == FINISH_LARGEST ? !is_largest : p.voxels[n] < (int)step->argument);
    }
    model_give_away(v, &p, waits,
                    step->kind == FINISH_HOLES ? (int)step->label : FINISH_ALL_LABELS);
}

/* Whether a voxel lies in the ball around another voxel. */
static bool in_ball(const struct volume *v, const struct finish_step *step, const int a[3],
                    const int b[3])
{
    int64_t sum = 0;
    for (int i = 0; i < 3; i++) {
        const int64_t way = (int64_t)(a[i] - b[i]) * (step->in_nm ? v->nm[i] : 1);
        sum += way * way;
    }
    return sum <= (int64_t)step->argument * step->argument;
}

/* Whether some ball that contains the voxel has only voxels of the label (`all`), or none. */
static bool some_ball(const struct volume *v, const struct finish_step *step, const int at[3],
                      int label, bool all)
{
    EACH_VOXEL(v, x, y, z)
    {
        bool fits = in_ball(v, step, at, (int[3]){x, y, z});
        EACH_VOXEL(v, i, j, k)
        if (fits && (v->at[k][j][i] == label) != all &&
            in_ball(v, step, (int[3]){i, j, k}, (int[3]){x, y, z}))
            fits = false;
        if (fits)
            return true;
    }
    return false;
}

static void model_open(struct volume *v, const struct finish_step *step)
{
    static struct pieces p;
    struct volume lost = *v;
    bool waits[VOXELS + 1] = {false};
    EACH_VOXEL(v, x, y, z)
    {
        const int label = v->at[z][y][x];
        lost.at[z][y][x] =
            label && is_for(step, label) && !some_ball(v, step, (int[3]){x, y, z}, label, true)
                ? (uint8_t)label
                : 0;
    }
    find_pieces(&lost, &p);
    for (int n = 1; n <= p.count; n++)
        waits[n] = p.label[n] != 0;
    model_give_away(v, &p, waits, FINISH_ALL_LABELS);
}

static void model_close(struct volume *v, const struct finish_step *step)
{
    const struct volume before = *v;
    EACH_VOXEL(v, x, y, z)
    for (int label = 1; label < 256 && before.at[z][y][x] == 0 && v->at[z][y][x] == 0; label++)
        if (label < 6 && is_for(step, label) &&
            !some_ball(&before, step, (int[3]){x, y, z}, label, false))
            v->at[z][y][x] = (uint8_t)label;
}

/* FINISH_RELAX has its model in test_relax. */
static void (*const model_of[FINISH_KIND_COUNT])(struct volume *, const struct finish_step *) = {
    [FINISH_MAJORITY] = model_majority, [FINISH_LARGEST] = model_pieces,
    [FINISH_COMPONENTS] = model_pieces, [FINISH_HOLES] = model_pieces,
    [FINISH_OPEN] = model_open,         [FINISH_CLOSE] = model_close,
};

static void model(struct volume *v, const struct finish_list *list)
{
    for (uint32_t i = 0; i < list->count; i++)
        if (model_of[list->step[i].kind])
            model_of[list->step[i].kind](v, &list->step[i]);
}

/* ---- random scenes ---- */

static uint64_t state;
static int below(int end)
{
    return (int)(check_random(&state) % (uint64_t)end);
}

/* Boxes of labels 0..5 over each other, with some noise; labels beyond 5 are not used. */
static void fill(struct volume *v, int most)
{
    const int labels = 2 + below(4), noise = below(3) ? below(30) : 0;
    for (int a = 0; a < 3; a++) {
        v->size[a] = 1 + below(most);
        v->nm[a] = 500000u + 250000u * (uint32_t)below(8);
    }
    memset(v->at, below(2) ? 1 : 0, sizeof v->at);
    for (int box = below(8); box > 0; box--) {
        int first[3], last[3];
        const int label = below(labels);
        for (int a = 0; a < 3; a++) {
            first[a] = below(v->size[a]);
            last[a] = first[a] + below(5);
        }
        EACH_VOXEL(v, x, y, z)
        if (x >= first[0] && x <= last[0] && y >= first[1] && y <= last[1] && z >= first[2] &&
            z <= last[2])
            v->at[z][y][x] = (uint8_t)label;
    }
    EACH_VOXEL(v, x, y, z)
    if (below(100) < noise)
        v->at[z][y][x] = (uint8_t)below(labels);
}

/* All but FINISH_RELAX, which test_relax is about. */
enum { FIRST_KIND = FINISH_RELAX + 1 };

static struct finish_step random_step(const struct volume *v)
{
    struct finish_step step = {.kind =
                                   (uint32_t)(FIRST_KIND + below(FINISH_KIND_COUNT - FIRST_KIND)),
                               .label = below(3) ? FINISH_ALL_LABELS : (uint32_t)(1 + below(5))};
    if (finish_table[step.kind].takes == FINISH_TAKES_RADIUS)
        step.argument = (uint32_t)(1 + below(3));
    if (step.argument && below(3) == 0) {
        step.in_nm = 1;
        step.argument = (uint32_t)below(3 * (int)v->nm[0]);
    }
    if (finish_table[step.kind].takes == FINISH_TAKES_VOXELS)
        step.argument = (uint32_t)(1 + below(40));
    return step;
}

static struct scene *scene_of(const struct volume *v)
{
    struct scene *scene;
    const uint32_t size[3] = {(uint32_t)v->size[0], (uint32_t)v->size[1], (uint32_t)v->size[2]};
    if (scene_new(&scene, size, NULL, NULL, NULL) != OK)
        abort();
    memcpy(scene->spacing_nm, v->nm, sizeof scene->spacing_nm);
    EACH_VOXEL(v, x, y, z)
    scene->cell[grid_cell(&scene->grid, (uint32_t)x, (uint32_t)y, (uint32_t)z)].label =
        v->at[z][y][x];
    return scene;
}

/* Whether both have the same labels everywhere, and the rim has no label. */
static bool agree(const void *expected, const struct scene *scene, const uint8_t *label)
{
    const struct volume *v = expected;
    uint64_t rim = 0, inside = 0;
    bool same = true;
    for (size_t c = 0; c < scene->grid.cells; c++)
        rim += label[c];
    EACH_VOXEL(v, x, y, z)
    {
        const uint8_t at = label[grid_cell(&scene->grid, (uint32_t)x, (uint32_t)y, (uint32_t)z)];
        inside += at;
        same = same && at == v->at[z][y][x];
    }
    return same && rim == inside;
}

/* ---- stories ---- */

static bool finish_as_model(const struct volume *v, const struct finish_list *list,
                            struct team *team)
{
    struct scene *scene = scene_of(v);
    struct volume expected = *v;
    uint8_t *label;
    bool fine = CHECK(finish_make(&label, list, scene, team, NULL, NULL) == OK);
    model(&expected, list);
    fine = fine && agree(&expected, scene, label);
    mem_pages_free(label, scene->grid.cells);
    scene_free(scene);
    return fine;
}

STORY(every_step_of_the_table_has_a_plain_model)
{
    for (int kind = 0; kind < FINISH_KIND_COUNT; kind++)
        CHECK_WITH(model_of[kind] || kind == FINISH_RELAX, "%s has none", finish_table[kind].name);
}

STORY(each_step_is_what_a_plain_model_makes)
{
    for (int round = 0; round < 6000; round++) {
        static struct volume v;
        struct finish_list list = {.count = 1};
        state = (uint64_t)round;
        fill(&v, 7);
        list.step[0] = random_step(&v);
        if (!CHECK(finish_as_model(&v, &list, team_of[round % 4]))) {
            OWNED(buf_release) struct buf words = {0};
            uint32_t number[256];
            for (uint32_t l = 0; l < 256; l++)
                number[l] = l;
            finish_write(&words, &list, number);
            printf("# round %d: %dx%dx%d, %s\n", round, v.size[0], v.size[1], v.size[2],
                   buf_text(&words));
        }
    }
}

STORY(steps_follow_each_other_in_their_order)
{
    for (int round = 0; round < 1500; round++) {
        static struct volume v;
        struct finish_list list = {.count = 0};
        state = (uint64_t)(round + 100000);
        fill(&v, SIDE - 1);
        for (int steps = below(5); steps > 0; steps--)
            list.step[list.count++] = random_step(&v);
        CHECK_WITH(finish_as_model(&v, &list, team_of[round % 4]), "round %d", round);
    }
}

/* All of these steps, one after the other. */
static struct finish_list all_steps(void)
{
    struct finish_list list = {.count = FINISH_KIND_COUNT - FIRST_KIND};
    for (uint32_t kind = FIRST_KIND; kind < FINISH_KIND_COUNT; kind++)
        list.step[kind - FIRST_KIND] = (struct finish_step){kind, FINISH_ALL_LABELS, 1, 0, 0};
    return list;
}

STORY(a_stop_is_heard_wherever_it_comes_and_memory_that_runs_out_is_an_error)
{
    static struct volume v;
    const struct finish_list list = all_steps();
    for (int starves = 0; starves < 2; starves++) {
        state = starves ? 8 : 7;
        fill(&v, 7);
        OWNED(scene_drop) struct scene *scene = scene_of(&v);
        model(&v, &list);
        CHECK(starves ? starve_finish_everywhere(scene, &list, agree, &v) > 10
                      : stop_finish_everywhere(scene, &list, agree, &v) > 50);
    }
}
