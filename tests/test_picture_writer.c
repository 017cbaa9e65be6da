/* SPDX-License-Identifier: MIT */
/* The picture writer: jobs in their order, outcomes reported once, memory bounded. Runs under
 * ThreadSanitizer too.
 */
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/file.h"
#include "image/exr.h"
#include "image/image_helper.h"
#include "image/picture_writer.h"
#define ONLY_LEAVES "[^.].*" /* no drafts */
#include "folder_main.h"

static struct picture sample(uint8_t level)
{
    struct picture p;
    CHECK_INT(picture_init(&p, 60, 40, 0, NULL), OK);
    memset(p.rgba, level, (size_t)60 * 40 * 4);
    for (size_t i = 3; i < (size_t)60 * 40 * 4; i += 4)
        p.rgba[i] = 255;
    return p;
}

static struct picture_writer *begin(void)
{
    struct picture_writer *writer = NULL;
    CHECK_INT(picture_writer_new(&writer, built_program("iftty-image")), OK);
    return writer;
}

static void give(struct picture_writer *writer, const char *name, enum file_mode mode,
                 uint8_t level)
{
    struct picture p = sample(level);
    struct picture_job *job = NULL;
    struct fault fault = {0};
    if (!CHECK(picture_job_new(&job, file_in(folder, name), mode, &p, &fault) == OK))
        printf("#   %s\n", fault.text);
    else
        picture_writer_give(writer, job);
    CHECK(p.rgba == NULL); /* it is the job's */
}

static const char *refusal(const char *name, enum file_mode mode)
{
    static struct fault fault;
    OWNED(picture_release) struct picture p = sample(1);
    struct picture_job *job;
    fault = (struct fault){0};
    CHECK(picture_job_new(&job, file_in(folder, name), mode, &p, &fault) != OK && job == NULL);
    CHECK(p.rgba != NULL);
    return fault.text;
}

static bool has_news(const struct picture_writer *writer, int patience_ms)
{
    struct pollfd ready = {.fd = picture_writer_descriptor(writer), .events = POLLIN};
    return poll(&ready, 1, patience_ms) == 1;
}

/* The news until nothing is to be done, in a buffer that is good until the next call. */
static const char *news(struct picture_writer *writer)
{
    static struct buf text;
    buf_clear(&text);
    CHECK_INT(picture_writer_wait(writer, NULL), OK);
    picture_writer_news(writer, &text);
    return buf_text(&text);
}

/* A helper that is a small shell script. */
static struct picture_writer *scripted(const char *script)
{
    struct picture_writer *writer = NULL;
    const char *path = make_script(folder, "helper.sh", script);
    CHECK_INT(picture_writer_new(&writer, path), OK);
    return writer;
}

STORY(a_picture_is_there_when_the_news_say_so)
{
    OWNED(picture_writer_drop) struct picture_writer *writer = begin();
    OWNED(buf_release) struct buf text = {0};
    char wrote[FILE_LENGTH + 8];
    CHECK(!has_news(writer, 0));
    give(writer, "a.png", FILE_KEEP, 9);
    CHECK(has_news(writer, 60000) && file_exists(file_in(folder, "a.png")));
    snprintf(wrote, sizeof wrote, "wrote %s\n", file_in(folder, "a.png"));
    picture_writer_news(writer, &text);
    CHECK_TEXT(buf_text(&text), wrote);
    CHECK(!has_news(writer, 0));
    picture_writer_news(writer, &text); /* reported once */
    CHECK_TEXT(buf_text(&text), wrote);
}

STORY(jobs_are_done_in_their_order)
{
    OWNED(picture_writer_drop) struct picture_writer *writer = begin();
    char expected[12 * FILE_LENGTH] = "", line[FILE_LENGTH + 8];
    OWNED(picture_release) struct picture q;
    for (unsigned i = 0; i < 12; i++) {
        give(writer, "same.exr", FILE_REPLACE, (uint8_t)i);
        snprintf(line, sizeof line, "wrote %s\n", file_in(folder, "same.exr"));
        strcat(expected, line);
    }
    while (picture_writer_holds(writer, file_in(folder, "same.exr")))
        usleep(100); /* looks on while the thread is at work */
    CHECK_TEXT(news(writer), expected);
    CHECK_INT(exr_read(&q, file_in(folder, "same.exr"), NULL), OK);
    CHECK_INT(q.rgba[0], 11); /* the last one */
}

STORY(what_cannot_be_is_refused_at_once)
{
    CHECK_HAS(refusal("a.png", FILE_KEEP), "exists already and was left alone");
    CHECK_HAS(refusal("none/a.png", FILE_REPLACE), "there is no folder");
    CHECK_HAS(refusal(".", FILE_REPLACE), "is a folder");
}

STORY(what_fails_later_is_reported)
{
    OWNED(picture_writer_drop) struct picture_writer *writer = begin();
    give(writer, "late.tif", FILE_KEEP, 1);
    give(writer, "late.tif", FILE_KEEP, 2); /* not there yet, when it was given */
    const char *text = news(writer);
    CHECK_HAS(text, "wrote ");
    CHECK_HAS(text, "\nerror: ");
    CHECK_HAS(text, "late.tif exists already and was left alone\n");
}

STORY(a_helper_that_dies_costs_one_picture)
{
    OWNED(picture_writer_drop) struct picture_writer *writer = scripted("exit 3");
    give(writer, "dead.tif", FILE_KEEP, 1);
    CHECK_HAS(news(writer), "error: cannot write ");
    CHECK_TEXT(news(writer), ""); /* reported once */
    give(writer, "alive.exr", FILE_KEEP, 1);
    CHECK_HAS(news(writer), "wrote ");
    CHECK(!file_exists(file_in(folder, "dead.tif")) && file_exists(file_in(folder, "alive.exr")));
}

/* The helper stays silent until a file is there, so everything waits; the fifth that waits has to
 * wait outside. */
STORY(a_known_number_of_pictures_waits)
{
    char script[2 * FILE_LENGTH], name[16];
    snprintf(script, sizeof script, "until [ -e %s ]; do sleep 0.02; done", file_in(folder, "go"));
    OWNED(picture_writer_drop) struct picture_writer *writer = scripted(script);
    for (unsigned i = 0; i < PICTURE_WRITER_WAITING_MOST + 1; i++) {
        snprintf(name, sizeof name, "wait%u.tif", i);
        give(writer, name, FILE_KEEP, 1);
    }
    /* One is being written, four wait, and no caller has waited for them. */
    CHECK(picture_writer_holds(writer, file_in(folder, "wait0.tif")) &&
          picture_writer_holds(writer, file_in(folder, "wait4.tif")));
    CHECK(!picture_writer_holds(writer, file_in(folder, "wait5.tif")));
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        usleep(200000);
        _exit(file_write(file_in(folder, "go"), "", 0, FILE_KEEP, NULL) == OK ? 0 : 1);
    }
    give(writer, "wait5.tif", FILE_KEEP, 1);
    CHECK(file_exists(file_in(folder, "go"))); /* it had to wait for that */
    CHECK(!picture_writer_holds(writer,
                                file_in(folder, "wait0.tif"))); /* the helper has ended by then */
    CHECK(waitpid(child, NULL, 0) == child);
    const char *text = news(writer);
    unsigned lines = 0;
    for (const char *at = text; (at = strstr(at, "error: cannot write ")) != NULL; at++)
        lines++;
    CHECK_INT(lines, PICTURE_WRITER_WAITING_MOST + 2);
}

/* As soon as the first picture is at work. */
static bool stop(void *context, const char *what, uint64_t done, uint64_t total)
{
    (void)context, (void)what, (void)done, (void)total;
    return file_exists(file_in(folder, "busy"));
}

STORY(waiting_can_be_given_up)
{
    OWNED(picture_writer_drop)
    struct picture_writer *writer = scripted(": >${0%/*}/busy; exec sleep 30");
    struct watch watch = {.poll = stop};
    OWNED(buf_release) struct buf text = {0};
    image_helper_patience_ms = 1500;
    for (unsigned i = 0; i < 3; i++)
        give(writer, i == 0 ? "up0.tif" : i == 1 ? "up1.tif" : "up2.tif", FILE_KEEP, 1);
    CHECK_INT(picture_writer_wait(writer, &watch), ERR_CANCELLED);
    picture_writer_news(writer, &text);
    CHECK_HAS(buf_text(&text), "cancelled: ");
    CHECK_HAS(buf_text(&text), "up2.tif was not written\n");
    CHECK_HAS(buf_text(&text), "did not answer"); /* the one at work had its time */
    CHECK(!file_exists(file_in(folder, "up0.tif")) && !file_exists(file_in(folder, "up2.tif")));
    image_helper_patience_ms = 60000;
}

STORY(leaving_waits_for_everything)
{
    struct picture_writer *writer = begin();
    give(writer, "end1.tif", FILE_KEEP, 1);
    give(writer, "end2.exr", FILE_KEEP, 2);
    give(writer, "end3.tif", FILE_KEEP, 3);
    picture_writer_free(writer);
    CHECK(file_exists(file_in(folder, "end1.tif")) && file_exists(file_in(folder, "end2.exr")) &&
          file_exists(file_in(folder, "end3.tif")));
    picture_writer_free(NULL);
    picture_job_free(NULL);
}

STORY(only_well_known_formats_are_taken)
{
    CHECK(picture_writer_takes("a.png") && picture_writer_takes("x/a.b.EXR") &&
          picture_writer_takes("a.tiff"));
    CHECK(!picture_writer_takes("png") && !picture_writer_takes("a.xyz") &&
          !picture_writer_takes("a.png/b"));
}
