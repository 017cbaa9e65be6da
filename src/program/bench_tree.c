#include "program/bench_tree.h"

enum { FOLDERS_ABOVE = 4 };

bool bench_find_in_tree(struct buf *path, const char *name)
{
    struct buf folder = {0};
    bool found = false;
    if (file_program_folder(&folder, NULL))
        return false;
    for (int i = 0; i < FOLDERS_ABOVE && !found; i++) {
        buf_add_text(&folder, "/..");
        buf_clear(path);
        buf_printf(path, "%s/%s", buf_text(&folder), name);
        found = !path->failed && file_exists(buf_text(path));
    }
    buf_release(&folder);
    return found;
}

enum err bench_find_example(struct buf *path, const struct interpreter *interp, struct fault *fault)
{
    struct buf scene = {0};
    const bool has_brain = interpreter_find_scene(interp, "ch2.nii.gz", &scene, NULL) == OK;
    const char *name = has_brain ? "examples/brain.iftty" : "examples/geom.iftty";
    buf_release(&scene);
    if (bench_find_in_tree(path, name))
        return OK;
    return fault_set(fault, ERR_IO, "%s does not lie beside the program", name);
}
