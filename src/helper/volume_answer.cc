/* SPDX-License-Identifier: MIT */
/* Answers of iftty-volume, and the end of reading. */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <signal.h>

#include "helper/wire.hh"

namespace volume
{

using namespace wire;

constexpr uint64_t side_most = 65534;
constexpr size_t notes_most = 1200;
constexpr size_t piece_most = 4 << 20;
constexpr size_t fault_most = 511;   /* the client's line */
constexpr size_t list_most = 200000; /* the client's */
constexpr size_t name_most = 80;     /* a file's name in a message */

static std::string words_from(const char *format, va_list arguments)
{
    char words[words_most];
    vsnprintf(words, sizeof words, format, arguments);
    return words;
}

void refuse(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const Refusal refusal = {words_from(format, arguments)};
    va_end(arguments);
    throw refusal;
}

void refuse_for(const std::string &wrong)
{
    if (!wrong.empty())
        throw Refusal{wrong};
}

std::string words_of(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const std::string words = words_from(format, arguments);
    va_end(arguments);
    return words;
}

std::string plural_of(size_t count, const char *noun)
{
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string printable(const std::string &text, size_t most)
{
    std::string safe = text.substr(0, most);
    for (char &c : safe)
        c = c < ' ' || c > '~' ? '?' : c;
    return safe;
}

std::string shown(const std::string &name)
{
    return name.empty() ? "a file without a name" : printable(name, name_most);
}

std::string in_small_letters(std::string text)
{
    for (char &c : text)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
}

/* The client prepends the path, with unsafe bytes escaped. */
size_t words_room(const Request &request)
{
    size_t path = 2;
    for (const char c : request.path)
        path += c >= ' ' && c <= '~' ? 1 : 4;
    return std::min(words_most, fault_most - std::min(fault_most, path));
}

std::string about_file(const std::string &name, const std::string &what)
{
    if (name.empty())
        return what.compare(0, 3, "is ") == 0 ? what.substr(3) : what;
    const bool is_long = name.size() > name_most;
    const std::string end = is_long ? "..." + name.substr(name.size() - name_most) : name;
    const char *quote = name.find(' ') == std::string::npos ? "" : "\"";
    return end + " " + what + "; skip=" + (is_long ? "NAME" : quote + name + quote) +
           " leaves it out";
}

/* ---- the answer if a library crashes ---- */

/* The answer in case a signal ends this process while it reads. It is prepared in advance, because
 * a handler may do little. Libraries end by failed assertions and bad accesses. */
char last_answer[2 * words_most];
size_t last_length;

void expect_end(const std::string &words)
{
    const std::string answer = "error " + std::to_string(words.size()) + "\n" + words;
    last_length = 0;
    std::memcpy(last_answer, answer.data(), std::min(answer.size(), sizeof last_answer));
    last_length = std::min(answer.size(), sizeof last_answer);
}

void end_by_signal(int)
{
    const char *at = last_answer;
    for (size_t left = last_length; left > 0;) {
        const ssize_t n = write(wire::fd, at, left);
        if (n <= 0)
            break;
        at += n;
        left -= static_cast<size_t>(n);
    }
    _exit(4);
}

/* On its own stack, because the other one may be full. */
void catch_signals()
{
    static char room[65536];
    stack_t stack = {};
    stack.ss_sp = room;
    stack.ss_size = sizeof room;
    sigaltstack(&stack, nullptr);
    struct sigaction action = {};
    action.sa_handler = end_by_signal;
    action.sa_flags = SA_ONSTACK;
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL})
        sigaction(signal, &action, nullptr);
}

/* ---- answers ---- */

void note(Volume &volume, const std::string &line)
{
    if (volume.notes.size() + line.size() + 1 <= notes_most)
        volume.notes += line + "\n";
}

void progress(uint64_t done, uint64_t total)
{
    transmit("progress " + std::to_string(done) + " " + std::to_string(total) + "\n");
}

void answer_list(const std::string &lines)
{
    const size_t length =
        lines.size() <= list_most ? lines.size() : lines.rfind('\n', list_most - 1) + 1;
    const std::string rest = length < lines.size() ? "and more\n" : "";
    transmit("list " + std::to_string(length + rest.size()) + "\n" + lines.substr(0, length) +
             rest);
}

void send_piece(const void *bytes, size_t length)
{
    const char *at = static_cast<const char *>(bytes);
    while (length > 0) {
        const size_t piece = std::min(length, piece_most);
        transmit("piece " + std::to_string(piece) + "\n");
        transmit(at, piece);
        at += piece;
        length -= piece;
    }
}

void answer(const Volume &volume, const Request &request)
{
    for (const uint64_t side : volume.size)
        if (side < 1 || side > side_most)
            refuse("it has %llu voxels along one side; expected 1 to %llu", wide(side),
                   wide(side_most));
    double number[14];
    std::memcpy(number, volume.to_mm, sizeof volume.to_mm);
    number[12] = volume.slope;
    number[13] = volume.intercept;
    if (volume.series)
        transmit("series " + std::to_string(volume.series) + "\n");
    if (volume.frame)
        transmit("frame " + std::to_string(volume.frame) + "\n");
    if (request.refers)
        transmit("references " + std::to_string(volume.references.size()) + "\n" +
                 volume.references);
    if (volume.is_segments)
        transmit("segments " + std::to_string(volume.overlaps) + " " +
                 std::to_string(volume.names.size()) + "\n" + volume.names);
    if (!volume.contents.empty())
        transmit("contents " + std::to_string(volume.contents.size()) + "\n" + volume.contents);
    std::string line = "volume";
    for (const uint64_t side : volume.size)
        line += " " + std::to_string(side);
    line += " " + std::to_string(volume.volumes) + " " + std::to_string(volume.known) + " " +
            std::to_string(volume.format.size()) + " " + std::to_string(volume.type.size()) + " " +
            std::to_string(volume.notes.size()) + "\n";
    transmit(line + volume.format + volume.type + volume.notes);
    transmit(number, sizeof number);
    if (receive_line() != "voxels")
        leave(2);
    if (request.volume >= volume.volumes)
        refuse("there is no such volume in it");
    volume.send();
}

size_t bytes_of(const std::string &type)
{
    return static_cast<size_t>(std::atoi(type.c_str() + type.find_first_of("0123456789"))) / 8;
}

size_t bytes_in(const Volume &volume, uint64_t volumes)
{
    uint64_t bytes = bytes_of(volume.type);
    for (const uint64_t n : {volume.size[0], volume.size[1], volume.size[2], volumes})
        if (__builtin_mul_overflow(bytes, n, &bytes))
            refuse("its voxels do not fit the memory of any machine");
    return static_cast<size_t>(bytes);
}

} // namespace volume
