// SPDX-License-Identifier: Apache-2.0
// A study as a program: --help, its options, and the shell's exit codes (1: what the study demands does not
// hold; 2: bad input or usage; 3: an internal fault).
#pragma once

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "reflectree/error.hpp"

namespace reflectree::study {

/** Parses and runs `body`, whose result is the exit code. Words go to stderr, tables to stdout. */
template <class Body>
int run_program(CLI::App& app, int argc, char** argv, Body body) {
  try {
    app.parse(argc, argv);
    return body();
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const Error& e) {
    std::cerr << e.what() << '\n';
    return 2;
  } catch (const std::exception& e) {
    std::cerr << "internal fault: " << e.what() << '\n';
    return 3;
  }
}

}  // namespace reflectree::study
