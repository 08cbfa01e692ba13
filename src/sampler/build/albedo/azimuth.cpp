// SPDX-License-Identifier: Apache-2.0
#include "azimuth.hpp"

#include <algorithm>
#include <map>

#include "pieces.hpp"
#include "series.hpp"

namespace reflectree::detail {

AlbedoTable albedo_over_azimuth(ViewerSymmetry symmetry, const std::vector<float>& borders,
                                const std::vector<float>& bends, bool leaps_at_ends, float relative_error,
                                const RowAt& row_at, const std::function<double(const AlbedoTable&)>& miss_of,
                                const std::function<bool()>& spent) {
  constexpr std::size_t most_rows = 33, most_pieces = 256;
  const auto error = double(relative_error);
  const float span = azimuth_span(symmetry);
  std::map<float, AlbedoTable> rows;
  const RowAt once = [&](float phi_o, bool checked) {
    const auto found = rows.find(phi_o);
    if (found != rows.end()) return found->second;
    return rows.emplace(phi_o, row_at(phi_o, checked)).first->second;
  };
  const auto stating = [&](AlbedoTable table, double miss) {
    if (miss > double(table.relative_error)) table.relative_error = float(std::min(2 * miss, 1.));
    return table;
  };
  std::vector<double> cuts;
  const bool inside = borders.size() > 2, leaps = inside || leaps_at_ends;
  if (!leaps) {
    for (SeriesRows series(symmetry, error, once);; series.refine()) {
      if (series.settled()) {
        AlbedoTable table = series.table();
        const double miss = miss_of(table);
        // Rows may foretell each other and yet stand beside all that happens.
        if (miss <= double(table.relative_error)) return table;
      }
      if (series.size() >= most_rows || spent()) break;
    }
    for (int k = 0; k <= 8; ++k) cuts.push_back(k / 8.);
  } else if (inside) {
    for (const float phi : borders) cuts.push_back(double(phi) / double(span));
  } else {
    cuts = {0, 0.5, 1};  // a single piece would go round
  }
  const auto is_steady = [&](double cut) {
    return std::any_of(bends.begin(), bends.end(),
                       [&](float bend) { return std::abs(double(bend) - cut * double(span)) < 1e-4; });
  };
  for (;;) {
    std::vector<bool> leaping;
    for (const double cut : cuts) {
      const bool end = cut == 0 || cut == 1;
      leaping.push_back((end ? leaps_at_ends : leaps) && !is_steady(cut));
    }
    AlbedoTable table = albedo_in_pieces(span, cuts, leaping, error, once, spent);
    table.even = is_mirrored(symmetry);
    const double miss = miss_of(table);
    if (miss <= double(table.relative_error) || leaps || spent() || cuts.size() > most_pieces)
      return stating(std::move(table), miss);
    std::vector<double> finer{0};
    for (std::size_t k = 1; k < cuts.size(); ++k) {
      finer.push_back(0.5 * (cuts[k - 1] + cuts[k])), finer.push_back(cuts[k]);
    }
    cuts = std::move(finer);
  }
}

}  // namespace reflectree::detail
