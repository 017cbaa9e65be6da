#include "engine/surface_cases.h"

#include <stdbool.h>

enum { FACES = 6, EDGES = 12, NONE = 255 };

/* Face 2 a + 1 is at the upper end of axis a, face 2 a at the lower one: its corners and edges
 * counter-clockwise as seen from outside; edge i leads from corner i to the next one. */
struct face {
    uint8_t corner[4], edge[4];
};

unsigned surface_edge_corner(unsigned edge)
{
    const unsigned u = (edge / 4 + 1) % 3, v = (edge / 4 + 2) % 3;
    return (edge & 1) << u | (edge >> 1 & 1) << v;
}

static uint8_t edge_between(unsigned corner, unsigned other)
{
    const unsigned axis = (corner ^ other) / 2; /* 1, 2, 4: 0, 1, 2 */
    const unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
    return (uint8_t)(4 * axis + 2 * (corner >> v & 1) + (corner >> u & 1));
}

static struct face face_of(unsigned number)
{
    const unsigned axis = number / 2, upper = number & 1;
    const unsigned u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3;
    const unsigned round[4] = {0, u, u | v, v};
    struct face face;
    for (unsigned i = 0; i < 4; i++)
        face.corner[i] = (uint8_t)(round[upper ? i : 3 - i] | upper << axis);
    for (unsigned i = 0; i < 4; i++)
        face.edge[i] = edge_between(face.corner[i], face.corner[(i + 1) % 4]);
    return face;
}

static bool share_face(unsigned edge, unsigned other)
{
    for (unsigned f = 0; f < FACES; f++) {
        const struct face face = face_of(f);
        unsigned found = 0;
        for (unsigned i = 0; i < 4; i++)
            found += face.edge[i] == edge || face.edge[i] == other;
        if (found == 2)
            return true;
    }
    return false;
}

/* The segments of a face: next[] leads from the edge where the inside ends to where it began, so
 * that polygons run clockwise as seen from outside the label. */
static void cut_corners(struct surface_case *out, uint8_t next[EDGES], unsigned set, unsigned f)
{
    const struct face face = face_of(f);
    for (unsigned i = 0; i < 4; i++) {
        unsigned first = i; /* of the run of corners inside that ends with corner i */
        if (!(set >> face.corner[i] & 1) || set >> face.corner[(i + 1) % 4] & 1)
            continue;
        while (set >> face.corner[(first + 3) % 4] & 1)
            first = (first + 3) % 4;
        const uint8_t from = face.edge[i], to = face.edge[(first + 3) % 4];
        next[from] = to;
        if (f % 2 == 0) {
            out->segment[out->segments][0] = from;
            out->segment[out->segments++][1] = to;
        }
    }
}

/* The corner of the polygon that can be the middle of the fan. */
static unsigned fan_corner(const uint8_t *polygon, unsigned count)
{
    unsigned middle = 0;
    for (bool fits = false; !fits; middle += !fits) {
        fits = true;
        for (unsigned i = 2; i + 1 < count && fits; i++)
            fits = !share_face(polygon[middle], polygon[(middle + i) % count]);
    }
    return middle;
}

static void add_polygon(struct surface_case *out, const uint8_t *polygon, unsigned count)
{
    const unsigned middle = fan_corner(polygon, count);
    for (unsigned i = 1; i + 1 < count; i++) {
        uint8_t *triangle = out->triangle[out->triangles++];
        triangle[0] = polygon[middle];
        triangle[1] = polygon[(middle + i + 1) % count];
        triangle[2] = polygon[(middle + i) % count];
    }
}

static void make_case(struct surface_case *out, unsigned set)
{
    uint8_t next[EDGES], polygon[EDGES];
    *out = (struct surface_case){0};
    for (unsigned e = 0; e < EDGES; e++)
        next[e] = NONE;
    for (unsigned f = 0; f < FACES; f++)
        cut_corners(out, next, set, f);
    for (unsigned e = 0; e < EDGES; e++) {
        unsigned count = 0;
        for (uint8_t at = (uint8_t)e; next[at] != NONE;) {
            const uint8_t to = next[at];
            next[at] = NONE;
            polygon[count++] = at;
            at = to;
        }
        if (count)
            add_polygon(out, polygon, count);
    }
}

void surface_cases_init(struct surface_case cases[256])
{
    for (unsigned set = 0; set < 256; set++)
        make_case(&cases[set], set);
}
