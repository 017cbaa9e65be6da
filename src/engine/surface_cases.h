/*
 * How a surface passes through a cube of eight voxel centres: one case for each set of them that is
 * inside.
 *
 * Corner c of the cube has bit 0, 1, 2 where it is at the upper end of x, y, z. Edge 4 a + 2 v + u
 * runs along axis a, with u and v saying on which side it is along axes a + 1 and a + 2 (mod 3).
 *
 * On each face of the cube a segment cuts off every run of corners that are inside. So where two
 * corners at a diagonal are inside, they are cut off one by one, and the cube on the other side of
 * the face does the same: nothing stays open. Segments make closed polygons of 3 to 7 corners. Each
 * is a fan of triangles around a corner from which no diagonal lies in a face of the cube, and
 * there always is one: so no other cube has an edge between the same two nodes.
 *
 * After Lorensen and Cline, "Marching cubes" (1987), with the table made at run time from these
 * rules, as they are shorter than it.
 */
#ifndef ENGINE_SURFACE_CASES_H
#define ENGINE_SURFACE_CASES_H

#include <stdint.h>

struct surface_case {
    uint8_t triangles, segments;
    uint8_t triangle[5][3]; /* edges of the cube, counter-clockwise seen from outside the label */
    uint8_t segment[6]
                   [2]; /* on the three faces at the lower ends: each segment once in all cubes */
};

/* cases[set of corners inside, corner 0 in the lowest bit] */
void surface_cases_init(struct surface_case cases[256]);

/* The corner at the lower end of an edge; the upper one is 1 << (edge / 4) further. */
unsigned surface_edge_corner(unsigned edge);

#endif
