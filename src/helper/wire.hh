/* SPDX-License-Identifier: MIT */
/*
 * The helpers' side of a co-process (coprocess.h): requests come on standard input, answers go to
 * standard output, which are one socket; a library may read and print there without harm once
 * wire_prepare has moved it away.
 *
 * The end of input, or a request that breaks the protocol, ends the program; the end of the client
 * kills it, whatever it is doing, so that nothing is read or written for nobody.
 *
 * Before the first byte of a file is decoded, `confine` takes everything else from the process, in
 * every use and for every client: whatever a hostile file makes of a library, it can
 *     (W1) reach the files that the request names, those that their headers name and, where only
 *          a library can tell these (HDF5), what lies below their folder; and no other;
 *     (W2) make the calls of confine.h alone: no network, no other program, no other process;
 *     (W3) hold so much memory (the client says how much), and take so much of the processor;
 *     (W4) see no environment, and no descriptor but the socket's.
 * Where the kernel has Landlock and seccomp (`iftty info` says so), the process ends rather than do
 * without.
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
    _exit(status); /* no destructors: plugins have been seen to hang in theirs */
}

/* All of it, by read or write. */
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

/* The next number of `line`, which begins at `at`; moves `at` past it and a blank. */
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

/* An answer "error": one line, of what fits the client's. */
inline void answer_error(std::string words)
{
    std::replace(words.begin(), words.end(), '\n', ' ');
    if (words.empty())
        words = "the library gives no reason";
    words.resize(std::min(words.size(), words_most));
    transmit("error " + std::to_string(words.size()) + "\n" + words);
}

/* The request "versions", which comes alone: the libraries of this helper, in a line. */
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

/* A client that ended before this was asked for has closed its end. */
inline void end_with_client()
{
    struct pollfd client = {fd, 0, 0};
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (poll(&client, 1, 0) > 0 && (client.revents & POLLHUP))
        leave(0);
}

/* Moves the socket away from standard input and output, and closes what was inherited besides; no
 * core, no more addresses than `most`, and no life after the client's. */
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
    std::vector<struct confine_place> places; /* what is not there is passed over */
    unsigned calls = 0;                       /* enum confine_calls */
    bool writes = false;
    rlim_t seconds = 0; /* of the processor's time */
};

/* The first three, for good. */
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
