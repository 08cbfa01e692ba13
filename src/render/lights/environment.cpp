// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/lights/environment.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/math/fast_functions.hpp"
#include "reflectree/math/prefetch.hpp"

namespace reflectree::render {

namespace {

constexpr float largest_share = 1 - 0x1p-24f;

// For each k < n, the first element of the ascending `sums` above k / n of the last.
template <class T>
void append_guide(const T* sums, std::size_t n, std::vector<std::uint16_t>& guide) {
  std::size_t at = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double goal = double(sums[n - 1]) * double(k) / double(n);
    while (at + 1 < n && double(sums[at]) <= goal) ++at;
    guide.push_back(std::uint16_t(at));
  }
}

// The first element above `share` of the last; the search begins at the guide's.
template <class T>
std::size_t guided(const T* sums, std::size_t n, std::size_t begin, T share) {
  const T goal = share * sums[n - 1];
  std::size_t at = begin;
  while (at > 0 && sums[at - 1] > goal) --at;  // where rounding went too far
  while (at + 1 < n && sums[at] <= goal) ++at;
  return at;
}

constexpr std::size_t block = 64;  // of look-ups whose waits for memory overlap

}  // namespace

Environment::Environment(const Image& p, LocalFrame<float> frame, float scale, const std::string& where) {
  if (p.width < 1 || p.height < 1 || p.channels.size() < 3) {
    throw Error("a sky needs red, green and blue", where, "use another picture");
  }
  if (p.width > 65535 || p.height > 65535)
    throw Error("the sky is too large", where, "use a smaller picture");
  // The last column and row go on where there are fewer than 2 x 3 pixels.
  const int columns = std::max(2, p.width), last = std::max(2, p.height - 1);
  Sky sky{frame, columns, last, {}, {}, {}, {}, {}, {}};
  for (int y = 0; y <= last; ++y) {
    for (int x = 0; x <= columns; ++x) {
      const float* v =
          p.values.data() + p.index(std::min(x % columns, p.width - 1), std::min(y, p.height - 1));
      sky.texels.push_back(scale * Rgb{v[0], v[1], v[2]});
    }
  }
  const auto width = std::size_t(sky.width), rows = std::size_t(sky.rows);
  double total = 0;
  for (std::size_t y = 0; y < rows; ++y) {
    const double sine = std::sin(pi_v<double> * (double(y) + .5) / double(rows));
    double row = 0;
    for (std::size_t x = 0; x < width; ++x) {
      const Rgb* t = sky.texels.data() + y * (width + 1) + x;
      const Rgb c = t[0] + t[1] + t[width + 1] + t[width + 2];
      row += double(std::max(0.f, c.r + c.g + c.b)) * sine;
      sky.columns.push_back(float(row));
    }
    sky.mass.push_back(total += row), sky.sines.push_back(float(sine));
    append_guide(sky.columns.data() + y * width, width, sky.first_column);
  }
  if (!(total > 0) || !std::isfinite(total)) {
    throw Error("the sky has no finite light", where, "use another picture");
  }
  append_guide(sky.mass.data(), rows, sky.first_row);
  sky_ = std::make_shared<const Sky>(std::move(sky));
}

// A cell's share of the mass, times the number of cells, is the density on the square, whose Jacobian is
// 2 pi^2 sin theta.
Environment::Light Environment::Sky::in_cell(const Place& p) const {
  const Rgb *c = texel(std::size_t(p.x), std::size_t(p.y)), *d = c + width + 1;
  const Rgb sum = c[0] + c[1] + d[0] + d[1];
  const float own = std::max(0.f, sum.r + sum.g + sum.b) * sines[std::size_t(p.y)];
  const float density = own / float(mass.back()) * float(width) * float(rows);
  return {(1 - p.t) * ((1 - p.s) * c[0] + p.s * c[1]) + p.t * ((1 - p.s) * d[0] + p.s * d[1]),
          density / (2 * pi * pi * std::max(1e-6f, p.sine))};
}

Environment::Sky::Place Environment::Sky::place_of(Direction direction) const {
  const Direction d = to_local(frame, direction);
  const float w = float(width), h = float(rows);
  float x = angle_of(d.x, -d.z) / (2 * pi) * w - .5f;
  if (x < 0) x += w;
  const float sine = std::sqrt(d.x * d.x + d.z * d.z), y = angle_of(sine, d.y) / pi * h;
  const int i = std::clamp(int(x), 0, width - 1), j = std::clamp(int(y), 0, rows - 1);
  return {i, j, x - float(i), y - float(j), sine};
}

Environment::Light Environment::at(Direction direction) const {
  return sky_ ? sky_->in_cell(sky_->place_of(direction)) : Light{constant_, 1 / (4 * pi)};
}

void Environment::at(std::span<const Direction> directions, std::span<Light> out) const {
  Sky::Place places[block];
  for (std::size_t begin = 0; begin < directions.size(); begin += block) {
    const std::size_t n = std::min(block, directions.size() - begin);
    for (std::size_t i = 0; sky_ && i < n; ++i) {
      const auto& p = places[i] = sky_->place_of(directions[begin + i]);
      prefetch(sky_->texel(std::size_t(p.x), std::size_t(p.y)));
      prefetch(sky_->texel(std::size_t(p.x), std::size_t(p.y) + 1));
    }
    for (std::size_t i = 0; i < n; ++i)
      out[begin + i] = sky_ ? sky_->in_cell(places[i]) : Light{constant_, 1 / (4 * pi)};
  }
}

Environment::Sky::Aim Environment::Sky::aim(PathBits& u) const {
  const double of_rows = to_unit_double(u());
  const auto n = std::size_t(rows), w = std::size_t(width);
  const std::size_t y = guided(mass.data(), n, first_row[std::size_t(of_rows * double(n))], of_rows);
  const float share = std::min(largest_share, to_unit_float(u())), s = to_unit_float(u());
  return {y, y * w + std::size_t(share * float(w)), share, s, to_unit_float(u())};
}

REFLECTREE_INLINE std::size_t Environment::Sky::column(const Aim& aim) const {
  const auto w = std::size_t(width);
  return guided(columns.data() + aim.y * w, w, first_column[aim.guide], aim.share);
}

Environment::Drawn Environment::Sky::drawn(const Aim& aim, std::size_t x) const {
  const float phi = 2 * pi * (float(x) + .5f + aim.s) / float(width);
  const float theta = pi * (float(aim.y) + aim.t) / float(rows), sine = std::sin(theta);
  return {to_world(frame, Direction{std::sin(phi) * sine, std::cos(theta), -std::cos(phi) * sine}),
          in_cell({int(x), int(aim.y), aim.s, aim.t, sine})};
}

Environment::Drawn Environment::sample(PathBits& u) const {
  if (sky_) {
    const auto aim = sky_->aim(u);
    return sky_->drawn(aim, sky_->column(aim));
  }
  const float z = 1 - 2 * to_unit_float(u()), phi = 2 * pi * to_unit_float(u());
  const float r = std::sqrt(std::max(0.f, 1 - z * z));
  return {{r * std::cos(phi), r * std::sin(phi), z}, {constant_, 1 / (4 * pi)}};
}

void Environment::sample(std::span<PathBits* const> u, std::span<Drawn> out) const {
  if (!sky_) {
    for (std::size_t i = 0; i < u.size(); ++i) out[i] = sample(*u[i]);
    return;
  }
  Sky::Aim aims[block];
  std::size_t x[block];
  const auto width = std::size_t(sky_->width);
  for (std::size_t begin = 0; begin < u.size(); begin += block) {
    const std::size_t n = std::min(block, u.size() - begin);
    for (std::size_t i = 0; i < n; ++i) {
      aims[i] = sky_->aim(*u[begin + i]);
      prefetch(&sky_->first_column[aims[i].guide]);
      prefetch(&sky_->columns[aims[i].y * width + width - 1]);
    }
    for (std::size_t i = 0; i < n; ++i)
      prefetch(&sky_->columns[aims[i].y * width + sky_->first_column[aims[i].guide]]);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = sky_->column(aims[i]);
      prefetch(sky_->texel(x[i], aims[i].y));
      prefetch(sky_->texel(x[i], aims[i].y + 1));
    }
    for (std::size_t i = 0; i < n; ++i) out[begin + i] = sky_->drawn(aims[i], x[i]);
  }
}

}  // namespace reflectree::render
