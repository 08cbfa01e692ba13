// SPDX-License-Identifier: Apache-2.0
#include "program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "reflectree/error.hpp"

extern char** environ;

namespace reflectree::detail {
namespace {

static_assert(std::endian::native == std::endian::little, "the binary form is little-endian");

constexpr std::size_t longest_greeting = 1000;
constexpr std::size_t longest_number = 40;  // characters of a number in text, with its blank
constexpr const char* how_to_mend = "docs/doctor.md has the protocol, examples/doctor two clients";

using Clock = std::chrono::steady_clock;

}  // namespace

Program::Program(std::string command, const ProgramOptions& options)
    : command_(std::move(command)), options_(options) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    fail("no socket can be made", "close some programs");
  socket_ = ends[0];
  fcntl(socket_, F_SETFL, O_NONBLOCK);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  std::string shell = "sh", flag = "-c", text = command_;
  std::array<char*, 4> arguments{shell.data(), flag.data(), text.data(), nullptr};
  const int failed = posix_spawn(&child_, "/bin/sh", &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failed != 0) {
    child_ = 0;
    close(socket_);
    fail("the shell cannot be started", "close some programs");
  }
}

Program::~Program() {
  constexpr std::string_view quit = "quit\n";
  send(socket_, quit.data(), quit.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  close(socket_);
  // A second to leave by itself, then it is made to.
  for (int i = 0; i < 50 && child_ > 0; ++i) {
    if (waitpid(child_, nullptr, WNOHANG) != 0) child_ = 0;
    if (child_ > 0) usleep(20'000);
  }
  if (child_ > 0) {
    kill(-child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }
}

std::string Program::greeting() {
  what_ = "its greeting";
  start_clock();
  std::string nothing;
  std::size_t end = std::string::npos;
  while ((end = in_.find('\n')) == std::string::npos) {
    if (in_.size() > longest_greeting) break;
    exchange(nothing, longest_greeting + 1);
  }
  if (end == std::string::npos || end > longest_greeting) rubbish(in_);
  std::string line = in_.substr(0, end);
  in_.erase(0, end + 1);
  return line;
}

void Program::ask(const std::string& head, std::span<const double> input, std::size_t input_columns,
                  std::size_t rows, std::size_t columns, std::span<double> output) {
  const std::lock_guard<std::mutex> lock(mutex_);
  what_ = "the answer to '" + head + "'";
  start_clock();
  std::string out = head + "\n";
  if (binary_) {
    out.append(reinterpret_cast<const char*>(input.data()), input.size() * sizeof(double));
    const std::size_t wanted = rows * columns * sizeof(double);
    while (!out.empty() || in_.size() < wanted) exchange(out, wanted);
    if (in_.size() > wanted) fail(what_ + " is longer than what was asked for", how_to_mend);
    std::memcpy(output.data(), in_.data(), wanted);
    in_.clear();
    return;
  }
  std::array<char, 40> number{};
  for (std::size_t k = 0; k < input.size(); ++k) {
    std::snprintf(number.data(), number.size(), "%.9g", input[k]);
    out += number.data();
    out += (k + 1) % input_columns ? ' ' : '\n';
  }
  const std::size_t most = rows * columns * longest_number + longest_greeting;
  std::size_t place = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    std::size_t end = 0;
    while ((end = in_.find('\n', place)) == std::string::npos) exchange(out, most);
    read_row(std::string_view(in_).substr(place, end - place), row, output.subspan(row * columns, columns));
    place = end + 1;
  }
  while (!out.empty()) exchange(out, most);
  if (place != in_.size()) fail(what_ + " has more rows than were asked for", how_to_mend);
  in_.clear();
}

void Program::fail(const std::string& what, const std::string& how) const {
  throw Error(what, "program '" + command_ + "'", how);
}

void Program::rubbish(std::string_view text) const {
  fail(what_ + " is not understood: '" + std::string(text.substr(0, 60)) + "'", how_to_mend);
}

void Program::start_clock() {
  until_ = Clock::now() +
           std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.seconds));
}

// Writes some of `out`, reads some of what comes.
void Program::exchange(std::string& out, std::size_t most) {
  for (;;) {
    if (options_.cancelled()) throw Cancelled();
    if (Clock::now() > until_) {
      char seconds[32];
      std::snprintf(seconds, sizeof seconds, "%g", options_.seconds);
      fail(what_ + " did not come within " + seconds + " s",
           "give it more time with --timeout, or flush its output");
    }
    pollfd p{socket_, short(POLLIN | (out.empty() ? 0 : POLLOUT)), 0};
    if (poll(&p, 1, 100) <= 0) continue;
    if (p.revents & POLLIN || p.revents & POLLHUP) {
      std::array<char, 1 << 16> block;
      const ssize_t n = recv(socket_, block.data(), block.size(), 0);
      if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) died();
      if (n > 0) {
        in_.append(block.data(), std::size_t(n));
        if (in_.size() > most) fail(what_ + " is longer than what was asked for", how_to_mend);
        return;
      }
    }
    if (p.revents & POLLOUT) {
      const ssize_t n = send(socket_, out.data(), out.size(), MSG_NOSIGNAL);
      if (n < 0 && errno != EAGAIN && errno != EINTR) died();
      if (n > 0) {
        out.erase(0, std::size_t(n));
        return;
      }
    }
  }
}

void Program::died() {
  int status = 0;
  std::string end = "it closed its output";
  for (int i = 0; i < 50 && child_ > 0; ++i) {
    if (waitpid(child_, &status, WNOHANG) == child_) {
      child_ = 0;
      end = WIFEXITED(status) ? "it ended with exit code " + std::to_string(WEXITSTATUS(status))
                              : "signal " + std::to_string(WTERMSIG(status)) + " ended it";
    } else {
      usleep(20'000);
    }
  }
  fail(end + " before " + what_, "run it by itself, and see what it says");
}

void Program::read_row(std::string_view line, std::size_t row, std::span<double> out) const {
  const std::string text(line);
  const char* at = text.c_str();
  for (double& x : out) {
    char* end = nullptr;
    x = std::strtod(at, &end);
    if (end == at) wrong_row(text, row, out.size());
    at = end;
  }
  while (*at == ' ' || *at == '\t' || *at == '\r') ++at;
  if (*at != 0) wrong_row(text, row, out.size());
}

void Program::wrong_row(const std::string& text, std::size_t row, std::size_t columns) const {
  fail(what_ + ": row " + std::to_string(row) + " is not " + std::to_string(columns) + " numbers: '" +
           text.substr(0, 60) + "'",
       how_to_mend);
}

}  // namespace reflectree::detail
