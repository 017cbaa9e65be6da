/* SPDX-License-Identifier: MIT */
/*
 * iftty-register: register two scenes by ITK, for the program that started it.
 *
 * One request arrives on standard input with all voxels, and the answer leaves on standard output;
 * registration.h has the protocol byte for byte. It opens no file: before the first voxel arrives,
 * the process drops access to all files, and all calls except those for its own memory.
 */
#include <new>

#include <itkMultiThreaderBase.h>
#include <itkObject.h>
#include <itkVersion.h>

#include "helper/wire.hh"
#include "helper/register_parts.hh"

namespace
{

using namespace wire;
using namespace registering;

constexpr rlim_t working_s = 3600;
constexpr uint64_t voxels_most = 1 << 24; /* per scene */
constexpr uint64_t side_most = 65534;
constexpr uint64_t transform_most = 1 << 20;

/* With several threads, sums would depend on their order. */
void keep_to_one_thread()
{
    itk::MultiThreaderBase::SetGlobalDefaultThreader(
        itk::MultiThreaderBaseEnums::Threader::Platform);
    itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(1);
    itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
}

void answer_registration(const std::string &line, size_t at)
{
    Volume volume[2];
    for (Volume &one : volume) {
        uint64_t voxels = 1;
        for (uint32_t &side : one.size) {
            side = static_cast<uint32_t>(take_number(line, at, side_most));
            voxels *= side;
            if (voxels < 1 || voxels > voxels_most)
                leave(2);
        }
        one.voxels.resize(voxels);
    }
    for (Volume &one : volume) {
        receive(one.to_mm, sizeof one.to_mm);
        receive(one.voxels.data(), one.voxels.size() * sizeof one.voxels[0]);
    }
    const Found found = register_volumes(volume);
    transmit("found\n");
    transmit(&found, sizeof found);
}

void answer_transform(const std::string &line, size_t at)
{
    const TransformFile found = read_transform(receive_text(take_number(line, at, transform_most)));
    transmit("transform " + std::to_string(found.kind.size()) + "\n" + found.kind);
    transmit(found.map, sizeof found.map);
}

} // namespace

void registering::progress(unsigned done, unsigned total)
{
    transmit("progress " + std::to_string(done) + " " + std::to_string(total) + "\n");
}

int main()
{
    std::string words;
    prepare(RLIM_INFINITY);
    Needs needs;
    needs.seconds = working_s;
    confine(needs);
    keep_to_one_thread();
    itk::Object::SetGlobalWarningDisplay(false);
    try {
        const std::string line = receive_line();
        if (answer_versions(line, std::string("ITK ") + itk::Version::GetITKVersion()))
            leave(0);
        if (line.compare(0, 9, "register ") == 0)
            answer_registration(line, 9);
        else if (line.compare(0, 10, "transform ") == 0)
            answer_transform(line, 10);
        else
            leave(2);
        leave(0);
    } catch (const Refusal &refusal) {
        words = refusal.words;
    } catch (const std::bad_alloc &) {
        words = "it needs more memory than is allowed";
    } catch (const std::exception &) {
        words = "the library failed on it";
    }
    answer_error(words);
    leave(0);
}
