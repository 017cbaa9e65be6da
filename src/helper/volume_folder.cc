/* SPDX-License-Identifier: MIT */
/* Folders: find the files that are slices, and their kind. */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>

#include <dirent.h>
#include <sys/stat.h>

namespace volume
{

constexpr size_t files_most = 100000;
constexpr size_t depth_most = 6;

void add_file(Files &files, const std::string &path, bool follows_links)
{
    struct stat status;
    if (lstat(path.c_str(), &status) != 0)
        return;
    if (S_ISLNK(status.st_mode)) {
        if (!follows_links || stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) {
            files.links++;
            return;
        }
        char *real = realpath(path.c_str(), nullptr);
        files.targets.emplace_back(real ? real : "");
        std::free(real);
    }
    if (S_ISREG(status.st_mode))
        files.path.push_back(path);
}

void walk(Files &files, const std::string &folder, bool follows_links, size_t depth)
{
    std::vector<std::string> names;
    DIR *entries = opendir(folder.c_str());
    if (!entries)
        return;
    while (const struct dirent *entry = readdir(entries))
        if (entry->d_name[0] != '.')
            names.emplace_back(entry->d_name);
    closedir(entries);
    std::sort(names.begin(), names.end());
    for (const std::string &name : names) {
        const std::string path = folder + "/" + name;
        struct stat status;
        if (files.path.size() > files_most)
            refuse("the folder holds more than %zu files; give the one with the slices",
                   files_most);
        if (lstat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) {
            if (depth < depth_most)
                walk(files, path, follows_links, depth + 1);
        } else {
            add_file(files, path, follows_links);
        }
    }
}

/* Kind of a picture by its first bytes: "png", "tiff", "bmp" or "". */
std::string picture_kind(const std::string &path)
{
    char bytes[4] = {0};
    std::ifstream file(path, std::ios::binary);
    file.read(bytes, sizeof bytes);
    if (std::memcmp(bytes, "\x89PNG", 4) == 0)
        return "png";
    for (const char *mark : {"II*\0", "MM\0*", "II+\0", "MM\0+"})
        if (std::memcmp(bytes, mark, 4) == 0)
            return "tiff";
    return is_bmp(path) ? "bmp" : "";
}

/* Leave out the files named by skip=, relative to the folder; return their number. */
size_t skip_files(Files &files, const Request &request)
{
    const size_t before = files.path.size();
    std::set<std::string> names = {request.skip};
    const auto is_skipped = [&](const std::string &path) {
        return names.erase(path.substr(request.path.size() + 1)) > 0;
    };
    const auto take_out = [&]() {
        files.path.erase(std::remove_if(files.path.begin(), files.path.end(), is_skipped),
                         files.path.end());
    };
    if (request.skip.empty())
        return 0;
    take_out();
    if (!names.empty()) { /* no single name that contains a comma */
        names.clear();
        for (size_t from = 0, to; from <= request.skip.size(); from = to + 1) {
            to = std::min(request.skip.find(',', from), request.skip.size());
            names.insert(request.skip.substr(from, to - from));
        }
        take_out();
    }
    if (!names.empty())
        throw Refusal{"skip: there is no file " + names.begin()->substr(0, 200) +
                      " in the folder; expected the name of one, or NAME,NAME"};
    return before - files.path.size();
}

/* Test for DICOM's mark at byte 128. */
bool has_dicom_mark(const std::string &path)
{
    char mark[4] = {0};
    std::ifstream file(path, std::ios::binary);
    file.seekg(128);
    file.read(mark, sizeof mark);
    return std::memcmp(mark, "DICM", sizeof mark) == 0;
}

/* Add the slices of a file of the folder, if it is DICOM. A damaged file is refused by name; the
 * first one without pixels is described in `other`. */
bool scan_named(std::vector<Slice> &slices, std::string &other, const Request &request,
                const std::string &path)
{
    const std::string name = path.substr(request.path.size() + 1);
    const std::string words = about_file(name, "is damaged: fetch it again");
    const size_t before = slices.size();
    bool is_dicom = false;
    expect_end(words);
    try {
        is_dicom = scan(slices, path);
    } catch (const std::exception &) { /* any exception: headers need little memory */
        throw Refusal{words};
    }
    if (!is_dicom && has_dicom_mark(path))
        throw Refusal{words};
    std::string object;
    if (is_dicom && slices.size() == before && is_of_images(object, path))
        throw Refusal{about_file(name, "is an image without pixels: fetch it again")};
    if (other.empty() && !object.empty())
        other = "; " + shown(name) + " is " + object;
    for (size_t i = before; i < slices.size(); i++)
        slices[i].name = name;
    return is_dicom;
}

void open_folder(Volume &volume, const Request &request, const Files &all)
{
    Files files = all;
    std::vector<Slice> slices;
    std::map<std::string, std::vector<std::string>> pictures; /* by kind */
    std::string object;
    const size_t skipped = skip_files(files, request);
    size_t others = 0, without = 0;
    for (size_t i = 0; i < files.path.size(); i++) {
        const std::string &path = files.path[i];
        const size_t before = slices.size();
        if (i % 64 == 0)
            progress(i, files.path.size());
        if (scan_named(slices, object, request, path)) {
            without += slices.size() == before;
            continue;
        }
        const std::string kind = picture_kind(path);
        if (!kind.empty())
            pictures[kind].push_back(path);
        else
            others++;
    }
    expect_end("it is damaged: its reader failed");
    if (slices.empty() && pictures.empty())
        refuse(
            "the folder holds no slices of DICOM, TIFF, PNG or BMP (%s of other kinds, %s of DICOM "
            "without pixels, %s not followed)%s%s",
            plural_of(others, "file").c_str(), plural_of(without, "file").c_str(),
            plural_of(files.links, "link").c_str(),
            !files.links            ? ""
            : request.follows_links ? "; a link to a file that is not there, as of git-annex, is "
                                      "not followed: `git annex get` brings it"
                                    : "; in a replay no link of a folder is followed: `cp -rL` "
                                      "makes a folder without links, for --scene",
            object.c_str());
    std::string kind; /* the pictures to read; "" for none */
    if (!slices.empty()) {
        stack_slices(volume, slices, request);
    } else {
        /* The kind with the most pictures; of equal ones the last by name. */
        for (const auto &[each, path] : pictures)
            if (kind.empty() || path.size() >= pictures[kind].size())
                kind = each;
        stack_pictures(volume, pictures[kind], kind);
    }
    for (const auto &[other, path] : pictures)
        others += other == kind ? 0 : path.size();
    if (skipped)
        note(volume, "skip: " + plural_of(skipped, "file") + " left out");
    if (without)
        note(volume, plural_of(without, "file") + " of DICOM without pixels left out");
    if (others + files.links)
        note(volume, plural_of(others + files.links, "file") + " of other kinds left out");
}

} // namespace volume
