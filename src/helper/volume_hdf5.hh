/* SPDX-License-Identifier: MIT */
/* HDF5 by its library: handles that close themselves, and attributes of data sets. */
#ifndef IMAGE_VOLUME_HDF5_HH
#define IMAGE_VOLUME_HDF5_HH

#include <cstdint>
#include <string>
#include <vector>

/* Later versions of HDF5 give other functions the same names. */
#define H5_USE_110_API
#include <hdf5.h>

namespace volume
{

struct Volume;

/* Closes its handle. */
class Handle
{
  public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close)
    {
    }
    ~Handle()
    {
        if (id_ >= 0)
            close_(id_);
    }
    Handle(const Handle &) = delete;
    Handle &operator=(const Handle &) = delete;
    operator hid_t() const
    {
        return id_;
    }

  private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

/* Text of an attribute; "" if it does not exist. */
std::string text_of(hid_t object, const std::string &name);

/* Dimensions of a data set, the slowest first, that are x, y and z; the others are of a series. */
struct Axes {
    static constexpr size_t none = SIZE_MAX;
    size_t dimension[3] = {none, none, none}; /* z may be missing */

    bool holds(size_t d) const;
    bool is_in_order() const; /* z, y, x */
};

/* Find the axes. Refuse ambiguous names. */
Axes axes_of(Volume &volume, hid_t set, const std::vector<hsize_t> &side);

/* Set the spacing by the attributes of the data set. */
void place_set(Volume &volume, hid_t set, const Axes &axes, size_t rank);

struct ImarisPlace {
    unsigned level = 0, time = 0, channel = 0;
};

/* Parse the name of an image of Imaris. */
bool read_imaris(ImarisPlace &place, const std::string &name);

/* Set size and spacing of an image of Imaris. */
void crop_imaris(Volume &volume, hid_t file, const std::string &name);

} // namespace volume

#endif
