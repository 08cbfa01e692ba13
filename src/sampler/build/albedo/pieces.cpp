// SPDX-License-Identifier: Apache-2.0
#include "pieces.hpp"

#include <algorithm>
#include <array>

#include "panels.hpp"

namespace reflectree::detail {

namespace {

constexpr int deepest = 8;
// Rows this far inside a leap, radians, stand for its sides: so far azimuths of directions are rounded.
constexpr double beside = 4e-6;

struct Piece {
  double lo, hi;  // shares of the span
  bool leap_lo, leap_hi;
  int depth = 0;
  std::array<AlbedoTable, 5> rows = {};
  int step = 1;  // every `step`th row is kept
  double missed = 0;
};

double share_of(const Piece& piece, std::size_t k, float span) {
  if (k == 0) return piece.leap_lo ? piece.lo + beside / double(span) : piece.lo;
  if (k == 4) return piece.leap_hi ? piece.hi - beside / double(span) : piece.hi;
  return piece.lo + (piece.hi - piece.lo) * double(k) / 4;
}

// What lines through both ends, and parabolas through every second row, miss at the rows between; lines at the
// middle row alone where no others are known.
struct Misses {
  double line = 0, parabola = 0;
};
Misses misses_of(const Piece& piece, bool quarters) {
  std::vector<AlbedoTable> rows(piece.rows.begin(), piece.rows.end());
  if (!quarters) rows[1] = rows[0], rows[3] = rows[4];
  const std::vector<float> columns = all_columns(rows);
  const RowValues v = values_on(rows, columns);
  Misses m;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::array<double, 5> a{};
    for (std::size_t k = 0; k < 5; ++k) a[k] = v[k][i];
    const double allowed = times_allowed(columns[i]);
    for (std::size_t k = quarters ? 1 : 2; k <= (quarters ? 3 : 2); ++k) {
      const double t = double(k) / 4;
      m.line = std::max(m.line, relative((1 - t) * a[0] + t * a[4], a[k]) / allowed);
    }
    if (!quarters) continue;
    m.parabola = std::max(m.parabola, relative((3 * a[0] + 6 * a[2] - a[4]) / 8, a[1]) / allowed);
    m.parabola = std::max(m.parabola, relative((3 * a[4] + 6 * a[2] - a[0]) / 8, a[3]) / allowed);
  }
  return m;
}

}  // namespace

AlbedoTable albedo_in_pieces(float span, const std::vector<double>& borders, const std::vector<bool>& leaps,
                             double error, const RowAt& row_at, const std::function<bool()>& spent) {
  // Rows are dear: the last one of a piece is the first one of the next where nothing leaps between them, and
  // halves know half of theirs.
  std::vector<std::pair<double, AlbedoTable>> known;
  const auto row = [&](double share) {
    for (const auto& [at, table] : known) {
      if (at == share) return table;
    }
    known.emplace_back(share, row_at(span * float(share), known.empty()));
    return known.back().second;
  };
  const auto stated = [](const Piece& piece) {
    float worst = 0;
    for (const AlbedoTable& r : piece.rows) worst = std::max(worst, r.relative_error);
    return double(worst);
  };
  std::vector<Piece> open, done;
  for (std::size_t i = borders.size() - 1; i > 0; --i)
    open.push_back({borders[i - 1], borders[i], leaps[i - 1], leaps[i]});
  while (!open.empty()) {
    Piece piece = std::move(open.back());
    open.pop_back();
    for (const std::size_t k : {0U, 2U, 4U}) piece.rows[k] = row(share_of(piece, k, span));
    // Rows that are known worse than was asked for do not foretell each other any better, and are dear.
    const bool rough = stated(piece) > 3 * error;
    const double enough = 0.3 * std::max(error, stated(piece));
    Misses m = rough ? misses_of(piece, false) : Misses{};
    const bool quarters = !rough || (m.line > enough && !spent());
    if (quarters) {
      for (const std::size_t k : {1U, 3U}) piece.rows[k] = row(share_of(piece, k, span));
      m = misses_of(piece, true);
    }
    // Halving the distance of a smooth function's rows leaves an eighth.
    const bool halve = quarters && m.line > enough && m.parabola > 8 * enough;
    if (halve && piece.depth < deepest && !spent()) {
      const double middle = 0.5 * (piece.lo + piece.hi);
      open.push_back({middle, piece.hi, false, piece.leap_hi, piece.depth + 1});
      open.push_back({piece.lo, middle, piece.leap_lo, false, piece.depth + 1});
      continue;
    }
    piece.step = m.line <= enough ? 4 : !quarters || m.parabola <= enough ? 2 : 1;
    piece.missed = !quarters || piece.step == 4 ? m.line
                   : piece.step == 2 || halve   ? m.parabola
                                                : m.parabola / 8;
    done.push_back(std::move(piece));
  }

  AlbedoTable table;
  std::vector<AlbedoTable> rows;
  double missed = 0;
  for (const Piece& piece : done) {
    // To the last bit where f tells that it leaps.
    const auto lo = float(double(span) * piece.lo), hi = float(double(span) * piece.hi);
    for (std::size_t k = 0; k < 5; k += std::size_t(piece.step)) {
      rows.push_back(piece.rows[k]);
      table.phi_o.push_back(k == 4 ? hi : lo + (hi - lo) * (float(k) / 4));
      table.relative_error = std::max(table.relative_error, piece.rows[k].relative_error);
    }
    missed = std::max(missed, piece.missed);
  }
  table.cos_theta_o = all_columns(rows);
  RowValues values = values_on(rows, table.cos_theta_o);
  const double thin = thinning(error, double(table.relative_error) + missed);
  thin_out(table.cos_theta_o, values, thin);
  for (const auto& row_values : values) {
    for (const double a : row_values) table.albedo.push_back(float(std::max(a, 0.)));
  }
  const double sum = double(table.relative_error) + thin + missed;
  table.relative_error = float(std::min(std::max(sum, error), 1.));
  return table;
}

}  // namespace reflectree::detail
