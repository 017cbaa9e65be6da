/* SPDX-License-Identifier: MIT */
#include "command/trust.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/confine.h"
#include "base/file.h"
#include "image/nifti.h"

/* Files that may name others with their voxels, which are to lie beside them. */
static const char HEADERS_ALONE[] = ".mhd|.nhdr|.h5|.hdf5|.hdf|.ims";

/* ---- a name that a journal gives ---- */

static enum beneath look_in(struct buf *path, const char *folder, size_t length, const char *name)
{
    buf_clear(path);
    buf_add(path, folder, length);
    const enum beneath answer = path->failed ? BENEATH_MISSING : beneath_look(buf_text(path), name);
    buf_printf(path, "/%s", name);
    return answer;
}

/* The first place that has something of this name decides: a link that leads out is an error, and
 * no reason to search a folder of scenes. */
static enum beneath look_everywhere(struct buf *path, const char *home, const char *scenes,
                                    const char *name)
{
    struct buf folder = {0};
    file_folder(&folder, home);
    enum beneath answer = look_in(path, buf_text(&folder), folder.length, name);
    while (answer == BENEATH_MISSING && *scenes) {
        const size_t length = strcspn(scenes, ":");
        if (length)
            answer = look_in(path, scenes, length, name);
        scenes += length + (scenes[length] == ':');
    }
    path->failed |= folder.failed;
    buf_release(&folder);
    return answer;
}

/* OK where the answer is that of a file that may be read, or of a folder where that is taken. */
static enum err refuse(enum beneath answer, const char *name, const struct trust_sought *sought,
                       struct fault *fault)
{
    const char *hint = sought->is_scene ? "; expected --scene FILE" : "";
    const char *where = sought->is_scene ? "" : " ($IFTTY_SCENES names their folders)";
    switch (sought->by_proof && answer == BENEATH_OUTSIDE ? BENEATH_MISSING : answer) {
    case BENEATH_FINE:
        return OK;
    case BENEATH_OUTSIDE:
        return fault_set(fault, ERR_INPUT,
                         "the journal may not read %s, which leads out of its folder%s; nothing %s",
                         name, hint, sought->undone);
    case BENEATH_FOLDER:
        if (sought->is_scene)
            return OK;
        __attribute__((fallthrough));
    case BENEATH_NO_FILE:
        return fault_set(fault, ERR_INPUT, "%s is not a regular file; nothing %s", name,
                         sought->undone);
    case BENEATH_MISSING:
        break;
    }
    return fault_set(fault, ERR_IO,
                     "there is no %s %s beside the journal or among the scenes%s%s; nothing %s",
                     sought->kind, name, where, hint, sought->undone);
}

/* What makes a pair with `name`, found as `path`, is read with it; FINE where nothing does. */
static enum beneath look_at_other(struct buf *other, const struct buf *path, const char *name)
{
    const size_t length = path->length - strlen(name) - 1;
    struct buf folder = {0};
    enum beneath answer = BENEATH_FINE;
    buf_add(&folder, path->data, length);
    if (pair_other(other, buf_text(path)) && !folder.failed)
        answer = beneath_look(buf_text(&folder), buf_text(other) + length + 1);
    other->failed |= folder.failed;
    buf_release(&folder);
    return answer;
}

enum err trust_find(struct buf *path, const char *home, const char *scenes, const char *name,
                    const struct trust_sought *sought, struct fault *fault)
{
    struct buf other = {0};
    enum beneath answer = look_everywhere(path, home, scenes, name);
    const char *last = name;
    if (!path->failed && answer == BENEATH_FINE) {
        const size_t length = path->length - strlen(name);
        answer = look_at_other(&other, path, name);
        if (answer == BENEATH_FOLDER)
            answer = BENEATH_NO_FILE;
        last = answer == BENEATH_FINE || sought->by_proof ? name : buf_text(&other) + length;
    }
    const enum err err = path->failed || other.failed ? fault_memory(fault, "a path")
                                                      : refuse(answer, last, sought, fault);
    buf_release(&other);
    return err;
}

/* ---- elsewhere ---- */

bool trust_leads_out(const char *name)
{
    return !beneath_is_inside(name) || file_is_from_home(name);
}

static bool is_regular(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISREG(status.st_mode);
}

/* Of a pair, the other file is the one that really lies beside it, and both are read there: a
 * header that a stranger puts beside a link would choose which bytes of a file are voxels, few
 * enough to be guessed. */
static bool take_pair(struct buf *path)
{
    struct buf other = {0};
    if (!file_is_named(buf_text(path), PAIR_HEADERS "|" PAIR_VOXELS))
        return true;
    char *real = realpath(buf_text(path), NULL);
    char *real_other = pair_other(&other, buf_text(path)) ? realpath(buf_text(&other), NULL) : NULL;
    bool fine = real && real_other && pair_other(&other, real) &&
                strcmp(real_other, buf_text(&other)) == 0 && is_regular(real_other);
    buf_clear(path);
    buf_add_text(path, fine ? real : "");
    fine = fine && !other.failed && !path->failed;
    free(real);
    free(real_other);
    buf_release(&other);
    return fine;
}

bool trust_find_outside(struct buf *path, const char *home, const char *scenes, const char *name)
{
    struct buf other = {0};
    bool leads_out = trust_leads_out(name);
    if (!leads_out) {
        enum beneath answer = look_everywhere(path, home, scenes, name);
        if (answer == BENEATH_FINE)
            answer = look_at_other(&other, path, name);
        leads_out = answer == BENEATH_OUTSIDE;
    } else if (*name == '/' || file_is_from_home(name)) {
        file_from_home(path, name);
    } else {
        file_folder(path, home);
        buf_printf(path, "/%s", name);
    }
    leads_out = leads_out && !path->failed && is_regular(buf_text(path)) &&
                !file_is_named(buf_text(path), HEADERS_ALONE) && !other.failed && take_pair(path);
    buf_release(&other);
    return leads_out;
}

/* ---- beside a journal ---- */

/* The last step of the path alone is a link, to a regular file. */
static bool is_link_to_file(const char *path, const char *folder, const char *goldens)
{
    struct stat status;
    return beneath_look(folder, goldens) == BENEATH_FOLDER && lstat(path, &status) == 0 &&
           S_ISLNK(status.st_mode) && is_regular(path);
}

enum beneath trust_look_at_golden(const char *path, bool *leads_out)
{
    struct buf goldens = {0}, folder = {0};
    file_folder(&goldens, path);
    file_folder(&folder, buf_text(&goldens));
    const char *name = path + (file_name(buf_text(&goldens)) - buf_text(&goldens));
    const bool failed = goldens.failed || folder.failed;
    enum beneath answer = failed ? BENEATH_OUTSIDE : beneath_look(buf_text(&folder), name);
    *leads_out = answer == BENEATH_OUTSIDE && !failed &&
                 is_link_to_file(path, buf_text(&folder), file_name(buf_text(&goldens)));
    answer = *leads_out ? BENEATH_FINE : answer;
    buf_release(&goldens);
    buf_release(&folder);
    return answer;
}

/* ---- confinement ---- */

enum { PLACES_MOST = 2048 };

/* Places as they are gathered, each once; their paths are its own. */
struct gathering {
    struct confine_place place[PLACES_MOST];
    char *path[PLACES_MOST];
    size_t places;
    bool is_full; /* or there was no memory */
};

static void gather_part(struct gathering *g, const char *path, size_t length, unsigned rights)
{
    for (size_t i = 0; i < g->places; i++)
        if (g->place[i].rights == rights && strlen(g->path[i]) == length &&
            memcmp(g->path[i], path, length) == 0)
            return;
    char *own = length && g->places < PLACES_MOST ? strndup(path, length) : NULL;
    g->is_full |= length && !own;
    if (!own)
        return;
    g->path[g->places] = own;
    g->place[g->places++] = (struct confine_place){own, rights};
}

static void gather(struct gathering *g, const char *path, unsigned rights)
{
    if (path)
        gather_part(g, path, strlen(path), rights);
}

static void gather_folder_of(struct gathering *g, const char *path, unsigned rights)
{
    struct buf folder = {0};
    file_folder(&folder, path);
    g->is_full |= folder.failed;
    gather(g, buf_text(&folder), rights);
    buf_release(&folder);
}

/* A scene that lies anywhere, and what is read with it. */
static void gather_scene(struct gathering *g, const char *path)
{
    struct buf other = {0};
    gather(g, path, CONFINE_READ);
    if (path && file_is_named(path, HEADERS_ALONE))
        gather_folder_of(g, path, CONFINE_READ);
    if (path && pair_other(&other, path))
        gather(g, buf_text(&other), CONFINE_READ);
    g->is_full |= other.failed;
    buf_release(&other);
}

bool trust_confine(const struct trust_places *places)
{
    /* What any program needs: its libraries, what they read as they start, and /dev/null. */
    static const char *const read[] = {
        "/usr/lib",       "/usr/lib32", "/usr/lib64",          "/lib",
        "/lib64",         "/usr/share", "/usr/local/lib",      "/etc/ld.so.cache",
        "/etc/localtime", "/proc",      "/sys/devices/system", "/dev/urandom",
        "/dev/random",    "/dev/zero"};
    struct gathering g = {.places = 0};
    for (size_t i = 0; i < sizeof read / sizeof *read; i++)
        gather(&g, read[i], CONFINE_READ | (i < 5 ? CONFINE_RUN : 0u));
    gather(&g, "/dev/null", CONFINE_DEVICE);
    for (int i = 0; i < 2; i++)
        gather(&g, places->helper[i], CONFINE_READ | CONFINE_RUN);
    gather_scene(&g, places->scene);
    gather_scene(&g, places->outside);
    for (const char *list = places->scenes; *list; list += *list == ':') {
        const size_t length = strcspn(list, ":");
        gather_part(&g, list, length, CONFINE_READ);
        list += length;
    }
    for (const char *const *at = places->written; at && *at; at++) {
        gather(&g, *at, CONFINE_WRITE);
        gather_folder_of(&g, *at, CONFINE_EMPTY);
    }
    /* A journal may be a link to one, whose folder is not the one that names are looked up in. */
    for (int i = 0; i < places->journals; i++) {
        struct stat status;
        gather_folder_of(&g, places->journal[i], CONFINE_READ);
        if (lstat(places->journal[i], &status) == 0 && S_ISLNK(status.st_mode))
            gather(&g, places->journal[i], CONFINE_READ);
    }
    gather(&g, places->goldens, CONFINE_READ);
    for (const char *const *at = places->linked; at && *at; at++)
        gather(&g, *at, CONFINE_READ);
    const bool is_confined = !g.is_full && confine_to(g.place, g.places);
    while (g.places > 0)
        free(g.path[--g.places]);
    return is_confined;
}
