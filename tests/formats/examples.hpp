// SPDX-License-Identifier: Apache-2.0
// Small files of each format of the table, from which tests and fuzzers start: made from formulas, or kept as
// REFLECTREE_EXAMPLES/KEY.* where KEY is the format's.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "reflectree/formats/file.hpp"
#include "synthetic.hpp"

namespace reflectree {

namespace synthetic {

// The header and a few entries of a MERL file, which is never small.
inline Bytes merl_start(std::uint32_t n_p) {
  Bytes bytes;
  for (const std::uint32_t n : {90U, 90U, n_p}) append_u32(bytes, n);
  for (const double v : {0.0, 1.0, -1.0, 1e300}) append_f64(bytes, v);
  return bytes;
}

}  // namespace synthetic

inline std::vector<Bytes> example_files(std::string_view key) {
  namespace fs = std::filesystem;
  std::vector<Bytes> files;
  if (key == "rgl") {
    synthetic::RglRecipe small;
    small.width = small.height = small.colours = small.nodes = 2;
    small.theta_o = {0.f, 1.5f};
    synthetic::RglWideRecipe turned, spectral;
    turned.width = turned.height = turned.colours = turned.nodes = 3;
    turned.phi_o = synthetic::azimuths(3, 4);
    spectral.width = spectral.height = spectral.colours = spectral.nodes = 2;
    spectral.phi_o = {0}, spectral.wavelengths = {400, 500, 600, 700};
    files = {synthetic::rgl_file(), synthetic::rgl_file(small), synthetic::rgl_wide_file(turned),
             synthetic::rgl_wide_file(spectral)};
  }
  if (key == "merl") files = {synthetic::merl_start(180), synthetic::merl_start(360)};
  if (key == "zemax") {
    synthetic::ZemaxRecipe flat, coloured;
    flat.symmetry = "PlaneSymmetrical";
    flat.rotation = {0}, flat.azimuth = {0, 90, 180};
    coloured.content = "XYZ";
    coloured.rotation = {0}, coloured.incidence = {30}, coloured.azimuth = {0, 180, 360};
    files = {synthetic::zemax_file(), synthetic::zemax_file(flat), synthetic::zemax_file(coloured)};
  }
  if (key == "klems") {
    synthetic::KlemsRecipe rows;
    rows.structure = "Rows", rows.wavelengths = {"Solar", "Visible"};
    files = {synthetic::klems_file(), synthetic::klems_file(rows)};
  }
  if (key == "table") {
    files = {synthetic::as_bytes(synthetic::neural_csv()), synthetic::as_bytes(synthetic::sgd_csv()),
             synthetic::as_bytes(synthetic::abc_csv())};
  }
  std::error_code none;
  std::vector<fs::path> kept;
  for (const auto& entry : fs::directory_iterator(REFLECTREE_EXAMPLES, none)) {
    if (entry.path().stem() == key) kept.push_back(entry.path());
  }
  std::sort(kept.begin(), kept.end());
  for (const fs::path& path : kept) files.push_back(read_file(path.string(), 1U << 20U));
  return files;
}

}  // namespace reflectree
