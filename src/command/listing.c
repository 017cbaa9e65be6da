#include "command/listing.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "base/safe.h"

static bool is_fit(const char *name, const char *begin)
{
    size_t n = 1;
    if (strncmp(name, begin, strlen(begin)) != 0 || (name[0] == '.' && begin[0] != '.') ||
        strcmp(name, ".") == 0 || strcmp(name, "..") == 0)
        return false;
    for (size_t left = strlen(name); left > 0 && n > 0; left -= n) {
        n = safe_character(name, left);
        name += n;
    }
    return n > 0;
}

/* Also through a link. */
static bool is_folder(int folder, const struct dirent *entry)
{
    struct stat status;
    if (entry->d_type != DT_LNK && entry->d_type != DT_UNKNOWN)
        return entry->d_type == DT_DIR;
    return fstatat(folder, entry->d_name, &status, 0) == 0 && S_ISDIR(status.st_mode);
}

static int compare(const void *a, const void *b)
{
    const char *const *x = a, *const *y = b;
    return strverscmp(*x, *y);
}

void listing_read(struct listing *listing, const char *folder, const char *begin)
{
    *listing = (struct listing){0};
    DIR *dir = opendir(folder);
    if (!dir)
        return;
    size_t count = 0;
    for (struct dirent *entry; count < LISTING_MOST && (entry = readdir(dir));) {
        if (!is_fit(entry->d_name, begin))
            continue;
        buf_add_text(&listing->store, entry->d_name);
        if (is_folder(dirfd(dir), entry))
            buf_add_char(&listing->store, '/');
        buf_add_char(&listing->store, '\0');
        count++;
    }
    closedir(dir);
    if (listing->store.failed || !(listing->name = mem_array(count, sizeof *listing->name)))
        return;
    const char *at = listing->store.data;
    for (; listing->count < count; at += strlen(at) + 1)
        listing->name[listing->count++] = at;
    qsort(listing->name, count, sizeof *listing->name, compare);
}

void listing_release(struct listing *listing)
{
    buf_release(&listing->store);
    free(listing->name);
    *listing = (struct listing){0};
}
