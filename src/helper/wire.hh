/* SPDX-License-Identifier: MIT */
/*
 * The helpers' side of a co-process (coprocess.h). Requests arrive on standard input and answers
 * leave on standard output, which are one socket; prepare() moves it to another descriptor, so that
 * libraries may read and print without harm.
 *
 * The program ends at the end of input, or after a request that breaks the protocol; it is killed
 * when its client ends.
 *
 * Before the first byte of a file is decoded, `confine` drops access to all other things, in every
 * use and for every client. A hostile file that compromises a library can then only
 *     (W1) reach the files that the request names, files that their headers name and, if only a
 *          library can tell these (HDF5), the files below their folder;
 *     (W2) make the calls of confine.h: no network, no other program, no other process;
 *     (W3) use a bounded amount of memory (set by the client) and of processor time;
 *     (W4) see no environment, and no descriptor except the socket.
 * If the kernel has Landlock and seccomp (`iftty info` shows it) and they fail, the process ends.
 */
#ifndef IMAGE_WIRE_HH
#define IMAGE_WIRE_HH

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <string>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

extern "C" {
#include "base/confine.h"
#include "base/mem.h"
}

namespace wire
{

constexpr size_t line_most = 96;
constexpr size_t words_most = 390;

inline int fd = -1;

[[noreturn]] inline void leave(int status)
{
    _exit(status); /* without destructors, because plugins may hang in theirs */
}

/* Read or write all bytes. */
template <typename Call, typename Bytes> void pass(Call call, Bytes *at, size_t length)
{
    while (length > 0) {
        const ssize_t n = call(fd, at, length);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            leave(0);
        at += n;
        length -= static_cast<size_t>(n);
    }
}

inline void receive(void *bytes, size_t length)
{
    pass(read, static_cast<char *>(bytes), length);
}

inline void transmit(const void *bytes, size_t length)
{
    pass(write, static_cast<const char *>(bytes), length);
}

inline void transmit(const std::string &text)
{
    transmit(text.data(), text.size());
}

inline std::string receive_line()
{
    std::string line;
    for (char c = 0;;) {
        receive(&c, 1);
        if (c == '\n')
            return line;
        line += c;
        if (line.size() > line_most)
            leave(2);
    }
}

inline std::string receive_text(uint64_t length)
{
    std::string text(length, '\0');
    receive(&text[0], length);
    return text;
}

/* Parse the next number of `line` from `at`; advance `at` past it and a blank. */
inline uint64_t take_number(const std::string &line, size_t &at, uint64_t most)
{
    uint64_t value = 0;
    const size_t from = at;
    for (; at < line.size() && line[at] >= '0' && line[at] <= '9'; at++) {
        value = 10 * value + static_cast<uint64_t>(line[at] - '0');
        if (value > most)
            leave(2);
    }
    if (at == from)
        leave(2);
    if (at < line.size() && line[at++] != ' ')
        leave(2);
    return value;
}

/* Send an error: one line, cut to the client's limit. */
inline void answer_error(std::string words)
{
    std::replace(words.begin(), words.end(), '\n', ' ');
    if (words.empty())
        words = "the library reports no reason";
    words.resize(std::min(words.size(), words_most));
    transmit("error " + std::to_string(words.size()) + "\n" + words);
}

/* Answer the request "versions", which comes alone: the libraries of this helper, in a line. */
inline bool answer_versions(const std::string &request, const std::string &words)
{
    if (request != "versions")
        return false;
    transmit("versions " + std::to_string(words.size()) + "\n" + words);
    return true;
}

inline void limit(int resource, rlim_t most)
{
    const struct rlimit both = {most, most};
    setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

/* A client that ended before PR_SET_PDEATHSIG has closed its end. */
inline void end_with_client()
{
    struct pollfd client = {fd, 0, 0};
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (poll(&client, 1, 0) > 0 && (client.revents & POLLHUP))
        leave(0);
}

/* Move the socket away from standard input and output, close inherited descriptors, disable core
 * dumps, limit the address space to `most`, and die with the client. */
inline void prepare(rlim_t most)
{
    constexpr int socket = 3;
    fd = dup3(STDIN_FILENO, socket, O_CLOEXEC);
    const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (fd < 0 || nowhere < 0 || dup2(nowhere, STDIN_FILENO) < 0 ||
        dup2(nowhere, STDOUT_FILENO) < 0)
        leave(3);
    end_with_client();
    close_range(socket + 1, ~0U, 0);
    if (MEM_MAY_BE_LIMITED)
        limit(RLIMIT_AS, most);
    limit(RLIMIT_CORE, 0);
}

struct Needs {
    std::vector<struct confine_place> places; /* missing files are skipped */
    unsigned calls = 0;                       /* enum confine_calls */
    bool writes = false;
    rlim_t seconds = 0; /* processor time */
};

/* Establish W1 to W3, permanently. */
inline void confine(const Needs &needs)
{
    constexpr rlim_t files_most = 256;
    limit(RLIMIT_NOFILE, files_most);
    limit(RLIMIT_CPU, needs.seconds);
    if (!needs.writes)
        limit(RLIMIT_FSIZE, 0);
    prctl(PR_SET_DUMPABLE, 0);
    if (confine_version() && !confine_to(needs.places.data(), needs.places.size()))
        leave(5);
    if (confine_knows_calls() && !confine_calls(needs.calls))
        leave(5);
}

} // namespace wire

#endif
