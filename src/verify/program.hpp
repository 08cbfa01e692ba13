// SPDX-License-Identifier: Apache-2.0
// A child process that answers requests on a pipe, in text or in binary (docs/doctor.md has the protocol).
#pragma once

#include <sys/types.h>

#include <chrono>
#include <mutex>
#include <span>
#include <string>
#include <string_view>

#include "reflectree/verify/program_patient.hpp"

namespace reflectree::detail {

// The child with one socket as its stdin and stdout. Rubbish ends in an Error that names the request.
class Program {
 public:
  Program(std::string command, const ProgramOptions& options);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  // A line without its end.
  std::string greeting();

  void set_binary(bool binary) { binary_ = binary; }

  // `head` and the rows of `input` out, rows of `columns` numbers in.
  void ask(const std::string& head, std::span<const double> input, std::size_t input_columns,
           std::size_t rows, std::size_t columns, std::span<double> output);

  [[noreturn]] void fail(const std::string& what, const std::string& how) const;
  [[noreturn]] void rubbish(std::string_view text) const;

 private:
  void start_clock();
  void exchange(std::string& out, std::size_t most);
  [[noreturn]] void died();
  void read_row(std::string_view line, std::size_t row, std::span<double> out) const;
  [[noreturn]] void wrong_row(const std::string& text, std::size_t row, std::size_t columns) const;

  std::string command_, what_, in_;
  ProgramOptions options_;
  std::chrono::steady_clock::time_point until_;
  int socket_ = -1;
  pid_t child_ = 0;
  bool binary_ = false;
  std::mutex mutex_;
};

}  // namespace reflectree::detail
