// SPDX-License-Identifier: Apache-2.0
#include "reflectree/picture/image_compare.hpp"

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree {

namespace {

struct Channels {
  int value, error;  // numbers in the image; -1: not there
};

Channels find(const Image& image, const std::string& name) {
  return {image.find(name), image.find("stderr." + name)};
}

struct Block {
  double difference = 0, variance = 0;
  bool trusted = true;
};

// One value per pixel: its difference, the variance of that, whether b's error can be trusted.
Block pixel(const Image& a, Channels in_a, const Image& b, Channels in_b, int x, int y, double trust) {
  const auto get = [&](const Image& i, int c) { return double(i.values[i.index(x, y) + std::size_t(c)]); };
  Block p;
  p.difference = get(a, in_a.value) - get(b, in_b.value);
  if (in_a.error < 0 || in_b.error < 0) return p;
  const double ea = get(a, in_a.error), eb = get(b, in_b.error);
  p.variance = ea * ea + eb * eb;
  p.trusted = eb <= trust * std::abs(get(b, in_b.value));
  return p;
}

}  // namespace

ImageDifference compare_images(const Image& a, const Image& b, const ImageCompareOptions& options) {
  if (a.width != b.width || a.height != b.height)
    throw Error("the pictures differ in size", "image-compare", "render them alike");
  ImageDifference result;
  std::vector<double> z;
  ZScores scores;
  bool errors = true;
  for (const char* name : {"R", "G", "B"}) {
    const Channels in_a = find(a, name), in_b = find(b, name);
    if (in_a.value < 0 || in_b.value < 0)
      throw Error(std::string("no channel ") + name, "image-compare", "compare pictures in RGB");
    errors = errors && in_a.error >= 0 && in_b.error >= 0;
    ChannelDifference d{name};
    double variance = 0;
    for (int by = 0; by < a.height; by += options.block) {
      for (int bx = 0; bx < a.width; bx += options.block) {
        Block block;
        for (int y = by; y < std::min(by + options.block, a.height); ++y) {
          for (int x = bx; x < std::min(bx + options.block, a.width); ++x) {
            const Block p = pixel(a, in_a, b, in_b, x, y, options.trust);
            const double vb = double(b.values[b.index(x, y) + std::size_t(in_b.value)]);
            d.mean_a += vb + p.difference, d.mean_b += vb;
            d.mse += p.difference * p.difference;
            d.relative_mse += p.difference * p.difference / (vb * vb + .01);
            block.difference += p.difference, block.variance += p.variance;
            block.trusted = block.trusted && p.trusted;
          }
        }
        variance += block.variance;
        const bool counts = block.trusted && block.variance > 0;
        ++(counts ? scores.blocks : scores.left_out);
        if (counts) z.push_back(block.difference / std::sqrt(block.variance));
      }
    }
    const double n = double(a.width) * double(a.height);
    d.mean_a /= n, d.mean_b /= n, d.mse /= n, d.relative_mse /= n, d.mean_error = std::sqrt(variance) / n;
    result.channels.push_back(d);
  }
  if (!errors || z.empty()) return result;
  std::sort(z.begin(), z.end());
  for (std::size_t i = 0; i < z_probabilities.size(); ++i)
    scores.quantiles[i] = z[std::size_t(z_probabilities[i] * double(z.size() - 1) + .5)];
  result.z = scores;
  return result;
}

Image difference_map(const Image& a, const Image& b, int block, double scale) {
  Image map = make_image(a.width, a.height, {"R", "G", "B"});
  const auto light = [](const Image& i, int x, int y) {
    const float* v = i.values.data() + i.index(x, y);
    return double(v[i.find("R")] + v[i.find("G")] + v[i.find("B")]);
  };
  for (int by = 0; by < a.height; by += block) {
    for (int bx = 0; bx < a.width; bx += block) {
      const int ex = std::min(bx + block, a.width), ey = std::min(by + block, a.height);
      double sum_a = 0, sum_b = 0;
      for (int y = by; y < ey; ++y) {
        for (int x = bx; x < ex; ++x) sum_a += light(a, x, y), sum_b += light(b, x, y);
      }
      const double t = std::clamp((sum_a - sum_b) / (scale * std::max(sum_b, 1e-9)), -1., 1.);
      for (int y = by; y < ey; ++y) {
        for (int x = bx; x < ex; ++x) {
          float* out = map.values.data() + map.index(x, y);
          out[0] = float(std::min(1., 1 + t)), out[1] = float(1 - std::abs(t));
          out[2] = float(std::min(1., 1 - t));
        }
      }
    }
  }
  return map;
}

}  // namespace reflectree
