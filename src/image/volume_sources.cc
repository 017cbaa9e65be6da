/* Names inside HDF5: the files that hold the values of a data set that is stored outside the file
 * or, being virtual, is made of others; and links that lead to other files. */
#include "image/volume_hdf5.hh"
#include "image/volume_parts.hh"

#include <set>
#include <vector>

#include <sys/stat.h>

namespace volume
{

constexpr size_t name_most = 4096;
constexpr size_t depth_most = 8;
constexpr size_t files_most = 200; /* the library holds each open, and has zeros for the others */

hid_t looking_beside()
{
    const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
    H5Pset_efile_prefix(access, "${ORIGIN}");
    H5Pset_virtual_prefix(access, "${ORIGIN}");
    return access;
}

/* ---- values in files of no format ---- */

std::string wrong_with_storage(hid_t made, const std::string &path, int files)
{
    for (int i = 0; i < files; i++) {
        char name[name_most] = {0};
        off_t offset = 0;
        hsize_t size = 0;
        struct stat status;
        if (H5Pget_external(made, static_cast<unsigned>(i), sizeof name - 1, name, &offset, &size) <
            0)
            return "the data set names files in a way that is not read here";
        const std::string wrong = wrong_with(path, name);
        if (!wrong.empty())
            return wrong;
        if (stat((folder_of(path) + name).c_str(), &status) != 0 || offset < 0 ||
            size == H5F_UNLIMITED || status.st_size < offset ||
            static_cast<hsize_t>(status.st_size - offset) < size)
            return words_of("cut short: %s, in which voxels of it are, holds less than it says",
                            shown(name).c_str());
    }
    return "";
}

/* ---- virtual data sets ---- */

struct Source {
    std::string file, set;
    std::vector<hsize_t> last; /* the last place that is taken of it; none: all of it, which is */
    hssize_t values = 0;       /* so many values */
};

/* False where it is of a kind that is not read. */
bool take_source(Source &source, hid_t made, size_t i)
{
    char name[name_most] = {0};
    const ssize_t file = H5Pget_virtual_filename(made, i, nullptr, 0),
                  set = H5Pget_virtual_dsetname(made, i, nullptr, 0);
    if (file < 1 || set < 1 || file >= ssize_t{name_most} || set >= ssize_t{name_most})
        return false;
    H5Pget_virtual_filename(made, i, name, sizeof name);
    source.file = name;
    H5Pget_virtual_dsetname(made, i, name, sizeof name);
    source.set = name;
    Handle from(H5Pget_virtual_srcspace(made, i), H5Sclose);
    Handle to(H5Pget_virtual_vspace(made, i), H5Sclose);
    source.values = H5Sget_select_npoints(to);
    if (source.values < 1 || source.file.find('%') != std::string::npos ||
        source.set.find('%') != std::string::npos)
        return false;
    if (H5Sget_select_type(from) == H5S_SEL_ALL)
        return true;
    const int rank = H5Sget_simple_extent_ndims(from);
    source.last.resize(static_cast<size_t>(rank < 1 ? 0 : rank));
    std::vector<hsize_t> first(source.last.size());
    return rank > 0 && H5Sget_select_npoints(from) == source.values &&
           H5Sget_select_bounds(from, first.data(), source.last.data()) >= 0;
}

herr_t follow_none(const char *, const char *, const char *, const char *, unsigned *, hid_t,
                   void *)
{
    return -1;
}

std::string wrong_inside(hid_t set, const std::string &path, size_t depth,
                         std::set<std::string> &files);

/* The source itself: it is there, is as large as what is taken of it, and is sound as well. */
std::string wrong_with_source(hid_t file, const std::string &path, const Source &source,
                              size_t depth, std::set<std::string> &files)
{
    const std::string name = source.file == "." ? path : source.file;
    Handle access(H5Pcreate(H5P_LINK_ACCESS), H5Pclose);
    H5Pset_elink_cb(access, follow_none, nullptr);
    Handle object(H5Oopen(file, source.set.c_str(), access), H5Oclose);
    if (object < 0 || H5Iget_type(object) != H5I_DATASET)
        return words_of("voxels of it are in the data set %s of %s, which is not there",
                        shown(source.set).c_str(), shown(name).c_str());
    const std::string wrong = wrong_inside(object, path, depth + 1, files);
    if (!wrong.empty())
        return wrong;
    Handle space(H5Dget_space(object), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space);
    std::vector<hsize_t> side(static_cast<size_t>(rank < 1 ? 0 : rank));
    H5Sget_simple_extent_dims(space, side.data(), nullptr);
    bool is_held = source.last.empty() ? H5Sget_simple_extent_npoints(space) == source.values
                                       : side.size() == source.last.size();
    for (size_t a = 0; is_held && a < source.last.size(); a++)
        is_held = source.last[a] < side[a];
    return is_held
               ? ""
               : words_of("the data set %s of %s, in which voxels of it are, is of another size "
                          "than it says",
                          shown(source.set).c_str(), shown(name).c_str());
}

std::string wrong_with_virtual(hid_t set, hid_t made, const std::string &path, size_t depth,
                               std::set<std::string> &files)
{
    size_t count = 0;
    H5Pget_virtual_count(made, &count);
    for (size_t i = 0; i < count; i++) {
        Source source;
        if (!take_source(source, made, i))
            return "it is made of data sets that are counted, or grow, which are not read";
        if (source.file == ".") {
            Handle own(H5Iget_file_id(set), H5Fclose);
            const std::string wrong = wrong_with_source(own, path, source, depth, files);
            if (!wrong.empty())
                return wrong;
            continue;
        }
        std::string wrong = wrong_with(path, source.file);
        const std::string at = folder_of(path) + source.file;
        if (!wrong.empty())
            return wrong;
        files.insert(at);
        if (files.size() > files_most)
            return words_of("it is made of more than %zu files, which are not read", files_most);
        Handle file(H5Fopen(at.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
        if (file < 0)
            return words_of("voxels of it are in %s, which is no HDF5 file, or is damaged",
                            shown(source.file).c_str());
        wrong = wrong_with_source(file, at, source, depth, files);
        if (!wrong.empty())
            return wrong;
    }
    return "";
}

/* ---- a data set, and all of them ---- */

std::string wrong_inside(hid_t set, const std::string &path, size_t depth,
                         std::set<std::string> &files)
{
    Handle made(H5Dget_create_plist(set), H5Pclose);
    const int external = H5Pget_external_count(made);
    if (depth > depth_most)
        return "it is made of data sets that are made of others, and so on, which are not read";
    if (external > 0 && depth > 0) /* whose names the library looks up elsewhere */
        return "a part of it is stored in a file of no format, which is not read";
    if (external > 0)
        return wrong_with_storage(made, path, external);
    return H5Pget_layout(made) == H5D_VIRTUAL ? wrong_with_virtual(set, made, path, depth, files)
                                              : "";
}

std::string wrong_with_sources(hid_t set, const std::string &path)
{
    std::set<std::string> files;
    return wrong_inside(set, path, 0, files);
}

std::string note_of_sources(hid_t set)
{
    Handle made(H5Dget_create_plist(set), H5Pclose);
    Handle whole(H5Dget_space(set), H5Sclose);
    size_t count = 0;
    hssize_t values = 0;
    if (H5Pget_layout(made) != H5D_VIRTUAL)
        return "";
    H5Pget_virtual_count(made, &count);
    for (size_t i = 0; i < count; i++) {
        Handle taken(H5Pget_virtual_vspace(made, i), H5Sclose);
        values += H5Sget_select_npoints(taken);
    }
    const hssize_t all = H5Sget_simple_extent_npoints(whole);
    return values >= all
               ? ""
               : words_of("%lld of the %lld values of the data set are in none of the "
                          "files that it is made of, and are what it gives for that",
                          static_cast<long long>(all - values), static_cast<long long>(all));
}

struct Search {
    const std::string &path;
    std::string wrong;
};

herr_t look_at_link(hid_t group, const char *name, const H5L_info_t *info, void *context)
{
    auto &search = *static_cast<Search *>(context);
    if (info->type == H5L_TYPE_HARD || info->type == H5L_TYPE_SOFT)
        return 0;
    std::vector<char> value(info->u.val_size + 1);
    const char *file = "", *object = "";
    unsigned flags;
    if (info->type == H5L_TYPE_EXTERNAL &&
        H5Lget_val(group, name, value.data(), info->u.val_size, H5P_DEFAULT) >= 0)
        H5Lunpack_elink_val(value.data(), info->u.val_size, &flags, &file, &object);
    search.wrong =
        words_of("a part of it is in another file, %s, which is not read", shown(file).c_str());
    return 1;
}

herr_t look_at_object(hid_t file, const char *name, const H5O_info_t *info, void *context)
{
    auto &search = *static_cast<Search *>(context);
    if (info->type != H5O_TYPE_DATASET)
        return 0;
    Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
    std::set<std::string> files;
    if (set >= 0)
        search.wrong = wrong_inside(set, search.path, 1, files);
    return search.wrong.empty() ? 0 : 1;
}

std::string wrong_with_any(hid_t file, const std::string &path)
{
    Search search = {path, ""};
    H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at_link, &search);
    if (search.wrong.empty())
        H5Ovisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at_object, &search);
    return search.wrong;
}

} // namespace volume
