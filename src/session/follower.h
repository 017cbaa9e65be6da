/* SPDX-License-Identifier: MIT */
/*
 * Who follows a session: the pictures of it (src/show), which are there from the first one on that
 * somebody asks for until the scene is closed. A session that nobody looks at has none, and no
 * session knows what they are: it says what happens to it. None of that can fail.
 */
#ifndef SESSION_FOLLOWER_H
#define SESSION_FOLLOWER_H

#include <stddef.h>

struct camera;
struct changes;
struct pictures;
struct session;
struct session_memory;

struct follower {
    /* A command begins; it is taken back, and the session is as it was then; it stands, and what
     * nobody will ask for any more goes. */
    void (*mark)(struct pictures *pictures);
    void (*take_back)(struct pictures *pictures);
    void (*settle)(struct pictures *pictures);

    /* The forest's labels have changed like this, and the session's border with them; or have in a
     * way that no list says. */
    void (*follow)(struct pictures *pictures, const struct changes *changes);
    void (*forget_labels)(struct pictures *pictures);

    /* The view has another camera; or what was drawn fits no more, for another reason. */
    void (*take_camera)(struct pictures *pictures, const struct camera *camera);
    void (*forget)(struct pictures *pictures);

    /* Another scene takes the place of this one; or there is none any more, and all of it goes. */
    void (*leave_scene)(struct pictures *pictures);
    void (*release)(struct pictures *pictures);

    /* Adds the bytes held: `pictures`, and `answers` for labels. */
    void (*count_memory)(const struct pictures *pictures, struct session_memory *memory);
};

/* From now on these hear of it, and the session releases them. It has a scene, and none yet. */
void session_take_pictures(struct session *session, struct pictures *pictures,
                           const struct follower *follower);

/* NULL while there are none. */
struct pictures *session_pictures(const struct session *session);

#endif
