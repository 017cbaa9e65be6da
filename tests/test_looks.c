/* The bits of every look, as they were when it was new: journals are records, whose pictures no
 * change of the program may change. That all ways to a picture agree says nothing of that. */
#include "check.h"

#include "tests/stage.h"

enum { SIDE = 160, MIDDLES = 50, LABELS = 9 };

/* Each voxel is that object's whose middle is nearest: most touch each other. */
static uint8_t nearest_of(int64_t middle[MIDDLES][3], const uint32_t at[3])
{
    int64_t least = INT64_MAX;
    int nearest = 0;
    for (int i = 0; i < MIDDLES; i++) {
        int64_t square = 0;
        for (int a = 0; a < 3; a++)
            square += (at[a] - middle[i][a]) * (at[a] - middle[i][a]);
        nearest = square < least ? i : nearest;
        least = square < least ? square : least;
    }
    return (uint8_t)(nearest % LABELS);
}

/* Objects with holes, and single voxels in them. */
static void set_up(struct stage *s)
{
    uint64_t random = 2006;
    int64_t middle[MIDDLES][3];
    CHECK(stage_init(s, (uint32_t[]){40, 36, 30}, 6, NULL) == OK);
    for (int i = 0; i < 3 * MIDDLES; i++)
        middle[i / 3][i % 3] = check_below(&random, 46) - 4;
    const struct grid *grid = &s->scene->grid;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++) {
                struct cell *cell = s->scene->cell + grid_cell(grid, x, y, z);
                cell->intensity = (uint16_t)(x * 7 + y * 5 + z * 3 + check_below(&random, 40));
                cell->label = check_below(&random, 60) ? nearest_of(middle, (uint32_t[]){x, y, z})
                                                       : (uint8_t)check_below(&random, LABELS);
            }
    s->view.width = s->view.height = SIDE;
    s->shader.window[0] = 100, s->shader.window[1] = 500;
}

/* How it is looked at. */
static const struct way {
    const char *name;
    uint32_t zoom, samples, edges, creases, ao_percent;
    enum shade_mode mode;
    bool translucent, cut;
    int turns;
} ways[] = {
    {"surface", 1300, 1, 0, 0, 0, SHADE_SURFACE, false, false, 3},
    {"large", 4700, 1, 0, 0, 0, SHADE_SURFACE, false, false, 3},
    {"samples", 4100, 4, 0, 0, 0, SHADE_SURFACE, false, false, 3},
    {"cut", 3300, 1, 0, 0, 0, SHADE_SURFACE, false, true, 3},
    {"large, cut", 9000, 1, 0, 0, 0, SHADE_SURFACE, false, true, 3},
    {"cubes", 2700, 2, 0, 0, 0, SHADE_CUBES, false, false, 3},
    {"scene", 1900, 1, 1, 0, 0, SHADE_SCENE, false, false, 3},
    {"depth", 2100, 1, 0, 0, 0, SHADE_DEPTH, false, false, 3},
    {"creases", 4400, 2, 0, 1, 60, SHADE_SURFACE, false, false, 3},
    {"edges", 4400, 2, 1, 0, 0, SHADE_SURFACE, false, false, 3},
    {"translucent", 1300, 1, 0, 0, 0, SHADE_SURFACE, true, false, 3},
    {"large, translucent", 5000, 1, 0, 0, 0, SHADE_SURFACE, true, false, 16},
    {"translucent, samples", 2000, 4, 0, 0, 0, SHADE_SURFACE, true, false, 3},
    {"large, translucent, cut", 6100, 1, 0, 0, 0, SHADE_SURFACE, true, true, 3},
};
enum { WAYS = sizeof ways / sizeof *ways };

/* By the number of the look. A new look has a row of its own; none is ever changed. */
static const uint64_t record[LOOK_PRESENT][WAYS] = {
    {0xc73b1249778b3e69, 0xd345038187239126, 0x38221228ef613456, 0x4f006f8244c9ada4,
     0xb157736ca278b501, 0xb0884b0fccd9bbe5, 0xdcea423b8589840a, 0x679b2f61be67615c,
     0x07db6e2633cfb29a, 0xaef48635046b0c4e, 0x70651857a0fd4a46, 0x25576a0d873b42c7,
     0x977a85cac8fe5db1, 0x62134c98a469e1fa},
    {0x186da3601ce3e988, 0xd949c262a0bb61e6, 0xb60ceaf36ff27d7b, 0x90401a5d00e1d412,
     0xe270ba68eba71046, 0xccaab973c7241f5e, 0xfc6e322c867618c8, 0x9b7db884eb196ccb,
     0x957d5e2f868a1d32, 0x509c45b04d04b8ff, 0x6ff3034c4bd118e1, 0xaa0399ad636382dd,
     0xe0bc41132e7272f4, 0x5877331d43134e5c},
    {0x41d6f1aa02cfe2ba, 0x34e513c2bde4cf68, 0x375e9fa45389f6a6, 0x9efdea17e0c6ac31,
     0x9cf4e5e7297e9584, 0xccaab973c7241f5e, 0xfc6e322c867618c8, 0x9b7db884eb196ccb,
     0x1ad9127fc3004b0b, 0xed87b29f80f74188, 0x6ff3034c4bd118e1, 0xaa0399ad636382dd,
     0xe0bc41132e7272f4, 0x5877331d43134e5c},
    {0x41d6f1aa02cfe2ba, 0x4e058fee7014d598, 0x2d18c13deac84c60, 0x9efdea17e0c6ac31,
     0xfabcc28e9e8fa1e5, 0xccaab973c7241f5e, 0xfc6e322c867618c8, 0x9b7db884eb196ccb,
     0xfb251b0cb9796c76, 0xed87b29f80f74188, 0x6ff3034c4bd118e1, 0x937be253d24ff15f,
     0xe0bc41132e7272f4, 0x1c9e95711253998f},
};

static void look(struct stage *s, uint32_t number, const struct way *way)
{
    s->look = look_default(number);
    palette_default(&s->palette, number);
    s->look.samples = way->samples;
    s->look.edges = way->edges;
    s->look.creases = way->creases;
    s->look.ao_percent = way->ao_percent;
    s->look.mode = way->mode;
    s->view.zoom = way->zoom;
    for (int label = 1; label < LABELS; label++)
        s->border.opacity[label] = (uint8_t)(way->translucent && label % 4 ? label * 9 : 100);
    s->border.cut = cut_none();
    if (way->cut)
        s->border.cut.box[s->border.cut.boxes++] = (struct cut_box){{0, 0, 0}, {22, 18, 17}};
    border_recount(&s->border);
}

/* A sum of the digests of pictures from some sides. */
static uint64_t digest_of(struct stage *s, int turns)
{
    uint64_t digest = 0;
    for (int turn = 0; turn < turns; turn++) {
        for (int a = 0; a < 3; a++)
            s->view.angle[a] = turn * (31000 + 17000 * a) % VIEW_TURN;
        rendition_release(&s->rendition);
        stage_draw(s);
        digest += rendition_digest(&s->rendition);
    }
    return digest;
}

STORY(each_look_has_the_bits_that_it_was_born_with)
{
    struct stage s;
    set_up(&s);
    for (uint32_t number = LOOK_FIRST; number <= LOOK_PRESENT; number++)
        for (int i = 0; i < WAYS; i++) {
            look(&s, number, &ways[i]);
            const uint64_t digest = digest_of(&s, ways[i].turns);
            if (!CHECK(digest == record[number - LOOK_FIRST][i]))
                printf("# look %u, %s: 0x%016llx\n", number, ways[i].name,
                       (unsigned long long)digest);
        }
    stage_release(&s);
}

int main(void)
{
    return RUN_STORIES(TELL(each_look_has_the_bits_that_it_was_born_with));
}
