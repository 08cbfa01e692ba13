// SPDX-License-Identifier: Apache-2.0
// A study as a program: --help, its options, and the shell's exit codes (2: bad input or usage).
#pragma once

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

namespace reflectree::study {

/** Parses and runs `body`, whose result is the exit code. Words go to stderr, tables to stdout. */
template <class Body>
int run_program(CLI::App& app, int argc, char** argv, Body body) {
  try {
    app.parse(argc, argv);
    return body();
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 2;
  }
}

}  // namespace reflectree::study
