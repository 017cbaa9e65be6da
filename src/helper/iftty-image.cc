/* SPDX-License-Identifier: MIT */
/*
 * iftty-image: reads and writes images by OpenImageIO for the program that started it.
 *
 * Requests arrive on standard input and answers leave on standard output; image_helper.h has the
 * protocol byte for byte. The program ends at the end of input, or after a request that breaks the
 * protocol.
 *
 * This process reads requests and no byte of a picture. It forks for each request: the child, with
 * the library loaded, drops access to all files but the requested one (wire.hh), answers
 * (image_oiio.cc), and ends. So a hostile picture cannot affect later requests; if it crashes the
 * child, this process ends the same way.
 */
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

#include <OpenImageIO/imageio.h>

#include "helper/image_oiio.hh"
#include "helper/wire.hh"

namespace
{

using namespace wire;
using namespace image;

constexpr uint64_t path_most = 4096;
constexpr uint64_t delay_most = 60000;
constexpr rlim_t memory_most = rlim_t{8} << 30;
constexpr rlim_t reading_s = 300, writing_s = 3600;

/* ---- requests ---- */

/* OpenImageIO lists libraries as "openexr:OpenEXR 3.1.5;...", its own version as 20407. */
std::string versions()
{
    const int own = OIIO::openimageio_version();
    const std::string list = OIIO::get_string_attribute("library_list");
    const size_t exr = list.find("openexr:");
    return "OpenImageIO " + std::to_string(own / 10000) + "." + std::to_string(own / 100 % 100) +
           "." + std::to_string(own % 100) +
           (exr == std::string::npos ? ""
                                     : ", " + list.substr(exr + 8, list.find(';', exr) - exr - 8));
}

Request receive_request()
{
    Request request;
    const std::string line = receive_line();
    if (answer_versions(line, versions()))
        leave(0);
    size_t at = line.find(' ') + 1;
    const std::string kind = line.substr(0, at);
    if (kind != "write " && kind != "read " && kind != "about ")
        leave(2);
    request.kind = kind == "write "  ? Request::WRITE
                   : kind == "read " ? Request::READ
                                     : Request::ABOUT;
    const uint64_t length = take_number(line, at, path_most);
    if (request.kind == Request::WRITE) {
        request.width = take_number(line, at, side_most);
        request.height = take_number(line, at, side_most);
        request.notes = take_number(line, at, notes_most);
        request.frames = take_number(line, at, frames_most);
        request.delay_ms = take_number(line, at, delay_most);
        request.channels = take_number(line, at, 4);
        if (request.width == 0 || request.height == 0 || request.frames == 0 ||
            request.channels < 3)
            leave(2);
    }
    request.path = receive_text(length);
    return request;
}

/* ---- child process ---- */

/* A confined library may write an existing file but create none: create it here. */
void confine_to_file(Request &request)
{
    const bool writes = request.kind == Request::WRITE;
    if (writes) {
        const int file = open(request.path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
        if (file < 0)
            request.refusal = std::strerror(errno);
        else
            close(file);
    }
    Needs needs;
    needs.places = {{request.path.c_str(), writes ? CONFINE_WRITE : CONFINE_READ}};
    needs.calls = CONFINE_OPEN | CONFINE_THREADS;
    needs.writes = writes;
    needs.seconds = writes ? writing_s : reading_s;
    confine(needs);
}

[[noreturn]] void carry_out(Request &request)
{
    try {
        confine_to_file(request);
        if (request.kind == Request::WRITE)
            write_image(request);
        else
            read_image(request);
    } catch (const std::bad_alloc &) {
        leave(3); /* perhaps within a request: the client sees the status */
    } catch (const std::exception &error) {
        answer_error(error.what());
    }
    leave(0);
}

void serve()
{
    Request request = receive_request();
    const pid_t parent = getpid();
    const pid_t process = fork();
    if (process == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent)
            leave(3);
        carry_out(request);
    }
    int status = 0;
    while (process > 0 && waitpid(process, &status, 0) < 0 && errno == EINTR)
        ;
    if (process < 0)
        leave(3);
    if (WIFSIGNALED(status)) { /* end by the same signal */
        signal(WTERMSIG(status), SIG_DFL);
        raise(WTERMSIG(status));
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        leave(WIFEXITED(status) ? WEXITSTATUS(status) : 3);
}

/* Number of threads of this process; 1 if unknown. */
int count_threads()
{
    std::ifstream file("/proc/self/status");
    for (std::string line; std::getline(file, line);)
        if (line.compare(0, 8, "Threads:") == 0)
            return std::atoi(line.c_str() + 8);
    return 1;
}

/* Read everything that the library reads from other files. */
void prepare_library()
{
    const int before = count_threads();
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", 1);
    OIIO::attribute("limits:imagesize_MB", 4096);
    OIIO::attribute("limits:channels", 64);
    OIIO::get_string_attribute("format_list");
    /* The library starts and ends a thread without joining it. A process forked meanwhile may wait
     * forever for its locks. Earlier threads are idle. */
    constexpr int tries_most = 1000;
    for (int tries = 0; count_threads() > before && tries < tries_most; tries++)
        usleep(1000);
}

} // namespace

int main()
{
    prepare(memory_most);
    prepare_library();
    for (;;)
        serve();
}
