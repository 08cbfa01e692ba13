// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/disk_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reflectree/draw/png.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/albedo.hpp"
#include "reflectree/sampler/domain_map.hpp"

namespace reflectree::draw {

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// Half domains know the directions of one side only; the other is its mirror image.
Direction folded(const Domain& domain, Direction wi) {
  return {wi.x, domain.half ? std::abs(wi.y) : wi.y, wi.z};
}

double total(const std::vector<std::uint32_t>& mass) {
  double sum = 0;
  for (const std::uint32_t m : mass) sum += m;
  return sum;
}

// A leaf's share of the square.
double share(const SquareCell& c, const Domain& domain) {
  return double(c.x1 - c.x0) * double(c.y1 - c.y0) / (domain.half ? 2.0 : 4.0);
}

// volume * probability / share * shape / projected_area of the leaf that holds wi.
DiskImage tree_image(const CanonicalTree& tree, const Domain& domain, Direction wo, int size, double volume) {
  const LeafFinder finder(tree.nodes, domain);
  const double scale = volume / total(tree.mass);
  return disk_image(
      [&](std::span<const Direction> wi, std::span<float> out) {
        for (std::size_t i = 0; i < wi.size(); ++i) {
          const Vec2<float> p = lower(domain, wo, folded(domain, wi[i]));
          const float projected_area = lift(domain, wo, p).projected_area;
          const LeafFinder::Leaf leaf = finder.find(p);
          const double mean = scale * tree.mass[leaf.index] / share(leaf.cell, domain);
          out[i] = float(mean) * leaf_shape(tree, leaf, p) / projected_area;
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
  const float theta_o = theta_of(wo);
  return find_slab(partition, {&theta_o, 1});
}

float leaf_shape(const CanonicalTree& tree, const LeafFinder::Leaf& leaf, Vec2<float> p) {
  const SquareCell& c = leaf.cell;
  const float s = 2 * (p.x - c.x0) / (c.x1 - c.x0) - 1, t = 2 * (p.y - c.y0) / (c.y1 - c.y0) - 1;
  return (1 + float(tree.slope_x[leaf.index]) / 128 * s) * (1 + float(tree.slope_y[leaf.index]) / 128 * t);
}

DiskImage bound_image(const SamplerData& data, Direction wo, int size) {
  const MajorantTree& tree = data.exact.at(slab_of(data.exact_partition, wo));
  return tree_image(tree, data.domain, wo, size, double(tree.volume) * double(albedo_at(data.albedo, wo.z)));
}

DiskImage one_shot_image(const SamplerData& data, Direction wo, int size) {
  const DensityTree& tree = data.one_shot.at(slab_of(data.one_shot_partition, wo));
  return tree_image(tree, data.domain, wo, size, double(albedo_at(data.albedo, wo.z)));
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
  IndexedImage pixels{image.size, image.size, std::vector<std::uint8_t>(image.value.size())};
  Axis position = range;
  position.from = 0;
  position.to = 254;
  for (std::size_t i = 0; i < image.value.size(); ++i) {
    const float v = image.value[i];
    if (!std::isnan(v)) pixels.index[i] = std::uint8_t(1.5 + position.at(double(v)));
  }
  return element("image", {{"class", css_class},
                           {"x", number(x - side / 2)},
                           {"y", number(y - side / 2)},
                           {"width", number(side)},
                           {"height", number(side)},
                           {"href", png_data_uri(pixels, colours)}}) +
         "\n";
}

LeafFinder::LeafFinder(const std::vector<TreeSplit>& nodes, const Domain& domain)
    : y0_(domain.half ? 0.f : -1.f) {
  // Preorder: an inner node's upper child follows the whole lower subtree. Read backwards, the starts of
  // finished subtrees lie on a stack, the lower one on top.
  nodes_.resize(nodes.size());
  std::vector<std::size_t> starts;
  auto leaves = std::size_t(std::count(nodes.begin(), nodes.end(), TreeSplit::leaf));
  for (std::size_t i = nodes.size(); i-- > 0;) {
    if (nodes[i] == TreeSplit::leaf) {
      nodes_[i] = {TreeSplit::leaf, --leaves};
    } else {
      if (starts.size() < 2) throw Error("the tree is not complete", "leaf finder", "validate() the sampler");
      starts.pop_back();
      nodes_[i] = {nodes[i], starts.back()};
      starts.pop_back();
    }
    starts.push_back(i);
  }
  if (starts.size() != 1) throw Error("the tree is not complete", "leaf finder", "validate() the sampler");
}

LeafFinder::Leaf LeafFinder::find(Vec2<float> p) const {
  SquareCell c{-1, 1, y0_, 1};
  std::size_t i = 0;
  while (nodes_[i].split != TreeSplit::leaf) {
    const bool along_x = nodes_[i].split == TreeSplit::x;
    float& lo = along_x ? c.x0 : c.y0;
    float& hi = along_x ? c.x1 : c.y1;
    const float middle = 0.5f * (lo + hi);
    const bool upper = (along_x ? p.x : p.y) >= middle;
    (upper ? lo : hi) = middle;
    i = upper ? nodes_[i].upper_or_leaf : i + 1;
  }
  return {nodes_[i].upper_or_leaf, c};
}

}  // namespace reflectree::draw
