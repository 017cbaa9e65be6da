/* SPDX-License-Identifier: MIT */
/* Publishing files, on file systems that have less than others: no renaming to a name that has to
 * be new, no hard links. And what is cleared away of those that were killed while they did so. */
#include <errno.h>
#include <fcntl.h>
#include <sys/wait.h>

#include "base/file.h"
#include "tests/folder_main.h"

/* ---- file systems ---- */

static enum file_step lacking[2];
static int refusal;

static int lacks(enum file_step step, const char *path)
{
    (void)path;
    return step == lacking[0] || step == lacking[1] ? refusal : 0;
}

static bool holds(const char *path, const char *text)
{
    OWNED(buf_release) struct buf found = {0};
    return file_read(&found, path, 1000, NULL) == OK && strcmp(found.data, text) == 0;
}

/* A new file, one that is refused, one that is replaced, and one that is taken back. */
static void publish_all(void)
{
    OWNED(buf_release) struct buf backup = {0};
    struct fault fault = {.text = ""};
    const char *path = file_in(folder, "a.txt");
    CHECK(file_write(path, "one", 3, FILE_KEEP, &fault) == OK);
    CHECK_TEXT(fault.text, "");
    CHECK(holds(path, "one") && file_write(path, "two", 3, FILE_KEEP, &fault) == ERR_IO);
    CHECK_HAS(fault.text, "exists already");
    CHECK(file_backup(&backup, path, &fault) == OK);
    CHECK(file_write(path, "three", 5, FILE_REPLACE, &fault) == OK && holds(path, "three"));
    CHECK(file_restore(buf_text(&backup), path, &fault) == OK && holds(path, "one"));
    CHECK_INT(count_names(folder, ""), 1);
    unlink(path);
}

/* Somebody takes the name while the file is being written. */
static void publish_late(void)
{
    OWNED(buf_release) struct buf draft = {0};
    struct fault fault = {.text = ""};
    const char *path = file_in(folder, "b.txt");
    CHECK(file_draft(&draft, path, FILE_KEEP, &fault) == OK);
    int (*hook)(enum file_step, const char *) = file_step_hook;
    file_step_hook = NULL;
    CHECK(file_write(buf_text(&draft), "ours", 4, FILE_KEEP, NULL) == OK);
    CHECK(file_write(path, "theirs", 6, FILE_KEEP, NULL) == OK);
    file_step_hook = hook;
    CHECK(file_publish(buf_text(&draft), path, FILE_KEEP, &fault) == ERR_IO);
    CHECK_HAS(fault.text, strerror(EEXIST));
    CHECK(holds(path, "theirs"));
    CHECK_INT(count_names(folder, ""), 1);
    unlink(path);
}

STORY(files_are_published_by_what_a_file_system_has)
{
    static const enum file_step without[][2] = {{FILE_STEP_RENAME_NEW, FILE_STEP_RENAME_NEW},
                                                {FILE_STEP_RENAME_NEW, FILE_STEP_LINK}};
    static const int refusals[] = {EINVAL, ENOSYS, EOPNOTSUPP, EPERM};
    for (size_t n = 0; n < 8; n++) {
        memcpy(lacking, without[n / 4], sizeof lacking);
        refusal = refusals[n % 4];
        file_step_hook = lacks;
        publish_all();
        publish_late();
        file_step_hook = NULL;
    }
    publish_all();
    publish_late();
}

/* ---- what was left ---- */

static void make_draft(struct buf *draft)
{
    CHECK(file_draft(draft, file_in(folder, "c.txt"), FILE_KEEP, NULL) == OK);
    FILE *file = fopen(buf_text(draft), "we");
    if (CHECK(file != NULL))
        fclose(file);
}

/* The draft of a process that has ended. */
static void leave_draft(struct buf *draft)
{
    char name[FILE_LENGTH] = "";
    int ends[2];
    if (!CHECK(pipe(ends) == 0))
        return;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        make_draft(draft);
        _exit(write(ends[1], draft->data, draft->length + 1) < 0);
    }
    CHECK(waitpid(child, NULL, 0) == child && read(ends[0], name, sizeof name) > 0);
    close(ends[0]);
    close(ends[1]);
    buf_clear(draft);
    buf_add_text(draft, name);
}

STORY(drafts_of_processes_that_have_ended_go_and_others_stay)
{
    OWNED(buf_release) struct buf dead = {0}, live = {0}, strange = {0}, link = {0};
    leave_draft(&dead);
    make_draft(&live);
    CHECK(file_exists(buf_text(&dead)) && file_exists(buf_text(&live)));
    leave_draft(&strange); /* the name of one, but a link */
    CHECK(unlink(buf_text(&strange)) == 0 && symlink("c.txt", buf_text(&strange)) == 0);
    const char *const names[] = {".iftty-notes", ".iftty-1-0-c.txt", ".tmp-1-0-c.txt",
                                 ".iftty-00000zzzzz-1-1-0-c.txt"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        CHECK(file_write(file_in(folder, names[i]), "x", 1, FILE_KEEP, NULL) == OK);
    file_sweep(folder);
    CHECK(!file_exists(buf_text(&dead)));
    CHECK(file_exists(buf_text(&live)) && file_exists(buf_text(&strange)));
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        CHECK(unlink(file_in(folder, names[i])) == 0);
    unlink(buf_text(&live));
    unlink(buf_text(&strange));
    CHECK_INT(count_names(folder, ""), 0);
}

/* Runs in a process of its own, which ends without removing it. */
static void leave_folder(struct buf *path)
{
    struct buf within = {0};
    const bool fine = folder_temporary(path, folder, NULL) == OK;
    buf_printf(&within, "%s/deep", buf_text(path));
    const bool fits = fine && mkdir(buf_text(&within), 0700) == 0;
    buf_add_text(&within, "/a");
    _exit(fits && file_write(buf_text(&within), "x", 1, FILE_KEEP, NULL) == OK &&
                  symlink(file_in(folder, "kept.txt"), file_in(buf_text(path), "link")) == 0
              ? 0
              : 1);
}

STORY(folders_of_processes_that_have_ended_go_with_what_is_in_them)
{
    OWNED(buf_release) struct buf dead = {0}, live = {0}, fresh = {0};
    int status = -1;
    CHECK(file_write(file_in(folder, "kept.txt"), "x", 1, FILE_KEEP, NULL) == OK);
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0)
        leave_folder(&dead);
    CHECK(waitpid(child, &status, 0) == child && status == 0);
    CHECK(folder_temporary(&live, folder, NULL) == OK && folder_fresh(&fresh, folder, NULL) == OK);
    CHECK_INT(count_names(folder, ""), 4);
    file_sweep(folder);
    CHECK_INT(count_names(folder, ""), 3);
    CHECK(file_is_folder(buf_text(&live)) && file_is_folder(buf_text(&fresh)));
    CHECK(holds(file_in(folder, "kept.txt"), "x"));
    folder_remove(buf_text(&live));
    folder_remove(buf_text(&fresh));
    folder_remove(file_in(folder, "kept.txt"));
    CHECK_INT(count_names(folder, ""), 0);
}

/* The process ends as if it was killed. */
static void leave_held(void)
{
    struct buf path = {0};
    const bool fine = folder_held(&path, folder, NULL) == OK;
    _exit(fine && file_write(file_in(buf_text(&path), "a"), "x", 1, FILE_KEEP, NULL) == OK ? 0 : 1);
}

STORY(a_folder_that_is_held_goes_with_a_process_that_was_killed_and_stays_else)
{
    OWNED(buf_release) struct buf kept = {0}, empty = {0}, live = {0}, next = {0};
    int status = -1;
    CHECK(folder_held(&kept, folder, NULL) == OK);
    CHECK(file_write(file_in(buf_text(&kept), "a"), "x", 1, FILE_KEEP, NULL) == OK);
    CHECK(folder_release(buf_text(&kept)) && folder_held(&empty, folder, NULL) == OK);
    CHECK(!folder_release(buf_text(&empty)) && !file_exists(buf_text(&empty)));
    CHECK(folder_held(&live, folder, NULL) == OK);
    CHECK(mkdir(file_in(folder, "iftty-others"), 0700) == 0); /* it says nothing */
    CHECK(symlink(buf_text(&kept), file_in(folder, "iftty-link")) == 0);
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0)
        leave_held();
    CHECK(waitpid(child, &status, 0) == child && status == 0);
    CHECK_INT(count_names(folder, ""), 5);
    CHECK(folder_held(&next, folder, NULL) == OK);
    CHECK_INT(count_names(folder, ""),
              5); /* one more, and the one of the process that has ended gone */
    CHECK(holds(file_in(buf_text(&kept), "a"), "x") && file_is_folder(buf_text(&live)));
    CHECK(file_is_folder(file_in(folder, "iftty-others")));
    CHECK(!folder_release(buf_text(&live)) && !folder_release(buf_text(&next)));
    folder_remove(buf_text(&kept));
    folder_remove(file_in(folder, "iftty-others"));
    folder_remove(file_in(folder, "iftty-link"));
    CHECK_INT(count_names(folder, ""), 0);
}

/* Writing into a folder clears it; a loss of power leaves what another start of the machine did. */
STORY(drafts_of_a_former_start_go_and_those_of_another_machine_after_a_day)
{
    OWNED(buf_release) struct buf draft = {0};
    char former[FILE_LENGTH], other[FILE_LENGTH];
    make_draft(&draft);
    const size_t word = strlen(folder) + strlen("/.iftty-");
    strcpy(former, buf_text(&draft));
    strcpy(other, buf_text(&draft));
    former[word + 5] = former[word + 5] == '0' ? '1' : '0'; /* the start of the system */
    other[word] = other[word] == '0' ? '1' : '0';           /* the machine */
    CHECK(rename(buf_text(&draft), former) == 0);
    CHECK(file_write(other, "x", 1, FILE_KEEP, NULL) == OK);
    file_sweep(folder);
    CHECK(!file_exists(former) && file_exists(other));
    const struct timespec days_ago[2] = {{.tv_sec = 1000000000}, {.tv_sec = 1000000000}};
    CHECK(utimensat(AT_FDCWD, other, days_ago, 0) == 0);
    file_sweep(folder);
    CHECK(!file_exists(other));
    CHECK_INT(count_names(folder, ""), 0);
}

STORY(a_name_of_any_length_can_be_written)
{
    char name[256] = "", path[FOLDER_LENGTH + 256];
    while (strlen(name) < 250)
        strcat(name, "\xC3\xA4");
    strcat(name, ".txt");
    snprintf(path, sizeof path, "%s/%s", folder, name);
    CHECK(file_write(path, "x", 1, FILE_KEEP, NULL) == OK && holds(path, "x"));
}

STORY(the_word_of_a_process_says_whether_it_lives)
{
    OWNED(buf_release) struct buf word = {0};
    enum owner_state state;
    owner_write(&word);
    const char *at = buf_text(&word);
    CHECK(owner_read(&at, &state) && *at == '\0' && state == OWNER_LIVES);
    word.data[word.length - 1] ^= 1; /* another process had its number */
    at = buf_text(&word);
    CHECK(owner_read(&at, &state) && state == OWNER_IS_GONE);
    for (size_t length = 0; length < word.length - 1; length++) {
        OWNED(buf_release) struct buf part = {0};
        buf_add(&part, word.data, length);
        at = buf_text(&part);
        CHECK(owner_read(&at, &state) ? *at == '\0' : at == buf_text(&part));
    }
}
