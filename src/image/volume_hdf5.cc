/* HDF5: data sets of other programs, by the library itself; those of ITK and MINC by ITK. */
#include "image/volume_hdf5.hh"
#include "image/volume_bytes.hh"
#include "image/volume_parts.hh"

#include <algorithm>
#include <map>
#include <memory>

namespace volume
{

struct DataSet {
    std::string name, type;
    std::vector<hsize_t> side;
    std::string wrong; /* why its values cannot be read */
};

struct Sets {
    std::vector<DataSet> list;
    const std::string &path;
};

std::string hdf_type(hid_t set)
{
    Handle type(H5Dget_type(set), H5Tclose);
    const size_t bits = 8 * H5Tget_size(type);
    const bool is_power = bits == 8 || bits == 16 || bits == 32 || bits == 64;
    if (H5Tget_class(type) == H5T_INTEGER && is_power)
        return (H5Tget_sign(type) == H5T_SGN_NONE ? "uint" : "int") + std::to_string(bits);
    if (H5Tget_class(type) == H5T_FLOAT && bits >= 16)
        return bits <= 32 ? "float32" : "float64";
    return "";
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

/* Where values lie elsewhere, the library may look there for the sides already. */
bool describe_set(DataSet &set, hid_t file, const char *name, const std::string &path)
{
    Handle id(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
    if (id < 0)
        return false;
    set.name = name;
    set.wrong = wrong_with_sources(id, path);
    if (!set.wrong.empty())
        return true;
    Handle space(H5Dget_space(id), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 3 || rank > 5)
        return false;
    set.type = hdf_type(id);
    set.side.resize(static_cast<size_t>(rank));
    H5Sget_simple_extent_dims(space, set.side.data(), nullptr);
    return !set.type.empty();
}

herr_t visit(hid_t file, const char *name, const H5O_info_t *info, void *list)
{
    auto &sets = *static_cast<Sets *>(list);
    DataSet set;
    if (info->type == H5O_TYPE_DATASET && describe_set(set, file, name, sets.path))
        sets.list.push_back(set);
    return sets.list.size() < 1000 ? 0 : 1;
}

/* "/t0/channel0 (400x512x512 uint16)", in letters that are safe to print. */
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

/* What ilastik and others note: micrometres along the axes, the slowest first. */
void place_set(Volume &volume, hid_t set)
{
    double um[3] = {0, 0, 0};
    if (H5Aexists(set, "element_size_um") <= 0)
        return;
    Handle attribute(H5Aopen(set, "element_size_um", H5P_DEFAULT), H5Aclose);
    Handle space(H5Aget_space(attribute), H5Sclose);
    if (H5Sget_simple_extent_npoints(space) != 3 || H5Aread(attribute, H5T_NATIVE_DOUBLE, um) < 0)
        return;
    for (int a = 0; a < 3; a++)
        volume.to_mm[a][a] = um[2 - a] / 1e3;
    if (um[0] > 0 && um[1] > 0 && um[2] > 0)
        volume.known = SPACING;
}

/* Slices of the last three dimensions, each of the others at one place. */
void send_set(const Volume &volume, hid_t set, size_t rank, std::vector<hsize_t> from)
{
    const size_t slice = bytes_in(volume, 1) / volume.size[2];
    const uint64_t most = std::max<uint64_t>(1, (size_t{64} << 20) / slice);
    std::vector<char> bytes(slice * std::min(most, volume.size[2]));
    for (uint64_t z = 0, n; z < volume.size[2]; z += n) {
        n = std::min(most, volume.size[2] - z);
        std::vector<hsize_t> count(rank, 1);
        from[rank - 3] = z;
        count[rank - 3] = n;
        count[rank - 2] = volume.size[1];
        count[rank - 1] = volume.size[0];
        Handle space(H5Dget_space(set), H5Sclose);
        H5Sselect_hyperslab(space, H5S_SELECT_SET, from.data(), nullptr, count.data(), nullptr);
        Handle memory(H5Screate_simple(static_cast<int>(rank), count.data(), nullptr), H5Sclose);
        if (H5Dread(set, hdf_memory_type(volume.type), memory, space, H5P_DEFAULT, bytes.data()) <
            0)
            refuse("the data set is damaged, or packed in a way that is not known here");
        send_piece(bytes.data(), n * slice);
    }
}

const DataSet &choose_set(const std::vector<DataSet> &sets, const std::string &wanted)
{
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

/* Pieces that were never written are the fill value of the data set, which is 0 mostly. */
void count_stored(Volume &volume, hid_t file, const std::string &name)
{
    Handle set(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
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
        refuse("the data set is damaged, or packed in a way that is not known here");
    for (int a = 0; a < rank; a++)
        pieces *= (side[a] + piece[a] - 1) / piece[a];
    if (stored < pieces)
        note(volume, words_of("%llu of the %llu pieces of the data set are not in the file: voxels "
                              "there have the value that fills it up",
                              wide(pieces - stored), wide(pieces)));
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
            count_stored(volume, *file,
                         group[1] == 'I' ? "/ITKImage/0/VoxelData" : "/minc-2.0/image/0/image");
            open_by_itk(volume, request, group[1] == 'I' ? "itk-hdf5" : "minc");
            return;
        }
    Sets sets = {{}, request.path};
    H5Ovisit(*file, H5_INDEX_NAME, H5_ITER_INC, visit, &sets);
    if (sets.list.empty()) /* it may all be elsewhere */
        refuse_for(wrong_with_any(*file, request.path));
    const DataSet chosen = choose_set(sets.list, request.data);
    refuse_for(chosen.wrong);
    const size_t rank = chosen.side.size();
    for (size_t a = 0; a < 3; a++)
        volume.size[a] = chosen.side[rank - 1 - a];
    for (size_t a = 0; a + 3 < rank; a++)
        volume.volumes *= chosen.side[a];
    if (volume.volumes < 1 || volume.volumes > number_most)
        refuse("the data set holds no volume, or more than a million");
    count_stored(volume, *file, chosen.name);
    volume.format = "HDF5";
    volume.type = chosen.type;
    std::vector<hsize_t> from(rank, 0);
    uint64_t rest = request.volume;
    for (size_t a = rank - 3; a-- > 0; rest /= chosen.side[a])
        from[a] = rest % chosen.side[a];
    Handle access(looking_beside(), H5Pclose);
    const std::shared_ptr<Handle> set =
        std::make_shared<Handle>(H5Dopen2(*file, chosen.name.c_str(), access), H5Dclose);
    place_set(volume, *set);
    const std::string from_none = note_of_sources(*set);
    if (!from_none.empty())
        note(volume, from_none);
    volume.send = [&volume, file, set, rank, from]() { send_set(volume, *set, rank, from); };
}

} // namespace volume
