/* What the parts that read HDF5 share. */
#ifndef IMAGE_VOLUME_HDF5_HH
#define IMAGE_VOLUME_HDF5_HH

#include <string>

#include <hdf5.h>

namespace volume
{

/* Closes what it holds. */
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

/* ---- data sets whose values lie elsewhere (volume_sources.cc) ---- */

/* How a data set is opened for its values, so that what it names is looked up in the folder of its
 * file, and nowhere before. The caller closes it. */
hid_t looking_beside();

/* Why the data set of the file at `path` cannot be read: what it names is not sound, or holds less
 * than is asked of it, for which the library has zeros; "" where it can. Nothing that a name leads
 * to is opened before the name is known to be sound. */
std::string wrong_with_sources(hid_t set, const std::string &path);

/* What to say of values that no source has, as far as that is known; "" for none. */
std::string note_of_sources(hid_t set);

/* The same of all data sets of the file, and of links to other files, for a library that goes its
 * own way through it. */
std::string wrong_with_any(hid_t file, const std::string &path);

} // namespace volume

#endif
