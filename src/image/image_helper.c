/* SPDX-License-Identifier: MIT */
#include "image/image_helper.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/scan.h"
#include "image/coprocess.h"
#include "image/exr.h"
#include "image/exr_write.h"
#include "image/png.h"

enum {
    PATH_MOST = 4096,
    NAME_MOST = 4096,
    VALUE_MOST = 1 << 20,
    NOTES_MOST = 1024,
    WORDS_MOST = 4096, /* bytes of a text about a file */
    SEND_PIECE = 1 << 20,
};

int image_helper_patience_ms = 60000;
uint64_t image_helper_memory_most;

struct image_helper {
    struct coprocess process;
};

enum err image_helper_new(struct image_helper **out, const char *program, struct fault *fault)
{
    struct image_helper *helper = calloc(1, sizeof *helper);
    *out = NULL;
    if (!helper)
        return fault_memory(fault, "the image helper");
    const enum err err = coprocess_init(&helper->process, IMAGE_HELPER, program, fault);
    helper->process.kind = "the image helper";
    helper->process.hint = " (.exr works without it)";
    helper->process.made_of = "OpenImageIO, which Debian has as libopenimageio-dev";
    helper->process.package = "iftty-image";
    if (err)
        free(helper);
    else
        *out = helper;
    return err;
}

void image_helper_free(struct image_helper *helper)
{
    if (!helper)
        return;
    coprocess_release(&helper->process);
    free(helper);
}

enum err image_helper_start(struct image_helper *helper, struct fault *fault)
{
    helper->process.patience_ms = image_helper_patience_ms;
    helper->process.memory = image_helper_memory_most ? image_helper_memory_most : mem_available();
    return coprocess_start(&helper->process, fault);
}

/* ---- writing ---- */

const struct strips_format *image_strips(const char *path)
{
    return file_is_named(path, EXR_NAMES) ? &exr_strips
           : file_is_named(path, ".png")  ? &png_strips
                                          : NULL;
}

/* Send a line and the bytes of two texts. */
static bool transmit_texts(struct coprocess *process, const char *line, const char *first,
                           const char *second)
{
    return coprocess_transmit(process, line, strlen(line)) &&
           coprocess_transmit(process, first, strlen(first)) &&
           coprocess_transmit(process, second, strlen(second));
}

/* Refuse counts beyond the protocol before anything is sent. */
static enum err check_request(const char *doing, const char *path, const struct picture *picture,
                              struct fault *fault)
{
    size_t length = strlen(path);
    if (length == 0 || length > PATH_MOST)
        return fault_set(fault, ERR_INPUT, "a path of %zu bytes; expected 1 to %d", length,
                         PATH_MOST);
    if (picture && picture->attributes > NOTES_MOST)
        return fault_set(fault, ERR_LIMIT, "cannot %s %s: more than %d notes", doing, path,
                         NOTES_MOST);
    for (size_t i = 0; picture && i < picture->attributes; i++)
        if (strlen(picture->attribute[i].name) > NAME_MOST ||
            strlen(picture->attribute[i].value) > VALUE_MOST)
            return fault_set(fault, ERR_LIMIT, "cannot %s %s: the note \"%.40s\" is too long",
                             doing, path, picture->attribute[i].name);
    return OK;
}

static void release_movie(struct image_movie *movie)
{
    if (movie->draft.length)
        file_discard(buf_text(&movie->draft));
    buf_release(&movie->draft);
    *movie = (struct image_movie){0};
}

enum err image_movie_begin(struct image_movie *movie, const struct picture *like, unsigned frames,
                           unsigned delay_ms, struct fault *fault)
{
    const char *path = movie->path;
    const bool has_alpha = like->is_clear && file_is_named(path, ".png|.tif|.tiff");
    const char *dot = strrchr(file_name(path), '.');
    struct coprocess *process = &movie->helper->process;
    char line[COPROCESS_LINE];
    enum err err = OK;
    bool goes = true;
    movie->channels = has_alpha ? 4 : 3;
    if (!dot || dot == file_name(path) || dot[1] == '\0')
        err = fault_set(fault, ERR_USAGE,
                        "cannot write %s: its name says no format; expected for instance .png, "
                        ".exr, .tif or .jpg",
                        path);
    if (!err)
        err = file_draft(&movie->draft, path, movie->mode, fault);
    const char *draft = buf_text(&movie->draft);
    if (!err)
        err = check_request("write", draft, like, fault);
    if (!err)
        err = image_helper_start(movie->helper, fault);
    if (!err) {
        snprintf(line, sizeof line, "write %zu %u %u %zu %u %u %u\n", strlen(draft), like->width,
                 like->height, like->attributes, frames, delay_ms, movie->channels);
        goes = transmit_texts(process, line, draft, "");
    }
    for (size_t i = 0; !err && goes && i < like->attributes; i++) {
        const struct attribute *note = &like->attribute[i];
        snprintf(line, sizeof line, "%zu %zu\n", strlen(note->name), strlen(note->value));
        goes = transmit_texts(process, line, note->name, note->value);
    }
    if (!goes)
        err = coprocess_fault(process, "write", path, fault);
    if (err)
        release_movie(movie);
    return err;
}

enum err image_movie_add(struct image_movie *movie, const struct picture *picture,
                         struct fault *fault)
{
    struct coprocess *process = &movie->helper->process;
    const size_t pixels = (size_t)picture->width * picture->height;
    const size_t channels = movie->channels;
    OWNED(mem_release) uint8_t *piece = mem_array(SEND_PIECE, 1);
    enum err err = piece ? OK : fault_memory(fault, movie->path);
    for (size_t done = 0, n; !err && done < pixels; done += n) {
        const uint8_t *rgba = (channels == 4 ? picture->rgba : picture_colours(picture)) + 4 * done;
        n = pixels - done < SEND_PIECE / 4 ? pixels - done : SEND_PIECE / 4;
        for (size_t i = 0; channels == 3 && i < n; i++)
            for (size_t c = 0; c < 3; c++) /* over black: transparent pixels fade */
                piece[3 * i + c] = (uint8_t)((rgba[4 * i + c] * rgba[4 * i + 3] + 127) / 255);
        if (!coprocess_transmit(process, channels == 3 ? piece : rgba, channels * n))
            err = coprocess_fault(process, "write", movie->path, fault);
    }
    if (err)
        image_movie_abandon(movie);
    return err;
}

enum err image_movie_end(struct image_movie *movie, struct fault *fault)
{
    char line[COPROCESS_LINE];
    enum err err = coprocess_answer(&movie->helper->process, line, "write", movie->path, fault);
    if (!err && strcmp(line, "ok") != 0) {
        coprocess_odd(&movie->helper->process);
        err = coprocess_fault(&movie->helper->process, "write", movie->path, fault);
    }
    if (!err) {
        err = file_publish(buf_text(&movie->draft), movie->path, movie->mode, fault);
        buf_clear(&movie->draft); /* it was renamed or removed */
    }
    release_movie(movie);
    return err;
}

void image_movie_abandon(struct image_movie *movie)
{
    if (movie->helper)
        coprocess_stop(&movie->helper->process); /* it may be waiting for the rest of a frame */
    release_movie(movie);
}

enum err image_write(struct image_helper *helper, const char *path, enum file_mode mode,
                     const struct picture *picture, struct fault *fault)
{
    struct image_movie movie = {.helper = helper, .path = path, .mode = mode};
    const struct strips_format *format = image_strips(path);
    if (format)
        return strips_write(format, path, mode, picture, fault);
    TRY(image_movie_begin(&movie, picture, 1, 0, fault));
    TRY(image_movie_add(&movie, picture, fault));
    return image_movie_end(&movie, fault);
}

enum err image_check_png(const char *path, struct fault *fault)
{
    if (!path)
        return OK;
    if (!file_is_named(path, ".png"))
        return fault_set(fault, ERR_USAGE, "expected a name that ends in .png, not %s", path);
    return file_may_write(path, FILE_KEEP, fault);
}

enum err image_write_png(const char *path, const struct picture *picture, struct fault *fault)
{
    struct image_helper *helper;
    enum err err = image_helper_new(&helper, NULL, fault);
    if (!err)
        err = image_write(helper, path, FILE_KEEP, picture, fault);
    image_helper_free(helper);
    return err;
}

/* ---- reading ---- */

static enum err receive_note(struct image_helper *helper, struct picture *out, struct fault *fault)
{
    static const int64_t most[2] = {NAME_MOST, VALUE_MOST};
    char line[COPROCESS_LINE];
    int64_t length[2];
    if (!coprocess_receive_line(&helper->process, line) ||
        (!coprocess_numbers(line, 2, most, length) && !coprocess_odd(&helper->process)))
        return ERR_IO;
    const size_t name = (size_t)length[0], value = (size_t)length[1];
    OWNED(mem_release) char *text = calloc(name + value + 2, 1); /* two strings, with their NULs */
    if (!text)
        return fault_memory(fault, "a note on a picture");
    return coprocess_receive(&helper->process, text, name) &&
                   coprocess_receive(&helper->process, text + name + 1, value)
               ? picture_note(out, text, text + name + 1, fault)
               : ERR_IO;
}

/* Send `request` for a path, and receive the first line of the answer: this word, and numbers,
 * the first two a size. */
static enum err send_request(struct image_helper *helper, const char *request, const char *path,
                             const char *answer, unsigned count, const int64_t *most,
                             int64_t *number, struct fault *fault)
{
    char line[COPROCESS_LINE];
    const char *at = line;
    TRY(check_request("read", path, NULL, fault));
    TRY(image_helper_start(helper, fault));
    snprintf(line, COPROCESS_LINE, "%s %zu\n", request, strlen(path));
    if (!transmit_texts(&helper->process, line, path, ""))
        return coprocess_fault(&helper->process, "read", path, fault);
    TRY(coprocess_answer(&helper->process, line, "read", path, fault));
    if (scan_text(&at, answer) && coprocess_numbers(at, count, most, number) && number[0] > 0 &&
        number[1] > 0)
        return OK;
    coprocess_odd(&helper->process);
    return coprocess_fault(&helper->process, "read", path, fault);
}

/* After the rest of the answer: report trouble of the process, or end it after another error. */
static enum err finish_answer(struct image_helper *helper, const char *path, enum err err,
                              struct fault *fault)
{
    if (err && helper->process.trouble != FINE)
        return coprocess_fault(&helper->process, "read", path, fault);
    if (err)
        coprocess_stop(&helper->process); /* the rest of its answer is not needed */
    return err;
}

enum err image_helper_read(struct image_helper *helper, const char *path, struct picture *out,
                           struct fault *fault)
{
    static const int64_t most[3] = {PICTURE_SIDE_MOST, PICTURE_SIDE_MOST, NOTES_MOST};
    int64_t number[3];
    *out = (struct picture){0};
    TRY(send_request(helper, "read", path, "picture ", 3, most, number, fault));
    enum err err = picture_init(out, (uint32_t)number[0], (uint32_t)number[1], 0, fault);
    for (int64_t i = 0; !err && i < number[2]; i++)
        err = receive_note(helper, out, fault);
    if (!err &&
        !coprocess_receive(&helper->process, out->rgba, 4 * (size_t)out->width * out->height))
        err = ERR_IO;
    err = finish_answer(helper, path, err, fault);
    if (err)
        picture_release(out);
    return err;
}

enum err image_helper_about(struct image_helper *helper, const char *path, struct image_facts *out,
                            struct fault *fault)
{
    static const int64_t most[7] = {PICTURE_SIDE_MOST, PICTURE_SIDE_MOST, INT32_MAX, NOTES_MOST,
                                    WORDS_MOST,        WORDS_MOST,        WORDS_MOST};
    char **const word[3] = {&out->format, &out->type, &out->channels};
    int64_t number[7];
    *out = (struct image_facts){0};
    TRY(send_request(helper, "about", path, "about ", 7, most, number, fault));
    enum err err = OK;
    for (int i = 0; i < 3 && !err; i++) {
        const size_t length = (size_t)number[4 + i];
        *word[i] = calloc(length + 1, 1);
        if (!*word[i])
            err = fault_memory(fault, "the facts of a picture");
        else if (!coprocess_receive(&helper->process, *word[i], length))
            err = ERR_IO;
    }
    for (int64_t i = 0; !err && i < number[3]; i++)
        err = receive_note(helper, &out->picture, fault);
    err = finish_answer(helper, path, err, fault);
    if (err) {
        image_facts_release(out);
        return err;
    }
    out->picture.width = (uint32_t)number[0];
    out->picture.height = (uint32_t)number[1];
    out->frames = (unsigned)number[2];
    return OK;
}

void image_facts_release(struct image_facts *facts)
{
    picture_release(&facts->picture);
    free(facts->format);
    free(facts->type);
    free(facts->channels);
    *facts = (struct image_facts){0};
}
