/* SPDX-License-Identifier: MIT */
/* Power loss: a model of a disk that keeps what was synced and, of all else, whatever it likes.
 *
 * A real journal is written below a folder. Before each step of the file layer the model takes the
 * power away in many ways: every block written since the last sync of its file is there, or is what
 * it was, or is zeros; the file has any length between the former and the present one; a name that
 * was made, replaced or moved since the last sync of its folder is what it is now or what it was
 * before. What is left is written to a second folder and opened: it holds every record that was
 * acknowledged, in their order, and at most the one in the making; and the bytes of a torn tail
 * that was being mended are in the journal or beside it.
 *
 * Blocks are the sectors of a disk; records are made long by comments, so that they have several.
 */
#include <errno.h>
#include <pthread.h>

#include "tests/folder.h"
#include "tests/interpreting.h"
#include "tests/journals.h"

enum { BLOCK = 512, FILES_MOST = 64, TRIALS = 40 };

static char folder[FOLDER_LENGTH],
    after[FOLDER_LENGTH + 8]; /* where things are written; what a loss of power leaves */

/* What the disk is known to hold. Contents go with the inode, names with the folder. */
struct synced_file {
    ino_t inode;
    struct buf bytes;
};
struct synced_name {
    char name[256]; /* "j.golden" or "j.golden/a.exr" */
    ino_t inode;
    bool is_folder;
};
static struct synced_file on_disk[FILES_MOST];
static struct synced_name names[FILES_MOST];
static unsigned files_on_disk, names_on_disk;

static uint64_t dice;
static size_t acknowledged; /* records */
static const char *torn;    /* bytes that are to be in one file or the other, or NULL */
static size_t torn_length;
static const char *opened; /* the journal that is looked at after a loss */
static unsigned losses, losses_of_bytes;

static struct buf *synced_bytes(ino_t inode)
{
    for (unsigned i = 0; i < files_on_disk; i++)
        if (on_disk[i].inode == inode)
            return &on_disk[i].bytes;
    if (files_on_disk == FILES_MOST)
        abort();
    on_disk[files_on_disk] = (struct synced_file){.inode = inode};
    return &on_disk[files_on_disk++].bytes;
}

static void forget_everything(void)
{
    for (unsigned i = 0; i < files_on_disk; i++)
        buf_release(&on_disk[i].bytes);
    files_on_disk = names_on_disk = 0;
}

static void read_all(struct buf *out, const char *path)
{
    OWNED(stream_release) FILE *file = fopen(path, "re"); /* not by the layer under test */
    buf_clear(out);
    for (int c; file && (c = getc(file)) != EOF;)
        buf_add_char(out, (char)c);
}

static unsigned list_names(struct synced_name out[FILES_MOST], unsigned count, const char *below)
{
    OWNED(listing_release) DIR *listing = opendir(file_in(folder, below));
    for (struct dirent *entry; listing && (entry = readdir(listing));) {
        struct synced_name *name = &out[count];
        struct stat status;
        if (count == FILES_MOST)
            abort();
        if (*entry->d_name == '.')
            continue; /* drafts are nobody's before they are published */
        const int length = snprintf(name->name, sizeof name->name, "%s%s", below, entry->d_name);
        if (length >= (int)sizeof name->name || stat(file_in(folder, name->name), &status) != 0)
            continue;
        name->inode = status.st_ino;
        name->is_folder = S_ISDIR(status.st_mode);
        count++;
        char inside[sizeof name->name + 1];
        snprintf(inside, sizeof inside, "%s/", name->name);
        if (name->is_folder)
            count = list_names(out, count, inside);
    }
    return count;
}

/* The files of the folder as they are now, whatever the disk holds; folders before what is in
 * them. */
static unsigned present_names(struct synced_name out[FILES_MOST])
{
    return list_names(out, 0, "");
}

/* The folder of a name: its first so many bytes. */
static size_t folder_part(const char *name)
{
    const char *slash = strrchr(name, '/');
    return slash ? (size_t)(slash - name) + 1 : 0;
}

/* The names in the folder that holds `path` are on the disk; those of other folders are as they
 * were. */
static void sync_names(const char *path)
{
    struct synced_name now[FILES_MOST];
    const char *name = path + strlen(folder) + 1;
    const size_t part = folder_part(name);
    const unsigned count = present_names(now);
    unsigned kept = 0;
    for (unsigned i = 0; i < names_on_disk; i++)
        if (folder_part(names[i].name) != part || strncmp(names[i].name, name, part) != 0)
            names[kept++] = names[i];
    for (unsigned i = 0; i < count; i++)
        if (folder_part(now[i].name) == part && strncmp(now[i].name, name, part) == 0) {
            if (kept == FILES_MOST)
                abort();
            names[kept++] = now[i];
        }
    names_on_disk = kept;
}

/* ---- what a loss of power leaves ---- */

static bool coin(void)
{
    return check_below(&dice, 2);
}

/* A length between what is synced and what is written; often one of the two. */
static size_t surviving_length(size_t synced, size_t written)
{
    const size_t low = synced < written ? synced : written, high = synced + written - low;
    if (coin())
        return coin() ? low : high;
    return low + check_below(&dice, (uint32_t)(high - low) + 1);
}

/* What was written since the last sync, append by append: the system may have sent a block to the
 * disk after any of them. */
static struct buf version[FILES_MOST];
static unsigned versions;

static void survive(struct buf *out, const struct buf *synced, const struct buf *written)
{
    const size_t length = surviving_length(synced->length, written->length);
    buf_clear(out);
    for (size_t at = 0; at < length; at += BLOCK) {
        const unsigned which = check_below(&dice, versions + 2);
        const struct buf *from = which == 0 ? written : which == 1 ? synced : version + which - 2;
        for (size_t i = at; i < length && i < at + BLOCK; i++)
            buf_add_char(out, i < from->length ? from->data[i] : '\0');
    }
    losses_of_bytes += out->length != written->length ||
                       (out->length && memcmp(out->data, written->data, out->length) != 0);
}

/* Find a name, or with NULL the first name of an inode, in one of the lists; NULL for none. */
static const struct synced_name *find(const struct synced_name *list, unsigned count,
                                      const char *name, ino_t inode)
{
    for (unsigned i = 0; i < count; i++)
        if (name ? strcmp(list[i].name, name) == 0 : list[i].inode == inode)
            return &list[i];
    return NULL;
}

static ino_t inode_of(const struct synced_name *list, unsigned count, const char *name)
{
    const struct synced_name *found = find(list, count, name, 0);
    return found ? found->inode : 0;
}

/* The folder that a path is in may be lost itself. */
static bool has_folder(const char *path)
{
    char above[512];
    snprintf(above, sizeof above, "%.*s", (int)folder_part(path), path);
    return file_is_folder(above);
}

/* One name after the loss: what it leads to now, or what the folder on the disk says. */
static void leave(const char *name, const struct synced_name *now, unsigned count)
{
    OWNED(buf_release) struct buf written = {0}, left = {0};
    const char *path = file_in(after, name);
    const ino_t is = inode_of(now, count, name), was = inode_of(names, names_on_disk, name);
    const ino_t inode = is == was || coin() ? is : was;
    unlink(path);
    if (inode == 0 || !has_folder(path))
        return;
    const struct synced_name *present = find(now, count, NULL, inode);
    if (present && present->is_folder) {
        mkdir(path, 0700);
        return;
    }
    if (present) {
        read_all(&written, file_in(folder, present->name));
        survive(&left, synced_bytes(inode), &written);
    } else {
        buf_add(&left, synced_bytes(inode)->data, synced_bytes(inode)->length);
    }
    FILE *file = fopen(path, "we");
    if (CHECK(file != NULL)) {
        fwrite(left.data ? left.data : "", 1, left.length, file);
        fclose(file);
    }
}

/* Record n is a seed, an edit, or a turn of the view, whose sync waits. */
static bool is_view[64];

static void command_of(size_t n, char out[64])
{
    snprintf(out, 64, is_view[n] ? "turn %zu" : "seed %zu,2,3 1", n);
}

static enum err count_record(void *context, const struct record *record, struct fault *why)
{
    char command[64];
    size_t *count = context;
    (void)why;
    command_of(++*count, command);
    CHECK_TEXT(record->command, command);
    return OK;
}

/* Open the journal that a loss left, and count its records. */
static enum err open_left(struct journal **journal, size_t *count, struct fault *why)
{
    const struct journal_resume how = {.semantics = 1, .on_record = count_record, .context = count};
    *count = 0;
    return journal_open(journal, file_in(after, opened), &how, NULL, why);
}

/* The torn bytes, or those of them that the loss left in the journal, are beside it. */
static bool is_kept(const char *name)
{
    OWNED(buf_release) struct buf bytes = {0};
    read_all(&bytes, file_in(after, name));
    return bytes.length == torn_length && memcmp(bytes.data, torn, torn_length) == 0;
}

static void open_acknowledged(void)
{
    struct journal *journal;
    struct fault why = {.text = ""};
    size_t count;
    losses++;
    if (!file_exists(file_in(after, opened))) {
        CHECK_INT(acknowledged, 0);
        return;
    }
    if (CHECK(open_left(&journal, &count, &why) == OK)) {
        CHECK((count == acknowledged || count == acknowledged + 1) && journal_audit(journal));
        journal_close(journal);
    } else {
        printf("#   %zu acknowledged: %s\n", acknowledged, why.text);
    }
    if (torn)
        CHECK(is_kept("j.iftty.torn-1") || is_kept("j.iftty.torn-2"));
}

static void clear(const char *where)
{
    OWNED(listing_release) DIR *listing = opendir(where);
    for (struct dirent *entry; listing && (entry = readdir(listing));) {
        char path[PATH_MAX];
        snprintf(path, sizeof path, "%s/%s", where, entry->d_name);
        if (unlink(path) != 0 && *entry->d_name != '.') {
            clear(path);
            rmdir(path);
        }
    }
}

/* Lose the power in many ways, and open what each leaves. */
static void lose(unsigned trials, void (*open_what_is_left)(void))
{
    struct synced_name now[FILES_MOST];
    const unsigned count = present_names(now);
    int (*hook)(enum file_step step, const char *path) = file_step_hook;
    file_step_hook = NULL;
    for (unsigned trial = 0; trial < trials; trial++) {
        clear(after);
        for (unsigned i = 0; i < count; i++)
            leave(now[i].name, now, count);
        for (unsigned i = 0; i < names_on_disk; i++)
            if (inode_of(now, count, names[i].name) == 0)
                leave(names[i].name, now, count);
        open_what_is_left();
    }
    file_step_hook = hook;
}

static void lose_power(void)
{
    lose(TRIALS, open_acknowledged);
}

/* ---- the disk ---- */

static void sync_file(const char *path)
{
    struct stat status;
    if (stat(path, &status) == 0)
        read_all(synced_bytes(status.st_ino), path);
}

static void sync_all(const char *path)
{
    sync_file(path);
    names_on_disk = present_names(names);
}

static int sync_step(enum file_step step, const char *path)
{
    if (step == FILE_STEP_SYNC)
        sync_file(path);
    if (step == FILE_STEP_SYNC_FOLDER)
        sync_names(path);
    return 0;
}

/* Called before each step: the power may go here; else a sync is carried out. */
static int watch_step(enum file_step step, const char *path)
{
    lose_power();
    return sync_step(step, path);
}

static void append_long(struct journal *journal, size_t n)
{
    char command[64], words[128], comment[1200] = "";
    const size_t width = 1 + n * 397 % (sizeof comment - 1);
    memset(comment, '.', width);
    comment[0] = '#';
    comment[width] = '\0';
    CHECK(journal_comment(journal, comment, NULL) == OK);
    CHECK(journal_comment(journal, comment, NULL) == OK);
    snprintf(command, sizeof command, "seed %zu,2,3 1", n);
    snprintf(words, sizeof words, "forest=%016zx labels=%016zx seeds=%zu", n * 77, n * 78, n);
    if (CHECK(journal_append(journal, command, words, NULL) == OK))
        acknowledged = n;
}

static const char *begin(uint64_t seed)
{
    static char path[FILE_LENGTH];
    forget_everything();
    clear(folder);
    dice = seed;
    acknowledged = 0;
    torn = NULL;
    opened = "j.iftty";
    losses = losses_of_bytes = 0;
    memset(is_view, 0, sizeof is_view);
    return strcpy(path, file_in(folder, "j.iftty"));
}

STORY(a_loss_of_power_takes_nothing_that_was_acknowledged)
{
    for (uint64_t seed = 1; seed <= 3; seed++) {
        OWNED(journal_drop) struct journal *journal = NULL;
        const char *path = begin(seed);
        file_step_hook = watch_step;
        CHECK(journal_create(&journal, path, 1, NULL) == OK);
        for (size_t n = 1; n <= 6; n++)
            append_long(journal, n);
        lose_power();
        file_step_hook = NULL;
        CHECK(losses > 20 * TRIALS / 2);
        CHECK(losses_of_bytes > 100); /* it did take something */
    }
}

static int folder_cannot_be_synced(enum file_step step, const char *path)
{
    (void)path;
    return step == FILE_STEP_SYNC_FOLDER ? EIO : 0;
}

/* Whoever made the file may have died before its name was on the disk. */
STORY(a_journal_that_was_only_begun_gets_its_name_synced)
{
    struct journal *journal;
    const struct journal_resume how = {.semantics = 1};
    const char *path = begin(4);
    fclose(fopen(path, "we"));
    file_step_hook = watch_step;
    CHECK(journal_open(&journal, path, &how, NULL, NULL) == OK);
    append_long(journal, 1);
    append_long(journal, 2);
    file_step_hook = NULL;
    journal_close(journal);
    begin(5);
    fclose(fopen(path, "we"));
    file_step_hook = folder_cannot_be_synced;
    CHECK(journal_open(&journal, path, &how, NULL, NULL) == ERR_IO);
    file_step_hook = NULL;
}

STORY(a_loss_of_power_while_a_torn_tail_is_mended)
{
    static const char tail[] = "# a comment of the record that was torn\nseed 4,2,3 1\n= 4 fo";
    for (uint64_t seed = 11; seed <= 13; seed++) {
        struct journal *journal;
        const struct journal_resume how = {.semantics = 1};
        const char *path = begin(seed);
        CHECK(journal_create(&journal, path, 1, NULL) == OK);
        for (size_t n = 1; n <= 3; n++)
            append_long(journal, n);
        journal_close(journal);
        FILE *file = fopen(path, "ae");
        fputs(tail, file);
        fclose(file);
        sync_all(path);
        torn = tail;
        torn_length = strlen(tail);
        file_step_hook = watch_step;
        CHECK(journal_open(&journal, path, &how, NULL, NULL) == OK);
        append_long(journal, 4);
        file_step_hook = NULL;
        journal_close(journal);
        CHECK(losses_of_bytes > 20);
    }
}

STORY(a_loss_of_power_while_the_journal_goes_on_elsewhere)
{
    OWNED(journal_drop) struct journal *journal = NULL;
    char other[FILE_LENGTH];
    const char *path = begin(21);
    strcpy(other, file_in(folder, "other.iftty"));
    CHECK(journal_create(&journal, path, 1, NULL) == OK);
    for (size_t n = 1; n <= 3; n++)
        append_long(journal, n);
    sync_all(path);
    file_step_hook = watch_step; /* the former file is what is opened after each loss */
    CHECK(journal_continue(journal, other, NULL) == OK);
    opened = "other.iftty";
    lose_power();
    append_long(journal, 4);
    lose_power();
    file_step_hook = NULL;
    CHECK(journal_audit(journal));
}

/* What is not synced may be lost, and what a disk wrote in another order may be damaged; what was
 * synced is there, and a repair keeps it. */
static void open_or_repair(size_t synced)
{
    OWNED(journal_drop) struct journal *journal = NULL;
    OWNED(buf_release) struct buf told = {0};
    size_t count;
    enum err err = open_left(&journal, &count, NULL);
    if (err == ERR_INPUT) {
        CHECK(journal_repair(file_in(after, opened), 1, &told, NULL) == OK);
        err = open_left(&journal, &count, NULL);
    }
    CHECK(err == OK && count >= synced);
}

STORY(without_syncs_what_was_synced_last_is_there)
{
    static const enum file_sync sync[] = {FILE_SYNC_OFF, FILE_SYNC_EVERY_SECOND};
    for (size_t s = 0; s < 2; s++) {
        OWNED(journal_drop) struct journal *journal = NULL;
        struct synced_name now[FILES_MOST];
        const char *path = begin(31 + s);
        CHECK(journal_create(&journal, path, 1, NULL) == OK);
        append_long(journal, 1);
        append_long(journal, 2);
        CHECK(journal_set_sync(journal, sync[s], NULL) == OK);
        sync_all(path);
        for (size_t n = 3; n <= 12; n++)
            append_long(journal, n);
        const unsigned count = present_names(now);
        for (unsigned trial = 0; trial < 10 * TRIALS; trial++) {
            clear(after);
            leave("j.iftty", now, count);
            open_or_repair(2);
        }
        CHECK(losses_of_bytes > 100 && journal_sync(journal, NULL) == OK && journal_audit(journal));
    }
}

/* ---- views ---- */

static size_t written, edits_acknowledged;

/* Records from the first on, with every edit that was acknowledged; opened without a question. */
static void open_views(void)
{
    struct journal *journal;
    size_t records;
    struct fault why = {.text = ""};
    if (CHECK(open_left(&journal, &records, &why) == OK)) {
        CHECK(records >= edits_acknowledged && records <= written + 1);
        journal_close(journal);
    } else {
        printf("#   %zu records, %zu to be kept: %s\n", written, edits_acknowledged, why.text);
    }
}

/* Of the appends of edits alone: a thread syncs views at its own time, which takes nothing. */
static pthread_t teller;
static int watch_edit(enum file_step step, const char *path)
{
    if (!pthread_equal(pthread_self(), teller))
        return 0;
    lose(4 * TRIALS, open_views);
    if (step != FILE_STEP_SYNC)
        return 0;
    sync_file(path);
    while (versions > 0)
        buf_release(version + --versions);
    return 0;
}

static void write_record(struct journal *journal, size_t n)
{
    char command[64], words[64];
    is_view[n] = check_below(&dice, 4) > 0;
    command_of(n, command);
    snprintf(words, sizeof words, "forest=%016zx seeds=%zu", n * 77, n);
    if (!is_view[n]) {
        file_step_hook = watch_edit;
        CHECK(journal_append(journal, command, words, NULL) == OK);
        file_step_hook = NULL;
        edits_acknowledged = n;
    } else {
        CHECK(journal_append(journal, command, NULL, NULL) == OK);
    }
    written = n;
    lose(4 * TRIALS, open_views);
    if (is_view[n] && versions < FILES_MOST)
        read_all(version + versions++, file_in(folder, "j.iftty"));
}

STORY(a_loss_of_power_takes_views_of_the_last_second_and_no_edit)
{
    teller = pthread_self();
    for (uint64_t seed = 41; seed < 41 + check_scaled(2); seed++) {
        struct journal *journal;
        const char *path = begin(seed);
        written = edits_acknowledged = 0;
        CHECK(journal_create(&journal, path, 1, NULL) == OK);
        sync_all(path);
        for (size_t n = 1; n < 60; n++)
            write_record(journal, n);
        CHECK(losses_of_bytes > 1000);
        journal_close(journal);
        while (versions > 0)
            buf_release(version + --versions);
    }
}

/* ---- golden images ---- */

static struct interpreter session;

/* Every golden image of a record is there, with its PNG, as it was written. */
static enum err expect_golden(void *context, const struct record *record, struct fault *why)
{
    static const char *const kind[] = {"exr", "png"};
    size_t *count = context;
    (void)why;
    ++*count;
    for (int k = 0; k < 2 && strncmp(record->command, "golden ", 7) == 0; k++) {
        OWNED(buf_release) struct buf left = {0}, wanted = {0};
        char name[64];
        snprintf(name, sizeof name, "j.golden/%.1s.%s", record->command + 7, kind[k]);
        read_all(&left, file_in(after, name));
        read_all(&wanted, file_in(folder, name));
        CHECK(wanted.length && left.length == wanted.length &&
              memcmp(left.data, wanted.data, left.length) == 0);
    }
    return OK;
}

static void open_goldens(void)
{
    struct journal *journal;
    size_t records = 0;
    const struct journal_resume how = {
        .semantics = SEMANTICS, .on_record = expect_golden, .context = &records};
    losses++;
    if (CHECK(journal_open(&journal, file_in(after, "j.iftty"), &how, NULL, NULL) == OK)) {
        CHECK(records >= acknowledged);
        journal_close(journal);
    }
}

static int watch_golden(enum file_step step, const char *path)
{
    if (!pthread_equal(pthread_self(), teller))
        return 0;
    lose(TRIALS / 4, open_goldens);
    return sync_step(step, path);
}

STORY(a_record_of_a_golden_image_has_its_image_through_any_loss_of_power)
{
    const char *commands = "open synth:geom:16x16x16; size 16 16; seed 8,8,8 1 radius=2; "
                           "seed 1,1,1 0; golden a; turn 30; golden b of=axial; golden c";
    OWNED(buf_release) struct buf command = {0};
    const char *path = begin(51);
    teller = pthread_self();
    begin_interpreter(&session);
    CHECK(interpreter_create_journal(&session, path, NULL) == OK);
    while (next_line(&command, &commands)) {
        const bool is_golden = strncmp(command.data, "golden", 6) == 0;
        file_step_hook = is_golden ? watch_golden : NULL;
        must(&session, command.data);
        file_step_hook = NULL;
        if (is_golden) {
            acknowledged = session.history.records;
            lose(TRIALS / 4, open_goldens);
            continue;
        }
        CHECK(journal_sync(session.journal, NULL) == OK);
        acknowledged = session.history.records;
        sync_file(path);
        sync_names(path);
    }
    CHECK(losses > 300 && losses_of_bytes > 20);
    interpreter_release(&session);
    reply_release(&reply);
}

int main(void)
{
    if (!make_folder(folder, "power"))
        return 1;
    snprintf(after, sizeof after, "%s.after", folder);
    if (mkdir(after, 0700) != 0)
        return 1;
    int status = check_run();
    forget_everything();
    clear(folder);
    clear(after);
    rmdir(folder);
    rmdir(after);
    return status;
}
