// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/disk_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reflectree/error.hpp"
#include "reflectree/sampler/packed_sampler.hpp"
#include "reflectree/sampler/square/domain_map.hpp"

namespace reflectree::draw {

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// volume * density * albedo / projected_area of the tree of the slab of wo.
template <class Trees>
DiskImage tree_image(const SamplerData& data, const Partition& partition, const Trees& trees, Direction wo,
                     int size) {
  Incidence in;
  if (!find_incidence(pack_viewer(data), wo, in)) {
    return disk_image(
        [](std::span<const Direction>, std::span<float> out) { std::fill(out.begin(), out.end(), 0.f); },
        size);
  }
  const auto& tree = trees.at(slab_of(partition, in));
  const Domain& domain = data.domain;
  double scale = double(in.albedo);
  if constexpr (requires { tree.volume; }) scale *= double(tree.volume);
  const TreeReader reader(tree, domain.symmetry);
  return disk_image(
      [&](std::span<const Direction> wi, std::span<float> out) {
        for (std::size_t i = 0; i < wi.size(); ++i) {
          const Vec2<float> p = lower(domain, in.wo, fold(domain.symmetry, to_incidence(in, wi[i])));
          out[i] = float(scale * reader.density_at(p)) / lift(domain, in.wo, p).projected_area;
        }
      },
      size);
}

}  // namespace

float DiskImage::at(double x, double y) const {
  const auto pixel = [&](double u) { return std::size_t(std::clamp(int((u + 1) / 2 * size), 0, size - 1)); };
  return value[pixel(-y) * std::size_t(size) + pixel(x)];
}

DiskImage disk_image(const DiskFunction& g, int size) {
  if (size < 2 || size > 4096) {
    throw Error("a size of " + std::to_string(size) + " pixels", "disk image", "ask for 2 to 4096");
  }
  const auto n = std::size_t(size);
  DiskImage image{size, std::vector<float>(n * n, nan)};
  std::vector<Direction> wi;
  std::vector<std::size_t> pixel;
  std::vector<float> out;
  std::vector<int> count(n);
  for (std::size_t row = 0; row < n; ++row) {
    wi.clear();
    pixel.clear();
    for (std::size_t k = 0; k < 4 * n; ++k) {
      const float x = (float(k / 4) + 0.25f + 0.5f * float(k % 2)) * 2 / float(n) - 1;
      const float y = 1 - (float(row) + 0.25f + 0.5f * float(k / 2 % 2)) * 2 / float(n);
      const float z2 = 1 - x * x - y * y;
      if (z2 <= 0) continue;
      wi.push_back({x, y, std::sqrt(z2)});
      pixel.push_back(k / 4);
    }
    out.assign(wi.size(), 0.f);
    g(wi, out);
    std::fill(count.begin(), count.end(), 0);
    for (std::size_t i = 0; i < wi.size(); ++i) {
      float& sum = image.value[row * n + pixel[i]];
      sum = (count[pixel[i]]++ ? sum : 0.f) + out[i];
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (count[i] > 0) image.value[row * n + i] /= float(count[i]);
    }
  }
  return image;
}

Direction viewer_at(float theta_o) { return {std::sin(theta_o), 0.f, std::cos(theta_o)}; }

DiskImage target_image(const AnyBrdf& f, const Target& target, Direction wo, int size) {
  std::vector<Direction> same;
  std::vector<float> values;
  const int channels = f.channels();
  return disk_image(
      [&](std::span<const Direction> wi, std::span<float> out) {
        same.assign(wi.size(), wo);
        values.resize(wi.size() * std::size_t(channels));
        f.eval(same, wi, values);
        for (std::size_t i = 0; i < wi.size(); ++i) {
          out[i] = target(values.data() + i * std::size_t(channels), channels);
        }
      },
      size);
}

std::size_t slab_of(const Partition& partition, Direction wo) {
  const float known[2] = {theta_of(wo), 0};
  return find_slab(partition, known);
}

DiskImage bound_image(const SamplerData& data, Direction wo, int size) {
  return tree_image(data, data.exact_partition, data.exact, wo, size);
}

DiskImage one_shot_image(const SamplerData& data, Direction wo, int size) {
  return tree_image(data, data.one_shot_partition, data.one_shot, wo, size);
}

Axis log_range(const DiskImage& image, double decades) {
  double lo = std::numeric_limits<double>::infinity(), hi = 0;
  for (const float v : image.value) {
    if (!std::isfinite(v) || v <= 0) continue;
    lo = std::min(lo, double(v));
    hi = std::max(hi, double(v));
  }
  if (hi == 0) lo = hi = 1;
  lo = std::max(lo, hi * std::pow(10.0, -decades));
  if (hi / lo < 10) {
    const double centre = std::sqrt(hi * lo);
    lo = centre / std::sqrt(10.0);
    hi = centre * std::sqrt(10.0);
  }
  return {lo, hi, 0, 1, true};
}

std::string disk_raster(const DiskImage& image, const Axis& range, double x, double y, double side,
                        std::string_view css_class, const Palette& colours) {
  std::vector<std::uint8_t> pixels(image.value.size());
  Axis position = range;
  position.from = 0;
  position.to = 254;
  for (std::size_t i = 0; i < image.value.size(); ++i) {
    const float v = image.value[i];
    if (!std::isnan(v)) pixels[i] = std::uint8_t(1.5 + position.at(double(v)));
  }
  return element("image", {{"class", css_class},
                           {"x", number(x - side / 2)},
                           {"y", number(y - side / 2)},
                           {"width", number(side)},
                           {"height", number(side)},
                           {"href", png_data_uri(image.size, image.size, pixels, colours)}}) +
         "\n";
}

}  // namespace reflectree::draw
