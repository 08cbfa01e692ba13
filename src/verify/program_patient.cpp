// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/program_patient.hpp"

#include <cstdlib>
#include <memory>
#include <string_view>

#include "program.hpp"

namespace reflectree {
namespace {

using detail::Program;

// "reflectree-doctor 1 channels=3 eval=f ..."
Patient from_greeting(const std::string& line, Program& program) {
  Patient p;
  p.eval_kind = EvalKind::detect;
  p.value_kind = ValueKind::detect;
  p.concurrent = false;
  constexpr std::string_view head = "reflectree-doctor 1";
  if (!line.starts_with(head) || (line.size() > head.size() && line[head.size()] != ' '))
    program.rubbish(line);
  bool has_pdf = true;
  std::size_t at = head.size();
  while (at < line.size()) {
    const std::size_t from = line.find_first_not_of(" \r\t", at);
    if (from == std::string::npos) break;
    const std::size_t to = std::min(line.find_first_of(" \r\t", from), line.size());
    const std::string word = line.substr(from, to - from), key = word.substr(0, word.find('='));
    const std::string value = key.size() < word.size() ? word.substr(key.size() + 1) : "";
    at = to;
    const auto is = [&](const char* k, const char* v) { return key == k && value == v; };
    if (key == "name" && !value.empty()) {
      p.name = value;
    } else if (key == "channels") {
      char* end = nullptr;
      const long n = std::strtol(value.c_str(), &end, 10);
      if (value.empty() || *end != 0 || n < 1 || n > max_channels)
        program.fail("its greeting has no channels from 1 to 256: '" + word + "'", "write channels=3");
      p.channels = int(n);
    } else if (is("eval", "f")) {
      p.eval_kind = EvalKind::f;
    } else if (is("eval", "f_cos")) {
      p.eval_kind = EvalKind::f_cos;
    } else if (is("sample", "weight")) {
      p.value_kind = ValueKind::weight;
    } else if (is("sample", "f")) {
      p.value_kind = ValueKind::f;
    } else if (is("sample", "f_cos")) {
      p.value_kind = ValueKind::f_cos;
    } else if (is("sample", "none")) {
      p.value_kind = ValueKind::none;
    } else if (is("pdf", "no") || is("pdf", "yes")) {
      has_pdf = value == "yes";
    } else if (is("format", "text") || is("format", "binary")) {
      program.set_binary(value == "binary");
    } else if (!is("eval", "detect") && !is("sample", "detect")) {
      program.fail("its greeting says '" + word + "', which means nothing", "docs/doctor.md has the words");
    }
  }
  if (has_pdf) {
    p.pdf = [](std::span<const Direction>, std::span<const Direction>, std::span<double>) {};
  }
  return p;
}

std::vector<double> rows_of(std::span<const Direction> wo, std::span<const Direction> wi) {
  std::vector<double> rows;
  rows.reserve(wo.size() * 6);
  for (std::size_t i = 0; i < wo.size(); ++i) {
    rows.insert(rows.end(), {double(wo[i].x), double(wo[i].y), double(wo[i].z)});
    if (!wi.empty()) rows.insert(rows.end(), {double(wi[i].x), double(wi[i].y), double(wi[i].z)});
  }
  return rows;
}

}  // namespace

Patient program_patient(const std::string& command, const ProgramOptions& options) {
  const auto program = std::make_shared<Program>(command, options);
  Patient p = from_greeting(program->greeting(), *program);
  const auto channels = std::size_t(p.channels);
  p.eval = [program, channels](std::span<const Direction> wo, std::span<const Direction> wi,
                               std::span<double> out) {
    if (!wo.empty())
      program->ask("eval " + std::to_string(wo.size()), rows_of(wo, wi), 6, wo.size(), channels, out);
  };
  if (p.pdf) {
    p.pdf = [program](std::span<const Direction> wo, std::span<const Direction> wi, std::span<double> out) {
      if (!wo.empty())
        program->ask("pdf " + std::to_string(wo.size()), rows_of(wo, wi), 6, wo.size(), 1, out);
    };
  }
  // Without values there are four columns.
  const std::size_t values = p.value_kind == ValueKind::none ? 0 : channels;
  p.sample = [program, channels, values](std::span<const Direction> wo, std::uint64_t seed,
                                         std::span<PatientDraw> draws, std::span<double> out) {
    if (wo.empty()) return;
    std::vector<double> rows(wo.size() * (4 + values));
    program->ask("sample " + std::to_string(wo.size()) + " " + std::to_string(seed >> 1U), rows_of(wo, {}), 3,
                 wo.size(), 4 + values, rows);
    for (std::size_t i = 0; i < wo.size(); ++i) {
      const auto row = std::span(rows).subspan(i * (4 + values), 4 + values);
      draws[i] = {{float(row[0]), float(row[1]), float(row[2])},
                  row[3],
                  !(row[0] == 0 && row[1] == 0 && row[2] == 0)};
      for (std::size_t c = 0; c < channels; ++c) out[i * channels + c] = c < values ? row[4 + c] : 0;
    }
  };
  return p;
}

}  // namespace reflectree
