// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/environment.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"

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

// The first element above u of the last.
template <class T>
std::size_t guided(const T* sums, std::size_t n, const std::uint16_t* guide, T u) {
  const T goal = u * sums[n - 1];
  std::size_t at = guide[std::size_t(u * T(n))];
  while (at > 0 && sums[at - 1] > goal) --at;  // where rounding went too far
  while (at + 1 < n && sums[at] <= goal) ++at;
  return at;
}

}  // namespace

Environment::Environment(const Image& p, Frame<float> frame, float scale, const std::string& where) {
  if (p.width < 2 || p.height < 3 || p.channels.size() < 3) {
    throw Error("a sky needs red, green and blue and at least 2 x 3 pixels", where, "use another picture");
  }
  if (p.width > 65535 || p.height > 65535)
    throw Error("the sky is too large", where, "use a smaller picture");
  Sky sky{frame, p.width, p.height - 1, {}, {}, {}, {}, {}, {}};
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x <= p.width; ++x) {
      const float* v = p.values.data() + p.index(x % p.width, y);
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
Environment::Light Environment::Sky::in_cell(int x, int y, float s, float t, float sine) const {
  const auto stride = std::size_t(width) + 1;
  const Rgb* c = texels.data() + std::size_t(y) * stride + std::size_t(x);
  const Rgb sum = c[0] + c[1] + c[stride] + c[stride + 1];
  const float own = std::max(0.f, sum.r + sum.g + sum.b) * sines[std::size_t(y)];
  const float density = own / float(mass.back()) * float(width) * float(rows);
  return {(1 - t) * ((1 - s) * c[0] + s * c[1]) + t * ((1 - s) * c[stride] + s * c[stride + 1]),
          density / (2 * pi * pi * std::max(1e-6f, sine))};
}

Environment::Light Environment::at(Direction direction) const {
  if (!sky_) return {constant_, 1 / (4 * pi)};
  const Direction d = to_local(sky_->frame, direction);
  const float w = float(sky_->width), h = float(sky_->rows);
  float x = std::atan2(d.x, -d.z) / (2 * pi) * w - .5f;
  if (x < 0) x += w;
  const float y = std::acos(std::clamp(d.y, -1.f, 1.f)) / pi * h;
  const int i = std::clamp(int(x), 0, sky_->width - 1), j = std::clamp(int(y), 0, sky_->rows - 1);
  return sky_->in_cell(i, j, x - float(i), y - float(j), std::sqrt(d.x * d.x + d.z * d.z));
}

Environment::Drawn Environment::sample(PathBits& u) const {
  if (!sky_) {
    const float z = 1 - 2 * to_unit_float(u()), phi = 2 * pi * to_unit_float(u());
    const float r = std::sqrt(std::max(0.f, 1 - z * z));
    return {{r * std::cos(phi), r * std::sin(phi), z}, {constant_, 1 / (4 * pi)}};
  }
  const Sky& sky = *sky_;
  const auto width = std::size_t(sky.width), rows = std::size_t(sky.rows);
  const std::size_t y = guided(sky.mass.data(), rows, sky.first_row.data(), to_unit_double(u()));
  const std::size_t x = guided(sky.columns.data() + y * width, width, sky.first_column.data() + y * width,
                               std::min(largest_share, to_unit_float(u())));
  const float s = to_unit_float(u()), t = to_unit_float(u());
  const float phi = 2 * pi * (float(x) + .5f + s) / float(width), theta = pi * (float(y) + t) / float(rows);
  const float sine = std::sin(theta);
  return {to_world(sky.frame, Direction{std::sin(phi) * sine, std::cos(theta), -std::cos(phi) * sine}),
          sky.in_cell(int(x), int(y), s, t, sine)};
}

}  // namespace reflectree::render
