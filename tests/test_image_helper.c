/* SPDX-License-Identifier: MIT */
/* The image helper: pictures through other formats, and a helper that misbehaves. */
#include <errno.h>
#include <signal.h>
#include <sys/wait.h>

#include "base/buf.h"
#include "base/clock.h"
#include "base/file.h"
#include "image/exr.h"
#include "image/image_helper.h"

static struct image_helper *helper;
#define BEFORE_STORIES                                                                             \
    if (image_helper_new(&helper, built_program("iftty-image"), NULL) != OK)                       \
    return 1
#define ONLY_LEAVES "(a[.](png|PNG|tif|bmp|tga|ppm|gif|hdr|jpg|exr)|bad[.]png|helper[.]sh)"
#include "tests/folder_main.h"

static struct picture sample(uint32_t width, uint32_t height)
{
    struct picture p;
    CHECK_INT(picture_init(&p, width, height, PICTURE_BUT_NORMAL, NULL), OK);
    for (size_t i = 0; i < (size_t)width * height; i++) {
        for (size_t c = 0; c < 3; c++)
            p.rgba[4 * i + c] = (uint8_t)(i * (2 * c + 3) + 40 * c);
        p.rgba[4 * i + 3] = 255;
    }
    picture_note(&p, "scene", "sha256:0123abcd", NULL);
    picture_note(&p, "view", "yaw 30 pitch 20", NULL);
    return p;
}

/* Writes and reads `name`; the words of a failure, or "". */
static const char *there_and_back(const struct picture *p, const char *name, struct picture *q)
{
    static struct fault fault;
    fault = (struct fault){0};
    *q = (struct picture){0};
    if (image_write(helper, file_in(folder, name), FILE_REPLACE, p, &fault) == OK)
        image_helper_read(helper, file_in(folder, name), q, &fault);
    return fault.text;
}

STORY(lossless_formats_bring_every_pixel_back)
{
    static const char *const name[] = {"a.png", "a.tif", "a.bmp", "a.tga", "a.ppm", "a.PNG"};
    for (size_t i = 0; i < sizeof name / sizeof name[0]; i++) {
        OWNED(picture_release) struct picture p = sample(61, 47), q;
        CHECK_TEXT(there_and_back(&p, name[i], &q), "");
        CHECK_INT(q.width, 61);
        CHECK_INT(q.height, 47);
        CHECK(q.rgba && memcmp(p.rgba, q.rgba, (size_t)61 * 47 * 4) == 0);
    }
}

STORY(a_jpeg_comes_back_about_the_same)
{
    OWNED(picture_release) struct picture p = sample(64, 64), q;
    memset(p.rgba, 200, (size_t)64 * 64 * 4);
    CHECK_TEXT(there_and_back(&p, "a.jpg", &q), "");
    CHECK(q.rgba && q.rgba[0] > 60 && q.rgba[0] < 250 && q.rgba[3] == 255);
}

STORY(what_is_transparent_comes_out_black)
{
    OWNED(picture_release) struct picture p = sample(2, 1), q;
    memcpy(p.rgba, (const uint8_t[]){200, 100, 50, 0, 200, 100, 50, 128}, 8);
    CHECK_TEXT(there_and_back(&p, "a.png", &q), "");
    CHECK(memcmp(q.rgba, (const uint8_t[]){0, 0, 0, 255, 100, 50, 25, 255}, 8) == 0);
}

STORY(a_png_keeps_each_note)
{
    OWNED(picture_release) struct picture p = sample(8, 8), q;
    CHECK_TEXT(there_and_back(&p, "a.png", &q), "");
    const char *scene = picture_find(&q, "scene"), *view = picture_find(&q, "view");
    CHECK_TEXT(scene ? scene : "missing", "sha256:0123abcd");
    CHECK_TEXT(view ? view : "missing", "yaw 30 pitch 20");
}

STORY(other_formats_keep_the_notes_as_a_description)
{
    static const char *const name[] = {"a.tif", "a.jpg"};
    for (size_t i = 0; i < 2; i++) {
        OWNED(picture_release) struct picture p = sample(8, 8), q;
        CHECK_TEXT(there_and_back(&p, name[i], &q), "");
        const char *all = picture_find(&q, "ImageDescription");
        CHECK_HAS(all ? all : "missing", "scene: sha256:0123abcd\nview: yaw 30 pitch 20");
    }
}

STORY(the_same_picture_gives_the_same_bytes)
{
    static const char *const name[] = {"a.png", "a.tif", "a.jpg", "a.bmp"};
    OWNED(picture_release) struct picture p = sample(20, 20);
    struct buf first[4] = {0}, second = {0};
    for (int round = 0; round < 2; round++) {
        for (size_t i = 0; i < 4; i++) {
            struct buf *to = round ? &second : &first[i];
            CHECK_INT(image_write(helper, file_in(folder, name[i]), FILE_REPLACE, &p, NULL), OK);
            CHECK_INT(file_read(to, file_in(folder, name[i]), 1 << 20, NULL), OK);
            if (round)
                CHECK(second.length == first[i].length &&
                      memcmp(second.data, first[i].data, second.length) == 0);
        }
        if (round == 0)
            sleep(1); /* the clock moves on; the files do not tell */
    }
    for (size_t i = 0; i < 4; i++)
        buf_release(&first[i]);
    buf_release(&second);
}

STORY(exr_goes_without_the_helper)
{
    OWNED(image_helper_drop) struct image_helper *none = NULL;
    OWNED(picture_release) struct picture p = sample(9, 9), q;
    CHECK_INT(image_helper_new(&none, "/nonexistent/iftty-image", NULL), OK);
    CHECK_INT(image_write(none, file_in(folder, "a.exr"), FILE_REPLACE, &p, NULL), OK);
    CHECK_INT(exr_read(&q, file_in(folder, "a.exr"), NULL), OK);
    CHECK(q.voxel != NULL && memcmp(p.rgba, q.rgba, 9 * 9 * 4) == 0);
}

STORY(a_name_without_a_known_format_is_told_off)
{
    static const char *const name[] = {"a.xyz", "plain", ".png", "a.", "a.term", "a.null"};
    OWNED(picture_release) struct picture p = sample(4, 4);
    for (size_t i = 0; i < sizeof name / sizeof name[0]; i++) {
        struct fault fault = {0};
        CHECK(image_write(helper, file_in(folder, name[i]), FILE_KEEP, &p, &fault) != OK);
        CHECK_HAS(fault.text, "expected for instance .png, .exr, .tif or .jpg");
        CHECK_HAS(fault.text, file_in(folder, name[i]));
        CHECK(!file_exists(file_in(folder, name[i])));
    }
}

STORY(an_existing_file_is_kept_unless_told)
{
    OWNED(picture_release) struct picture p = sample(4, 4);
    struct fault fault = {0};
    CHECK_INT(image_write(helper, file_in(folder, "a.png"), FILE_REPLACE, &p, NULL), OK);
    CHECK_INT(image_write(helper, file_in(folder, "a.png"), FILE_KEEP, &p, &fault), ERR_IO);
    CHECK_HAS(fault.text, "exists already");
}

STORY(what_is_no_image_is_told_in_a_line)
{
    struct picture q;
    struct image_facts facts;
    struct fault fault = {0};
    const char *bad = file_in(folder, "bad.png");
    CHECK_INT(file_write(bad, "\x1b[2Jnot a png", 13, FILE_REPLACE, NULL), OK);
    CHECK_INT(image_helper_read(helper, bad, &q, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "cannot read");
    CHECK(strpbrk(fault.text, "\n\033") == NULL && q.rgba == NULL);
    CHECK_INT(image_helper_about(helper, bad, &facts, &fault), ERR_INPUT);
    CHECK(strpbrk(fault.text, "\n\033") == NULL && facts.format == NULL);
    CHECK(image_helper_read(helper, file_in(folder, "none.png"), &q, &fault) != OK);
    CHECK_HAS(fault.text, "none.png");
}

STORY(damaged_images_never_end_the_session)
{
    struct picture p = sample(30, 30), q;
    OWNED(buf_release) struct buf file = {0};
    uint64_t chance = 7;
    CHECK_INT(image_write(helper, file_in(folder, "a.png"), FILE_REPLACE, &p, NULL), OK);
    CHECK_INT(file_read(&file, file_in(folder, "a.png"), 1 << 20, NULL), OK);
    for (unsigned round = 0; round < check_scaled(100); round++) {
        struct fault fault = {0};
        size_t at = check_below(&chance, (uint32_t)file.length);
        char kept = file.data[at];
        file.data[at] = (char)check_random(&chance);
        size_t length = round % 3 ? file.length : at;
        FILE *out = fopen(file_in(folder, "bad.png"), "wb");
        fwrite(file.data, 1, length, out);
        fclose(out);
        if (image_helper_read(helper, file_in(folder, "bad.png"), &q, &fault) != OK)
            CHECK(fault.text[0] != '\0' && q.rgba == NULL);
        picture_release(&q);
        file.data[at] = kept;
    }
    picture_release(&p);
}

/* Writes frames of growing brightness; the words of a failure, or "". */
static const char *write_frames(const char *name, unsigned frames, unsigned delay_ms)
{
    static struct fault fault;
    OWNED(picture_release) struct picture p = sample(40, 30);
    struct image_movie movie = {helper, file_in(folder, name), .mode = FILE_REPLACE};
    fault = (struct fault){0};
    enum err err = image_movie_begin(&movie, &p, frames, delay_ms, &fault);
    for (unsigned i = 0; i < frames && !err; i++) {
        for (size_t k = 0; k < (size_t)40 * 30 * 4; k++)
            p.rgba[k] = k % 4 == 3 ? 255 : (uint8_t)(40 * (i + 1));
        err = image_movie_add(&movie, &p, &fault);
    }
    if (!err)
        image_movie_end(&movie, &fault);
    return fault.text;
}

STORY(a_file_of_several_frames_says_so)
{
    static const char *const name[] = {"a.gif", "a.tif"};
    for (size_t i = 0; i < 2; i++) {
        OWNED(image_facts_release) struct image_facts facts;
        CHECK_TEXT(write_frames(name[i], 5, 80), "");
        CHECK_INT(image_helper_about(helper, file_in(folder, name[i]), &facts, NULL), OK);
        CHECK_INT(facts.frames, 5);
        CHECK_INT(facts.picture.width, 40);
        CHECK_INT(facts.picture.height, 30);
        CHECK_TEXT(facts.format, i ? "tiff" : "gif");
        CHECK_TEXT(facts.type, "uint8");
        CHECK_TEXT(facts.channels, i ? "R,G,B" : "R,G,B,A");
    }
}

STORY(a_format_of_one_picture_refuses_several)
{
    CHECK_HAS(write_frames("a.png", 2, 0), ".png holds one picture; expected for instance .gif");
    CHECK_HAS(write_frames("a.xyz", 3, 0), "no known format writes .xyz");
    CHECK_TEXT(write_frames("a.png", 1, 0), ""); /* the same helper continues */
}

STORY(frames_that_never_come_cost_one_helper)
{
    OWNED(picture_release) struct picture p = sample(40, 30), q;
    struct image_movie movie = {helper, file_in(folder, "a.gif"), .mode = FILE_REPLACE};
    CHECK_INT(image_movie_begin(&movie, &p, 3, 0, NULL), OK);
    CHECK_INT(image_movie_add(&movie, &p, NULL), OK);
    image_movie_abandon(&movie);
    CHECK_TEXT(there_and_back(&p, "a.png", &q), "");
}

STORY(linear_formats_get_linear_light)
{
    OWNED(picture_release) struct picture p = sample(1, 1), q;
    OWNED(buf_release) struct buf file = {0};
    memcpy(p.rgba, (const uint8_t[]){188, 188, 188, 255}, 4); /* 0.503 of full light */
    CHECK_TEXT(there_and_back(&p, "a.hdr", &q), "");
    CHECK_INT(file_read(&file, file_in(folder, "a.hdr"), 1 << 20, NULL), OK);
    const uint8_t *last = (const uint8_t *)file.data + file.length - 4;
    CHECK(file.length > 4 && last[3] == 128 && last[0] >= 127 && last[0] <= 129);
}

/* A helper that is a small shell script. */
static struct image_helper *scripted(const char *script)
{
    struct image_helper *odd = NULL;
    const char *path = make_script(folder, "helper.sh", script);
    CHECK_INT(image_helper_new(&odd, path, NULL), OK);
    return odd;
}

/* The message for a scripted helper that fails, reading (or writing a large picture). */
static const char *failure(const char *script, bool writing)
{
    static struct fault fault;
    OWNED(image_helper_drop) struct image_helper *odd = scripted(script);
    struct picture p = sample(writing ? 1500 : 4, 1000), q = {0};
    fault = (struct fault){0};
    enum err err = writing ? image_write(odd, file_in(folder, "x.tif"), FILE_REPLACE, &p, &fault)
                           : image_helper_read(odd, file_in(folder, "x.png"), &q, &fault);
    CHECK(err != OK && q.rgba == NULL);
    picture_release(&p);
    return fault.text;
}

STORY(a_helper_that_is_missing_ends_or_dies_is_told)
{
    OWNED(image_helper_drop) struct image_helper *none = NULL;
    struct picture q;
    struct fault fault = {0};
    CHECK_INT(image_helper_new(&none, "/nonexistent/iftty-image", NULL), OK);
    CHECK_INT(image_helper_read(none, "a.png", &q, &fault), ERR_IO);
    CHECK_HAS(fault.text, "cannot start the image helper /nonexistent/iftty-image: No such file");
    for (int writing = 0; writing < 2; writing++) {
        CHECK_HAS(failure("exit 3", writing), "helper.sh ended with status 3");
        CHECK_HAS(failure("read line; kill -SEGV $$", writing), "helper.sh died (Segmentation");
        CHECK_HAS(failure("kill -KILL $$", writing), "helper.sh died (Killed)");
    }
}

STORY(answers_that_make_no_sense_are_told)
{
    static const char *const answer[] = {
        "hello\\n",
        "picture 0 4 0\\n",
        "picture 4 4\\n",
        "picture 4 4 0 0\\n",
        "error 9999\\nxxx",
        "error -1\\n",
        "picture 4 4 1\\nx\\n",
        "picture 99999 4 0\\n",
        "picture 1 1 1\\n99999 1\\n",
    };
    for (size_t i = 0; i < sizeof answer / sizeof answer[0]; i++) {
        char script[128];
        snprintf(script, sizeof script, "printf '%s'; sleep 9", answer[i]);
        CHECK_HAS(failure(script, false), "sent an invalid answer");
    }
    CHECK_HAS(failure("printf %0100d 0; sleep 9", false), "sent an invalid answer");
    const char *script = "exec 3<&0; cat <&3 >/dev/null & printf 'picture 1 1 0\\n'; sleep 9";
    CHECK_HAS(failure(script, true), "sent an invalid answer");
}

STORY(facts_that_make_no_sense_are_told)
{
    static const char *const answer[] = {
        "about 1 1 1 0 1 1\\n", "about 0 1 1 0 1 1 1\\nabc",     "about 1 1 1 0 9999 1 1\\nabc",
        "picture 1 1 0\\nabcd", "about 1 1 1 1 1 1 1\\nabcx\\n",
    };
    for (size_t i = 0; i < sizeof answer / sizeof answer[0]; i++) {
        char script[128];
        struct fault fault = {0};
        struct image_facts facts;
        snprintf(script, sizeof script, "printf '%s'; sleep 9", answer[i]);
        OWNED(image_helper_drop) struct image_helper *odd = scripted(script);
        CHECK_INT(image_helper_about(odd, file_in(folder, "x.png"), &facts, &fault), ERR_IO);
        CHECK_HAS(fault.text, "sent an invalid answer");
        CHECK(facts.format == NULL && facts.channels == NULL);
    }
}

STORY(an_answer_cut_short_is_told)
{
    CHECK_HAS(failure("printf 'picture 4 4 0\\nabc'", false), "ended with status 0");
    CHECK_HAS(failure("printf 'error 40\\nabc'", false), "ended with status 0");
    CHECK_HAS(failure("sleep 0.2; printf 'error 3\\nabc'", false), "x.png: abc");
}

STORY(a_helper_that_stays_silent_is_ended)
{
    uint64_t begin = clock_ns();
    image_helper_patience_ms = 200;
    CHECK_HAS(failure("sleep 60", false), "did not answer for 1 s and was ended");
    CHECK_HAS(failure("sleep 60", true), "did not answer for 1 s and was ended");
    CHECK_HAS(failure("exec <&- >&-; sleep 60", false), "did not answer for 1 s and was ended");
    image_helper_patience_ms = 60000;
    CHECK(clock_ns() - begin < UINT64_C(30000000000));
}

/* By Ctrl-Z, for instance. */
STORY(while_the_client_is_stopped_a_helper_has_time)
{
    image_helper_patience_ms = 1000;
    fflush(stdout);
    const pid_t client = fork();
    if (client == 0)
        _exit(!strstr(failure("kill -STOP $PPID; sleep 2.5; kill -CONT $PPID; sleep 0.3; "
                              "printf 'error 3\\nabc'",
                              false),
                      "x.png: abc"));
    int status;
    CHECK(waitpid(client, &status, 0) == client && status == 0);
    image_helper_patience_ms = 60000;
}

STORY(after_a_death_the_next_request_starts_anew)
{
    struct image_helper *twice = scripted("if [ -e ${0%/*}/died ]; then\n"
                                          "  printf 'error 5\\nalive'; sleep 1\n"
                                          "else\n"
                                          "  : >${0%/*}/died; kill -ABRT $$\n"
                                          "fi");
    struct picture q;
    struct fault fault = {0};
    CHECK_INT(image_helper_read(twice, "a.png", &q, &fault), ERR_IO);
    CHECK_HAS(fault.text, "died (Aborted)");
    CHECK_INT(image_helper_read(twice, "a.png", &q, &fault), ERR_INPUT);
    CHECK_HAS(fault.text, "cannot read a.png: alive");
    image_helper_free(twice);
    unlink(file_in(folder, "died"));
}

/* The words of a helper that says how many kilobytes of memory it may hold. */
static const char *ask_its_memory(void)
{
    static struct fault fault;
    struct picture q;
    OWNED(image_helper_drop)
    struct image_helper *modest = scripted("read line; words=$(ulimit -d)\n"
                                           "printf 'error %d\\n%s' ${#words} $words; sleep 9");
    fault = (struct fault){0};
    CHECK_INT(image_helper_read(modest, "a.png", &q, &fault), ERR_INPUT);
    return fault.text;
}

STORY(a_helper_is_held_to_the_memory_that_it_is_given_or_that_is_free)
{
    if (!MEM_MAY_BE_LIMITED) {
        SKIP("a sanitiser takes more memory than a replay leaves");
        return;
    }
    CHECK(strstr(ask_its_memory(), "unlimited") == NULL);
    image_helper_memory_most = 512000000;
    CHECK_HAS(ask_its_memory(), "a.png: 500000");
    image_helper_memory_most = 0;
}
