/* SPDX-License-Identifier: MIT */
/*
 * iftty-volume: reads volumes by ITK, GDCM, HDF5 and libtiff for the program that started it.
 *
 * One request for a file or folder arrives on standard input, and the volume leaves on standard
 * output; volume_helper.h has the protocol byte for byte. Before the first byte of a file is read,
 * the process drops access to everything but that file (or that folder, or the files that a header
 * names). If a decoder crashes, only this process ends.
 *
 *     volume_answer.cc   answers, and the end of reading
 *     volume_names.cc    headers in text: the files that they name, units and scales
 *     volume_itk.cc      the formats of ITK
 *     volume_pictures.cc slices as PNG and BMP
 *     volume_tiff.cc     TIFF, and folders of it; volume_tiff_stack.cc, slices and volumes of it
 *     volume_mrc.cc      MRC
 *     volume_bytes.cc    check that a file has the bytes that its header promises
 *     volume_hdf5.cc     data sets of HDF5, and the files that they name
 *     volume_dicom.cc    headers of DICOM, slices and mosaics, and pixels
 *     volume_seg.cc      segments of DICOM SEG
 *     volume_series.cc   the series of a folder, and the order of its slices
 *     volume_tags.cc     which images of one place are of one volume
 *     volume_folder.cc   folders of slices
 */
#include <cstdlib>
#include <new>
#include <set>
#include <string>
#include <vector>

#include <H5public.h>
#include <expat.h>
#include <gdcmTrace.h>
#include <gdcmVersion.h>
#include <itkObject.h>
#include <itkVersion.h>
#include <tiffio.h>
#include <zlib.h>

#include "helper/volume_parts.hh"
#include "helper/wire.hh"

namespace
{

using namespace wire;
using namespace volume;

constexpr uint64_t path_most = 4096;
constexpr rlim_t memory_most = RLIM_INFINITY; /* set by the client */
constexpr rlim_t reading_s = 3600;

/* ---- confinement ---- */

/* Restrict the process to the requested file. If a header names other files, they are allowed too;
 * their names are checked with access to the header's folder alone. Only HDF5's library knows the
 * files that an HDF5 file names: then the folder is allowed. */
void confine_to_request(Request &request, const Files &files)
{
    const std::string folder = folder_of(request.path);
    const struct confine_place own = {request.path.c_str(), CONFINE_READ};
    const bool is_header = request.kind == "nrrd" || request.kind == "meta";
    Needs needs;
    needs.places = {own, {folder.c_str(), CONFINE_READ}};
    if (is_header) {
        confine_to(needs.places.data(), needs.places.size());
        request.named = named_files(request);
    }
    const bool is_beside = request.kind == "hdf5";
    if (request.is_alone && (is_beside || !request.named.empty()))
        throw volume::Refusal{"its voxels may be in other files, or be a few of many"};
    if (!is_beside)
        needs.places = {own};
    for (const std::string &name : is_header ? request.named : files.targets)
        needs.places.push_back({name.c_str(), CONFINE_READ});
    needs.calls = CONFINE_OPEN;
    needs.seconds = reading_s;
    needs.writes = !request.room.empty();
    if (needs.writes) {
        needs.places.push_back({request.room.c_str(), CONFINE_WRITE});
        needs.calls |= CONFINE_CHANGE;
        setenv("TMPDIR", request.room.c_str(), 1);
    }
    confine(needs);
}

/* libtiff returns "LIBTIFF, Version 4.5.0" and a copyright, expat "expat_2.5.0". */
std::string versions()
{
    unsigned hdf5[3];
    H5get_libversion(&hdf5[0], &hdf5[1], &hdf5[2]);
    const std::string tiff = TIFFGetVersion(), expat = XML_ExpatVersion();
    const size_t number = tiff.find_first_of("0123456789");
    return std::string("ITK ") + itk::Version::GetITKVersion() + ", GDCM " +
           gdcm::Version::GetVersion() + ", HDF5 " + std::to_string(hdf5[0]) + "." +
           std::to_string(hdf5[1]) + "." + std::to_string(hdf5[2]) + ", libtiff " +
           tiff.substr(number, tiff.find('\n') - number) + ", expat " +
           expat.substr(expat.find('_') + 1) + ", zlib " + zlibVersion();
}

Request receive_request()
{
    Request request;
    const std::string line = receive_line();
    if (answer_versions(line, versions()))
        leave(0);
    const size_t kind = line.find(' ', 5);
    if (line.compare(0, 5, "open ") != 0 || kind == std::string::npos)
        leave(2);
    request.kind = line.substr(5, kind - 5);
    size_t at = kind + 1;
    const uint64_t flags = take_number(line, at, 127);
    request.follows_links = flags & 1;
    request.fills_gaps = flags & 2;
    request.lists = flags & 4;
    request.is_alone = flags & 8;
    request.chooses = flags & 16;
    request.refers = flags & 32;
    request.identifies = flags & 64;
    request.series = take_number(line, at, number_most);
    request.volume = take_number(line, at, UINT32_MAX);
    request.threshold = take_number(line, at, 1000);
    request.step_nm = take_number(line, at, UINT32_MAX);
    std::string *const text[] = {&request.wanted,   &request.skip, &request.data,
                                 &request.segments, &request.room, &request.path};
    for (std::string *each : text)
        each->resize(take_number(line, at, path_most));
    for (std::string *each : text)
        *each = receive_text(each->size());
    return request;
}

/* Libraries print to standard error, which is discarded; GDCM prints more than necessary. */
void serve()
{
    Volume volume;
    std::string words;
    expect_end("it is damaged: its reader failed");
    catch_signals();
    gdcm::Trace::SetWarning(false);
    gdcm::Trace::SetError(false);
    itk::Object::SetGlobalWarningDisplay(false);
    try {
        Files files;
        Request request = receive_request();
        if (request.kind == "folder")
            walk(files, request.path, request.follows_links, 0);
        confine_to_request(request, files);
        if (request.kind == "folder")
            open_folder(volume, request, files);
        else if (request.kind == "dicom")
            open_dicom(volume, request);
        else if (request.kind == "hdf5")
            open_hdf5(volume, request);
        else if (request.kind == "mrc")
            open_mrc(volume, request);
        else if (request.kind == "tiff")
            open_tiff(volume, request);
        else
            open_by_itk(volume, request, request.kind);
        answer(volume, request);
        return;
    } catch (const Refusal &refusal) {
        words = refusal.words;
    } catch (const std::bad_alloc &) {
        words = "it needs more memory than is allowed";
    } catch (const std::exception &) {
        words = "it is damaged, or of a kind that is not known here";
    }
    answer_error(words);
}

} // namespace

int main()
{
    prepare(memory_most);
    serve();
    leave(0);
}
