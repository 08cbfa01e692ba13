// SPDX-License-Identifier: Apache-2.0
// A program in any language as a patient: it answers requests on its standard input and output.
// docs/doctor.md describes the protocol.
#pragma once

#include "reflectree/verify/patient.hpp"

namespace reflectree {

struct ProgramOptions {
  double seconds = 60;  // that an answer may take
  std::function<bool()> cancelled = [] { return false; };
};

// Starts `command` by the shell and reads its greeting. The program is ended with the last copy of the
// patient. Throws Error where it does not start, dies, is late or answers something else than was asked; so
// do the patient's functions. Throws Cancelled.
Patient program_patient(const std::string& command, const ProgramOptions& options = {});

}  // namespace reflectree
