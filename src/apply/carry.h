/* SPDX-License-Identifier: MIT */
/*
 * Carrying over: how a place of a subject's scene is found in the procedure's.
 *
 *     world      both have the same millimetres
 *     landmarks  those of the same names, by least squares
 *     affine     by the intensities of both (apply/registration.h)
 *     file       a transform that another program has found (apply/registration.h)
 *
 * Nothing is guessed: a scene of which nobody says where it lies is refused; landmarks need no
 * place, but sides and millimetres.
 */
#ifndef APPLY_CARRY_H
#define APPLY_CARRY_H

#include "apply/procedure.h"
#include "session/session.h"

enum carry_way { CARRY_WORLD, CARRY_LANDMARKS, CARRY_AFFINE, CARRY_FILE }; /* as ORIGIN_WAYS */

#define CARRY_FITS "rigid|similarity|affine" /* enum affine_kind */

struct carry_choice {
    enum carry_way way;
    const char *file; /* of CARRY_FILE */
    enum affine_kind kind;
    const struct procedure_landmark *landmark; /* the subject's */
    size_t landmarks;
    const uint16_t *intensity; /* of the procedure's scene, [z][y][x]; NULL where it is not known */
};

struct carry {
    struct affine pull; /* subject's world -> procedure's world */
    size_t pairs;       /* of landmarks, */
    double rms_mm;      /* and what they are off by */
    struct buf words;   /* what there is to say of it; no line feed */
};

/* `carry` is to be released by buf_release(&carry->words), whatever is returned. ERR_INPUT in words
 * that say what to do, ERR_CHECK for a registration that is not to be used. */
enum err carry_find(struct carry *carry, const struct carry_choice *choice,
                    const struct procedure *procedure, const struct session *subject,
                    struct fault *fault);

/* The landmarks of a file of lines NAME X,Y,Z in millimetres of the scene's world; comments begin
 * with #. ERR_INPUT with the line. */
enum err carry_read_landmarks(struct procedure_landmark mark[PROCEDURE_LANDMARKS], size_t *marks,
                              const char *path, struct fault *fault);

#endif
