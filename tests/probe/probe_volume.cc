/* SPDX-License-Identifier: MIT */
/* iftty-volume with what a hostile volume would try in place of its readers. */
#include "helper/volume_parts.hh"
#include "tests/probe/attempts.hh"

namespace volume
{

void expect_end(const std::string &)
{
}

void catch_signals()
{
}

void answer(const Volume &, const Request &)
{
}

void walk(Files &, const std::string &, bool, size_t)
{
}

std::string folder_of(const std::string &path)
{
    return path.substr(0, path.find_last_of('/') + 1) + "./";
}

/* A header that names one file beside it. */
std::vector<std::string> named_files(const Request &request)
{
    if (request.path.find("beside") == std::string::npos)
        return {};
    return {folder_of(request.path) + "s.nii"};
}

static void probe(const Request &request)
{
    throw Refusal{"opening: " + attempts(request.path, false, false)};
}

void open_by_itk(Volume &, const Request &request, const std::string &)
{
    probe(request);
}

void open_hdf5(Volume &, const Request &request)
{
    probe(request);
}

void open_mrc(Volume &, const Request &request)
{
    probe(request);
}

void open_tiff(Volume &, const Request &request)
{
    probe(request);
}

void open_dicom(Volume &, const Request &request)
{
    probe(request);
}

void open_folder(Volume &, const Request &request, const Files &)
{
    probe(request);
}

} // namespace volume
