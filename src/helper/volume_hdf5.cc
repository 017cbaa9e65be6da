/* SPDX-License-Identifier: MIT */
/*
 * HDF5: data sets of other programs, by the library; those of ITK and MINC are left to ITK.
 *
 * Values of a data set may be stored outside the file; a virtual data set consists of other data
 * sets; links may lead to other files. The names of such files are checked before they are opened.
 */
#include "helper/volume_hdf5.hh"

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include <sys/stat.h>

#include "helper/volume_parts.hh"

namespace volume
{

constexpr size_t name_most = 4096;
constexpr size_t depth_most = 8;
constexpr size_t files_most =
    200; /* the library holds each open, and reads zeros from the others */

/* ---- values in raw files ---- */

void check_storage(hid_t made, const std::string &path, int files)
{
    for (int i = 0; i < files; i++) {
        char name[name_most] = {0};
        off_t offset = 0;
        hsize_t size = 0;
        struct stat status;
        if (H5Pget_external(made, static_cast<unsigned>(i), sizeof name - 1, name, &offset, &size) <
            0)
            refuse("the data set names files in a way that is not read here");
        refuse_for(wrong_with(path, name));
        if (stat((folder_of(path) + name).c_str(), &status) != 0 || offset < 0 ||
            size == H5F_UNLIMITED || status.st_size < offset ||
            static_cast<hsize_t>(status.st_size - offset) < size)
            refuse("cut short: %s, in which voxels of it are, holds less than it says",
                   shown(name).c_str());
    }
}

/* ---- virtual data sets ---- */

struct Source {
    std::string file, set;
    std::vector<hsize_t> last; /* last index that is used; empty: all of it */
    hssize_t values = 0;       /* number of values */
};

/* False for unsupported kinds. */
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

/* Refuse a data set of the file at `path` that cannot be read: a file that it names fails the
 * check, or holds less than is needed, for which the library would read zeros. No file is opened
 * before its name is checked. */
void check_inside(hid_t set, const std::string &path, size_t depth, std::set<std::string> &files);

/* Check a source: it exists, is large enough, and can be read as well. */
void check_source(hid_t file, const std::string &path, const Source &source, size_t depth,
                  std::set<std::string> &files)
{
    const std::string name = source.file == "." ? path : source.file;
    Handle access(H5Pcreate(H5P_LINK_ACCESS), H5Pclose);
    H5Pset_elink_cb(access, follow_none, nullptr);
    Handle object(H5Oopen(file, source.set.c_str(), access), H5Oclose);
    if (object < 0 || H5Iget_type(object) != H5I_DATASET)
        refuse("voxels of it are in the data set %s of %s, which is not there",
               shown(source.set).c_str(), shown(name).c_str());
    check_inside(object, path, depth + 1, files);
    Handle space(H5Dget_space(object), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space);
    std::vector<hsize_t> side(static_cast<size_t>(rank < 1 ? 0 : rank));
    H5Sget_simple_extent_dims(space, side.data(), nullptr);
    bool is_held = source.last.empty() ? H5Sget_simple_extent_npoints(space) == source.values
                                       : side.size() == source.last.size();
    for (size_t a = 0; is_held && a < source.last.size(); a++)
        is_held = source.last[a] < side[a];
    if (!is_held)
        refuse("the data set %s of %s, in which voxels of it are, is of another size than it says",
               shown(source.set).c_str(), shown(name).c_str());
}

void check_virtual(hid_t set, hid_t made, const std::string &path, size_t depth,
                   std::set<std::string> &files)
{
    size_t count = 0;
    H5Pget_virtual_count(made, &count);
    for (size_t i = 0; i < count; i++) {
        Source source;
        if (!take_source(source, made, i))
            refuse("it is made of data sets that are counted, or grow, which are not read");
        const bool is_own = source.file == ".";
        const std::string at = is_own ? path : folder_of(path) + source.file;
        if (!is_own) {
            refuse_for(wrong_with(path, source.file));
            files.insert(at);
        }
        if (files.size() > files_most)
            refuse("it is made of more than %zu files, which are not read", files_most);
        Handle file(is_own ? H5Iget_file_id(set) : H5Fopen(at.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                    H5Fclose);
        if (file < 0)
            refuse("voxels of it are in %s, which is no HDF5 file, or is damaged",
                   shown(source.file).c_str());
        check_source(file, at, source, depth, files);
    }
}

/* ---- all data sets ---- */

void check_inside(hid_t set, const std::string &path, size_t depth, std::set<std::string> &files)
{
    Handle made(H5Dget_create_plist(set), H5Pclose);
    const int external = H5Pget_external_count(made);
    if (depth > depth_most)
        refuse("it is made of data sets that are made of others, and so on, which are not read");
    if (external > 0 && depth > 0) /* the library resolves these names elsewhere */
        refuse("a part of it is stored in a file of no format, which is not read");
    if (external > 0)
        check_storage(made, path, external);
    else if (H5Pget_layout(made) == H5D_VIRTUAL)
        check_virtual(set, made, path, depth, files);
}

/* Return the words of a refusal, which must not leave a callback of the library; "" for none. */
std::string wrong_inside(hid_t set, const std::string &path, size_t depth)
{
    std::set<std::string> files;
    try {
        check_inside(set, path, depth, files);
    } catch (const Refusal &refusal) {
        return refusal.words;
    }
    return "";
}

/* Describe values without a source, if known; "" for none. */
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
                          "files that it is made of, and have its fill value",
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
    if (set >= 0)
        search.wrong = wrong_inside(set, search.path, 1);
    return search.wrong.empty() ? 0 : 1;
}

/* Check all data sets of the file, and links to other files, for a library that chooses its own
 * way. */
std::string wrong_with_any(hid_t file, const std::string &path)
{
    Search search = {path, ""};
    H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at_link, &search);
    if (search.wrong.empty())
        H5Ovisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, look_at_object, &search);
    return search.wrong;
}

/* ---- data sets ---- */

struct DataSet {
    std::string name, type;
    std::vector<hsize_t> side;
    std::string wrong; /* reason why its values cannot be read; "" if they can */
};

struct Sets {
    std::vector<DataSet> list;
    std::string other; /* type of the first set of three dimensions without numbers */
    const std::string &path;
};

/* Type of the voxels; for an enum, such as numpy's bool, that of its numbers. */
std::string hdf_type(hid_t set)
{
    Handle type(H5Dget_type(set), H5Tclose);
    Handle base(H5Tget_class(type) == H5T_ENUM ? H5Tget_super(type) : H5Tcopy(type), H5Tclose);
    const size_t bits = 8 * H5Tget_size(base);
    const bool is_power = bits == 8 || bits == 16 || bits == 32 || bits == 64;
    if (H5Tget_class(base) == H5T_INTEGER && is_power)
        return (H5Tget_sign(base) == H5T_SGN_NONE ? "uint" : "int") + std::to_string(bits);
    if (H5Tget_class(base) == H5T_FLOAT && bits >= 16)
        return bits <= 32 ? "float32" : "float64";
    return "";
}

/* Describe values of an unsupported type. */
std::string other_type(hid_t set)
{
    static const std::map<H5T_class_t, const char *> kinds = {
        {H5T_COMPOUND, "records, such as complex numbers or colours"},
        {H5T_OPAQUE, "opaque bytes"},
        {H5T_BITFIELD, "fields of bits"},
        {H5T_STRING, "texts"}};
    Handle type(H5Dget_type(set), H5Tclose);
    const auto kind = kinds.find(H5Tget_class(type));
    return kind == kinds.end() ? "of a type that is not read" : kind->second;
}

hid_t hdf_memory_type(const std::string &type)
{
    const std::map<std::string, hid_t> types = {
        {"uint8", H5T_NATIVE_UINT8},   {"int8", H5T_NATIVE_INT8},     {"uint16", H5T_NATIVE_UINT16},
        {"int16", H5T_NATIVE_INT16},   {"uint32", H5T_NATIVE_UINT32}, {"int32", H5T_NATIVE_INT32},
        {"uint64", H5T_NATIVE_UINT64}, {"int64", H5T_NATIVE_INT64},   {"float32", H5T_NATIVE_FLOAT},
        {"float64", H5T_NATIVE_DOUBLE}};
    return types.at(type);
}

/* The sides are read after the check, because the library may look in other files for them. */
bool describe_set(DataSet &set, hid_t file, const char *name, Sets &sets)
{
    Handle id(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
    if (id < 0)
        return false;
    set.name = name;
    set.wrong = wrong_inside(id, sets.path, 0);
    if (!set.wrong.empty())
        return true;
    Handle space(H5Dget_space(id), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 3 || rank > 5)
        return false;
    set.type = hdf_type(id);
    set.side.resize(static_cast<size_t>(rank));
    H5Sget_simple_extent_dims(space, set.side.data(), nullptr);
    if (set.type.empty())
        sets.other = other_type(id);
    return !set.type.empty();
}

herr_t visit(hid_t file, const char *name, const H5O_info_t *info, void *list)
{
    auto &sets = *static_cast<Sets *>(list);
    DataSet set;
    if (info->type == H5O_TYPE_DATASET && describe_set(set, file, name, sets))
        sets.list.push_back(set);
    return sets.list.size() < 1000 ? 0 : 1;
}

/* "/t0/channel0 (400x512x512 uint16)", safe to print. */
std::string listed(const std::vector<DataSet> &sets)
{
    std::string list;
    size_t count = 0;
    for (const DataSet &set : sets) {
        std::string name = "/" + printable(set.name, 60);
        if (!set.wrong.empty())
            name += " (in other files";
        for (size_t a = set.side.size(); a-- > 0;)
            name += (a + 1 == set.side.size() ? " (" : "x") + std::to_string(set.side[a]);
        if (count++ == 4)
            return list + words_of(", and %zu more", sets.size() - 4);
        list += (list.empty() ? "" : ", ") + name + (set.type.empty() ? "" : " ") + set.type + ")";
    }
    return list;
}

/* Send slices of z, whatever the order of dimensions. */
void send_set(const Volume &volume, hid_t set, const Axes &axes, std::vector<hsize_t> from)
{
    const size_t width = bytes_of(volume.type), rank = from.size();
    const size_t slice = bytes_in(volume, 1) / volume.size[2];
    const uint64_t most = std::max<uint64_t>(1, (size_t{64} << 20) / slice);
    std::vector<char> bytes(slice * std::min(most, volume.size[2])), ordered;
    for (uint64_t z = 0, n; z < volume.size[2]; z += n) {
        n = std::min(most, volume.size[2] - z);
        std::vector<hsize_t> count(rank, 1);
        for (size_t a = 0; a < 3; a++)
            if (axes.dimension[a] != Axes::none)
                count[axes.dimension[a]] = a == 2 ? n : volume.size[a];
        if (axes.dimension[2] != Axes::none)
            from[axes.dimension[2]] = z;
        Handle space(H5Dget_space(set), H5Sclose);
        H5Sselect_hyperslab(space, H5S_SELECT_SET, from.data(), nullptr, count.data(), nullptr);
        Handle memory(H5Screate_simple(static_cast<int>(rank), count.data(), nullptr), H5Sclose);
        if (H5Dread(set, hdf_memory_type(volume.type), memory, space, H5P_DEFAULT, bytes.data()) <
            0)
            refuse("the data set is damaged: its values cannot be read");
        if (axes.is_in_order()) {
            send_piece(bytes.data(), n * slice);
            continue;
        }
        size_t along[3] = {0, 0, 0}, step = width; /* bytes to the next x, y, z */
        for (size_t d = rank; d-- > 0; step *= count[d])
            for (size_t a = 0; a < 3; a++)
                if (axes.dimension[a] == d)
                    along[a] = step;
        ordered.resize(n * slice);
        char *to = ordered.data();
        for (uint64_t k = 0; k < n; k++)
            for (uint64_t y = 0; y < volume.size[1]; y++)
                for (uint64_t x = 0; x < volume.size[0]; x++, to += width)
                    std::memcpy(to, &bytes[k * along[2] + y * along[1] + x * along[0]], width);
        send_piece(ordered.data(), ordered.size());
    }
}

const DataSet &choose_set(const std::vector<DataSet> &sets, const std::string &other,
                          const std::string &wanted)
{
    if (sets.empty() && !other.empty())
        refuse("the values of its data set of three dimensions are %s; expected integers or floats",
               other.c_str());
    if (sets.empty())
        refuse("it holds no data set of three dimensions of integers or floats");
    if (wanted.empty() && sets.size() == 1)
        return sets[0];
    for (const DataSet &set : sets)
        if (set.name == wanted || "/" + set.name == wanted)
            return set;
    refuse("%s; choose one with data=NAME: %s",
           wanted.empty() ? words_of("it holds %zu data sets", sets.size()).c_str()
                          : "it has no such data set of three dimensions",
           listed(sets).c_str());
}

/* Chunks that were never written have the fill value of the data set, usually 0. */
void count_stored(Volume &volume, hid_t set)
{
    if (set < 0)
        return;
    Handle plan(H5Dget_create_plist(set), H5Pclose), space(H5Dget_space(set), H5Sclose);
    const H5D_layout_t layout = H5Pget_layout(plan);
    hsize_t side[H5S_MAX_RANK], piece[H5S_MAX_RANK], pieces = 1, stored = 0;
    if (layout != H5D_VIRTUAL && H5Dget_storage_size(set) == 0)
        refuse("nothing of the data set was written: it holds no voxel");
    if (layout != H5D_CHUNKED)
        return;
    const int rank = H5Sget_simple_extent_dims(space, side, nullptr);
    if (rank < 1 || H5Pget_chunk(plan, rank, piece) != rank ||
        H5Dget_num_chunks(set, space, &stored) < 0)
        refuse("the data set is damaged: it does not say which pieces it has");
    for (int a = 0; a < rank; a++)
        pieces *= (side[a] + piece[a] - 1) / piece[a];
    if (stored < pieces)
        note(volume, words_of("%llu of the %llu pieces of the data set are not in the file: voxels "
                              "there have the value that fills it up",
                              wide(pieces - stored), wide(pieces)));
}

/* Refuse missing filters by name, and suggest a program that unpacks them. */
void check_filters(hid_t set)
{
    static const std::map<H5Z_filter_t, const char *> names = {{H5Z_FILTER_SZIP, "szip"},
                                                               {307, "bzip2"},
                                                               {32000, "lzf"},
                                                               {32001, "blosc"},
                                                               {32004, "lz4"},
                                                               {32008, "bitshuffle"},
                                                               {32013, "zfp"},
                                                               {32015, "zstd"},
                                                               {32017, "sz"},
                                                               {32026, "blosc2"}};
    Handle made(H5Dget_create_plist(set), H5Pclose);
    for (int i = 0; i < H5Pget_nfilters(made); i++) {
        unsigned flags, info;
        size_t values = 0;
        const H5Z_filter_t filter = H5Pget_filter2(made, static_cast<unsigned>(i), &flags, &values,
                                                   nullptr, 0, nullptr, &info);
        if (filter < 0 || H5Zfilter_avail(filter) > 0)
            continue;
        const auto name = names.find(filter);
        refuse("its voxels are packed by %s, which is not read; `h5repack -f GZIP=4 FILE OUT`, "
               "where HDF5 has the plugin of that filter, packs them by gzip",
               name == names.end() ? words_of("filter %d", filter).c_str() : name->second);
    }
}

/* Check properties that ITK's readers of MINC and of its own HDF5 ignore or misread. */
void check_for_itk(hid_t file, bool is_minc)
{
    const std::string dimensions = "/minc-2.0/dimensions/";
    for (const char *axis : {"xspace", "yspace", "zspace"})
        if (is_minc && H5Lexists(file, (dimensions + axis).c_str(), H5P_DEFAULT) > 0) {
            Handle of(H5Oopen(file, (dimensions + axis).c_str(), H5P_DEFAULT), H5Oclose);
            check_minc_unit(text_of(of, "units"));
        }
    Handle set(is_minc ? -1 : H5Dopen2(file, "/ITKImage/0/VoxelData", H5P_DEFAULT), H5Dclose);
    Handle type(set < 0 ? -1 : H5Dget_type(set), H5Tclose);
    if (type >= 0 && H5Tget_size(type) > 1 && H5Tget_order(type) == H5T_ORDER_BE)
        refuse("its voxels are big-endian, which is not read of HDF5 of ITK: write it again on a "
               "machine that is little-endian, or as a NRRD");
}

/* Images of Imaris in full resolution, by time and channel; empty if they differ or do not exist.
 */
std::vector<DataSet> images_of_imaris(const std::vector<DataSet> &sets)
{
    std::map<std::pair<unsigned, unsigned>, DataSet> images;
    for (const DataSet &set : sets) {
        ImarisPlace place;
        if (!read_imaris(place, set.name) || place.level > 0)
            continue;
        images[{place.time, place.channel}] = set;
        const DataSet &first = images.begin()->second;
        if (!set.wrong.empty() || set.side != first.side || set.type != first.type)
            return {};
    }
    std::vector<DataSet> list;
    for (const auto &image : images)
        list.push_back(image.second);
    return list;
}

void open_hdf5(Volume &volume, const Request &request)
{
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    count_parts("hdf5", request.path, "");
    const hid_t id = H5Fopen(request.path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (id < 0)
        refuse("its first bytes are of an HDF5 file, and the rest of it is damaged");
    const std::shared_ptr<Handle> file = std::make_shared<Handle>(id, H5Fclose);
    for (const char *group : {"/ITKImage", "/minc-2.0"})
        if (H5Lexists(*file, group, H5P_DEFAULT) > 0) {
            refuse_for(wrong_with_any(*file, request.path));
            const char *name =
                group[1] == 'I' ? "/ITKImage/0/VoxelData" : "/minc-2.0/image/0/image";
            count_stored(volume, Handle(H5Dopen2(*file, name, H5P_DEFAULT), H5Dclose));
            check_for_itk(*file, group[1] == 'm');
            open_by_itk(volume, request, group[1] == 'I' ? "itk-hdf5" : "minc");
            return;
        }
    Sets sets = {{}, "", request.path};
    H5Ovisit(*file, H5_INDEX_NAME, H5_ITER_INC, visit, &sets);
    if (sets.list.empty()) /* all of it may be in other files */
        refuse_for(wrong_with_any(*file, request.path));
    const std::vector<DataSet> images =
        request.data.empty() ? images_of_imaris(sets.list) : std::vector<DataSet>();
    const DataSet chosen = images.empty()
                               ? choose_set(sets.list, sets.other, request.data)
                               : images[std::min<size_t>(request.volume, images.size() - 1)];
    refuse_for(chosen.wrong);
    Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_efile_prefix(access, "${ORIGIN}");   /* look up named files only in the folder */
    H5Pset_virtual_prefix(access, "${ORIGIN}"); /* this file's folder */
    const std::shared_ptr<Handle> set =
        std::make_shared<Handle>(H5Dopen2(*file, chosen.name.c_str(), access), H5Dclose);
    const size_t rank = chosen.side.size();
    const Axes axes = axes_of(volume, *set, chosen.side);
    std::vector<hsize_t> from(rank, 0);
    uint64_t rest = images.empty() ? request.volume : 0;
    for (size_t a = 0; a < 3; a++)
        volume.size[a] = axes.dimension[a] == Axes::none ? 1 : chosen.side[axes.dimension[a]];
    for (size_t d = rank; d-- > 0;) {
        if (axes.holds(d) || chosen.side[d] < 1)
            continue;
        from[d] = rest % chosen.side[d];
        rest /= chosen.side[d];
    }
    for (size_t d = 0; d < rank; d++)
        if (!axes.holds(d) &&
            __builtin_mul_overflow(volume.volumes, chosen.side[d], &volume.volumes))
            volume.volumes = number_most + 1;
    if (!images.empty())
        volume.volumes = images.size();
    if (volume.volumes < 1 || volume.volumes > number_most)
        refuse("the data set holds no volume, or more than a million");
    check_filters(*set);
    count_stored(volume, *set);
    volume.format = "HDF5";
    volume.type = chosen.type;
    ImarisPlace place;
    if (read_imaris(place, chosen.name))
        crop_imaris(volume, *file, chosen.name);
    else
        place_set(volume, *set, axes, rank);
    const std::string from_none = note_of_sources(*set);
    if (!from_none.empty())
        note(volume, from_none);
    volume.send = [&volume, file, set, axes, from]() { send_set(volume, *set, axes, from); };
}

} // namespace volume
