/* SPDX-License-Identifier: MIT */
/* Release a pointer at the end of its scope: OWNED(scene_drop) struct scene *scene = NULL. */
#ifndef TESTS_DROP_H
#define TESTS_DROP_H

#include "base/mem.h" /* OWNED */

/* Define NAME_drop, which calls release(pointer). */
#define DROP(name, release)                                                                        \
    struct name;                                                                                   \
    void release(struct name *one);                                                                \
    static inline void name##_drop(struct name **one)                                              \
    {                                                                                              \
        release(*one);                                                                             \
    }
DROP(forest, forest_free)
DROP(image_helper, image_helper_free)
DROP(journal, journal_close)
DROP(picture_writer, picture_writer_free)
DROP(scene, scene_free)
DROP(session, session_free)
DROP(surface, surface_free)
DROP(team, team_free)

#endif
