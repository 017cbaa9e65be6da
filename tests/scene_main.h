/* SPDX-License-Identifier: MIT */
/* The main of a test program about the scene of small_scene.h: write it, and run the stories. */
#ifndef TESTS_SCENE_MAIN_H
#define TESTS_SCENE_MAIN_H

#include "tests/small_scene.h"

int main(void)
{
    if (!begin_folder())
        return 1;
    make_scene();
    const int status = check_run();
    return status | end_folder();
}

#endif
