/*
 * The helpers' side of a co-process (coprocess.h): requests come on standard input, answers go to
 * standard output, which are one socket; a library may read and print there without harm once
 * wire_prepare has moved it away.
 *
 * The end of input, or a request that breaks the protocol, ends the program.
 */
#ifndef IMAGE_WIRE_HH
#define IMAGE_WIRE_HH

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <string>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace wire
{

/* The sanitisers of addresses and of threads reserve terabytes, so no limit can be put on them; gcc
 * and clang say differently that one is there. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool limits_memory = false;
#elif defined(__has_feature)
constexpr bool limits_memory =
    !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer);
#else
constexpr bool limits_memory = true;
#endif

constexpr size_t line_most = 96;
constexpr size_t words_most = 390;

inline int fd = -1;

[[noreturn]] inline void leave(int status)
{
    _exit(status); /* no destructors: plugins have been seen to hang in theirs */
}

inline void receive(void *bytes, size_t length)
{
    auto *at = static_cast<char *>(bytes);
    while (length > 0) {
        const ssize_t n = read(fd, at, length);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            leave(0);
        at += n;
        length -= static_cast<size_t>(n);
    }
}

inline void transmit(const void *bytes, size_t length)
{
    auto *at = static_cast<const char *>(bytes);
    while (length > 0) {
        const ssize_t n = write(fd, at, length);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            leave(0);
        at += n;
        length -= static_cast<size_t>(n);
    }
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

/* Moves the socket away from standard input and output; no core, and no more memory than `most`. */
inline void prepare(rlim_t most)
{
    fd = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
    const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (fd < 0 || nowhere < 0 || dup2(nowhere, STDIN_FILENO) < 0 ||
        dup2(nowhere, STDOUT_FILENO) < 0)
        leave(3);
    const struct rlimit memory = {most, most}, core = {0, 0};
    if (limits_memory)
        setrlimit(RLIMIT_AS, &memory);
    setrlimit(RLIMIT_CORE, &core);
}

} // namespace wire

#endif
