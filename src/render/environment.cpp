// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/environment.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree::render {

Environment::Environment(Image picture, Frame<float> frame, float scale, const std::string& where)
    : picture_(std::make_shared<const Image>(std::move(picture))), frame_(frame), scale_(scale) {
  const Image& p = *picture_;
  if (p.width < 2 || p.height < 3 || p.channels.size() < 3) {
    throw Error("a sky needs red, green and blue and at least 2 x 3 pixels", where, "use another picture");
  }
  const auto width = std::size_t(p.width);
  columns_.resize(width * std::size_t(p.height - 1));
  double total = 0;
  for (int y = 0; y + 1 < p.height; ++y) {
    const double sine = std::sin(pi_v<double> * (y + .5) / (p.height - 1));
    double row = 0;
    for (int x = 0; x < p.width; ++x) {
      const Rgb c = texel(x, y) + texel(x + 1, y) + texel(x, y + 1) + texel(x + 1, y + 1);
      row += double(std::max(0.f, c.r + c.g + c.b)) * sine;
      columns_[std::size_t(y) * width + std::size_t(x)] = float(row);
    }
    rows_.push_back(total += row);
  }
  if (!(total > 0) || !std::isfinite(total)) {
    throw Error("the sky has no finite light", where, "use another picture");
  }
}

Rgb Environment::texel(int x, int y) const {
  const float* v = picture_->values.data() + picture_->index(x % picture_->width, y);
  return {v[0], v[1], v[2]};
}

Environment::Cell Environment::cell(Direction d) const {
  const float w = float(picture_->width), h = float(picture_->height - 1);
  float x = std::atan2(d.x, -d.z) / (2 * pi) * w - .5f;
  x -= std::floor(x / w) * w;
  const float y = std::acos(std::clamp(d.y, -1.f, 1.f)) / pi * h;
  const int i = std::clamp(int(x), 0, picture_->width - 1), j = std::clamp(int(y), 0, picture_->height - 2);
  return {i, j, x - float(i), y - float(j)};
}

Rgb Environment::radiance(Direction direction) const {
  if (!picture_) return constant_;
  const auto [x, y, s, t] = cell(to_local(frame_, direction));
  return scale_ * ((1 - t) * ((1 - s) * texel(x, y) + s * texel(x + 1, y)) +
                   t * ((1 - s) * texel(x, y + 1) + s * texel(x + 1, y + 1)));
}

// Of the whole, times the number of cells: the density on the square.
float Environment::mass(int x, int y) const {
  const float* row = columns_.data() + std::size_t(y) * std::size_t(picture_->width);
  const float m = row[x] - (x > 0 ? row[x - 1] : 0);
  return m / float(rows_.back()) * float(picture_->width) * float(picture_->height - 1);
}

float Environment::pdf(Direction direction) const {
  if (!picture_) return 1 / (4 * pi);
  const Direction d = to_local(frame_, direction);
  const Cell c = cell(d);
  const float sine = std::max(1e-6f, std::sqrt(d.x * d.x + d.z * d.z));
  return mass(c.x, c.y) / (2 * pi * pi * sine);
}

Direction Environment::sample(PathBits& u) const {
  if (!picture_) {
    const float z = 1 - 2 * to_unit_float(u()), phi = 2 * pi * to_unit_float(u());
    const float r = std::sqrt(std::max(0.f, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
  const auto width = std::size_t(picture_->width);
  const double goal = to_unit_double(u()) * rows_.back();
  const auto y = std::size_t(std::upper_bound(rows_.begin(), rows_.end() - 1, goal) - rows_.begin());
  const float* row = columns_.data() + y * width;
  const float want = to_unit_float(u()) * row[width - 1];
  const auto x = std::size_t(std::upper_bound(row, row + width - 1, want) - row);
  const float phi = 2 * pi * (float(x) + .5f + to_unit_float(u())) / float(width);
  const float theta = pi * (float(y) + to_unit_float(u())) / float(picture_->height - 1);
  const float sine = std::sin(theta);
  return to_world(frame_, Direction{std::sin(phi) * sine, std::cos(theta), -std::cos(phi) * sine});
}

}  // namespace reflectree::render
