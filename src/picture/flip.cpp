// SPDX-License-Identifier: Apache-2.0
// FLIP's pipeline: contrast-sensitive blur in an opponent space and a colour difference in L*a*b*, sharpened
// where edges or points of one picture are not in the other. Equations are the paper's; constants are also
// those of its authors' program, with whose maps a test compares.
#include "reflectree/picture/flip.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree {

namespace {

using Colour = std::array<double, 3>;

struct Plane {
  int width, height;
  std::vector<double> values;
  double& at(int x, int y) { return values[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
  double at(int x, int y) const { return values[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};
using Planes = std::array<Plane, 3>;

// IEC 61966-2-1, and its white, to which XYZ is relative here.
constexpr Colour white{.950428545, 1, 1.088900371};
Colour xyz_over_white(Colour c) {
  return {(.412391 * c[0] + .357584 * c[1] + .180481 * c[2]) / white[0],
          (.212639 * c[0] + .715169 * c[1] + .072192 * c[2]) / white[1],
          (.019331 * c[0] + .119195 * c[1] + .950532 * c[2]) / white[2]};
}
Colour rgb_of(Colour relative) {
  const double x = relative[0] * white[0], y = relative[1] * white[1], z = relative[2] * white[2];
  return {3.240970 * x - 1.537383 * y - .498611 * z, -.969244 * x + 1.875968 * y + .041555 * z,
          .055630 * x - .203977 * y + 1.056972 * z};
}

// Y_y C_x C_z, a linear opponent space.
Colour opponent(Colour rgb) {
  const auto [x, y, z] = xyz_over_white(rgb);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}
Colour from_opponent(Colour c) {
  const double y = (c[0] + 16) / 116;
  return rgb_of({y + c[1] / 500, y, y - c[2] / 200});
}

// L*a*b* with Hunt's effect: dark colours are less colourful (sect. 4.1.2).
Colour hunt(Colour rgb) {
  const auto f = [](double t) {
    constexpr double d = 6. / 29;
    return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4. / 29;
  };
  const auto [x, y, z] = xyz_over_white(rgb);
  const double lightness = 116 * f(y) - 16;
  return {lightness, .01 * lightness * 500 * (f(x) - f(y)), .01 * lightness * 200 * (f(y) - f(z))};
}
double hyab(Colour a, Colour b) { return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]); }

// Differences to the power 0.7, the lower 40 % of what is possible spread to 95 % of the range (sect. 4.1.3).
double compressed(double difference) {
  static const double most = std::pow(hyab(hunt({0, 1, 0}), hunt({0, 0, 1})), .7);
  constexpr double knee = .4, share = .95;
  const double d = std::pow(difference, .7);
  if (d < knee * most) return share / (knee * most) * d;
  return share + (d - knee * most) / (most - knee * most) * (1 - share);
}

using Kernel = std::vector<double>;  // of odd length, about its middle

// Rows by `across`, then columns by `down`; the rim goes on outside.
Plane convolved(const Plane& p, const Kernel& across, const Kernel& down) {
  Plane half = p, whole = p;
  const auto pass = [&](const Plane& from, const Kernel& k, bool rows, Plane& to) {
    const int reach = int(k.size() / 2);
    for (int y = 0; y < p.height; ++y) {
      for (int x = 0; x < p.width; ++x) {
        double sum = 0;
        for (int i = -reach; i <= reach; ++i) {
          const int sx = rows ? std::clamp(x + i, 0, p.width - 1) : x;
          const int sy = rows ? y : std::clamp(y + i, 0, p.height - 1);
          sum += k[std::size_t(i + reach)] * from.at(sx, sy);
        }
        to.at(x, y) = sum;
      }
    }
  };
  pass(p, across, true, half);
  pass(half, down, false, whole);
  return whole;
}

template <class Function>
Kernel sampled(int reach, const Function& f) {
  Kernel k;
  for (int i = -reach; i <= reach; ++i) k.push_back(f(double(i)));
  return k;
}
// What is positive adds up to 1, what is negative to -1.
Kernel balanced(Kernel k) {
  double above = 0, below = 0;
  for (const double v : k) (v > 0 ? above : below) += std::abs(v);
  for (double& v : k) v /= v > 0 ? above : below > 0 ? below : 1;
  return k;
}

// The eye's contrast sensitivity as a blur: a sum of Gaussians a sqrt(pi / b) exp(-pi^2 x^2 / b), x in
// degrees (sect. 4.1.1). In two dimensions each of them is a product of two.
struct Lobe {
  double a, b;
};
Plane blurred(const Plane& p, std::initializer_list<Lobe> lobes, double ppd) {
  const int reach = int(std::ceil(3 * std::sqrt(.04 / (2 * M_PI * M_PI)) * ppd));
  Plane sum{p.width, p.height, std::vector<double>(p.values.size())};
  double total = 0;
  for (const Lobe& l : lobes) {
    const Kernel k =
        sampled(reach, [&](double i) { return std::exp(-M_PI * M_PI * i * i / (ppd * ppd * l.b)); });
    double mass = 0;
    for (const double v : k) mass += v;
    const double height = l.a * std::sqrt(M_PI / l.b);
    const Plane one = convolved(p, k, k);
    for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += height * one.values[i];
    total += height * mass * mass;
  }
  for (double& v : sum.values) v /= total;
  return sum;
}

// Lengths of first (edges) and second (points) derivatives of lightness, seen by an eye whose detectors are
// 0.082 degrees wide (sect. 4.2.1).
struct Features {
  Plane edges, points;
};
Features features_of(const Plane& opponent_y, double ppd) {
  Plane light = opponent_y;
  for (double& v : light.values) v = (v + 16) / 116;
  const double sigma = .5 * .082 * ppd;
  const int reach = int(std::ceil(3 * sigma));
  const auto gauss = [&](double x) { return std::exp(-x * x / (2 * sigma * sigma)); };
  const Kernel smooth = balanced(sampled(reach, gauss));
  const auto lengths = [&](const Kernel& k) {
    Plane x = convolved(light, k, smooth);
    const Plane y = convolved(light, smooth, k);
    for (std::size_t i = 0; i < x.values.size(); ++i) x.values[i] = std::hypot(x.values[i], y.values[i]);
    return x;
  };
  return {
      lengths(balanced(sampled(reach, [&](double x) { return -x * gauss(x); }))),
      lengths(balanced(sampled(reach, [&](double x) { return (x * x / (sigma * sigma) - 1) * gauss(x); })))};
}

Planes opponent_planes(const Image& image, float exposure) {
  const int channels[] = {image.find("R"), image.find("G"), image.find("B")};
  for (const int c : channels) {
    if (c < 0) throw Error("no channels R, G and B", "FLIP", "compare pictures in RGB");
  }
  const std::size_t n = std::size_t(image.width) * std::size_t(image.height);
  Planes planes;
  for (Plane& p : planes) p = {image.width, image.height, std::vector<double>(n)};
  const double gain = std::exp2(double(exposure));
  for (std::size_t i = 0; i < n; ++i) {
    Colour c{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double v = gain * double(image.values[i * image.channels.size() + std::size_t(channels[k])]);
      c[k] = v > 0 ? std::min(v, 1.) : 0;  // NaN is black
    }
    const Colour o = opponent(c);
    for (std::size_t k = 0; k < 3; ++k) planes[k].values[i] = o[k];
  }
  return planes;
}

std::vector<Colour> perceived(const Planes& p, double ppd) {
  const Plane y = blurred(p[0], {{1, .0047}}, ppd), x = blurred(p[1], {{1, .0053}}, ppd),
              z = blurred(p[2], {{34.1, .04}, {13.5, .025}}, ppd);
  std::vector<Colour> colours;
  for (std::size_t i = 0; i < y.values.size(); ++i) {
    Colour c = from_opponent({y.values[i], x.values[i], z.values[i]});
    for (double& v : c) v = std::clamp(v, 0., 1.);
    colours.push_back(hunt(c));
  }
  return colours;
}

}  // namespace

Image flip_difference(const Image& reference, const Image& test, const FlipOptions& options) {
  if (reference.width != test.width || reference.height != test.height)
    throw Error("the pictures differ in size", "FLIP", "render them alike");
  const double ppd = options.pixels_per_degree;
  if (!(ppd > 0 && ppd < 1000)) throw Error("pixels per degree out of range", "FLIP", "give about 67");
  const Planes a = opponent_planes(reference, options.exposure), b = opponent_planes(test, options.exposure);
  const auto seen_a = perceived(a, ppd), seen_b = perceived(b, ppd);
  const Features has_a = features_of(a[0], ppd), has_b = features_of(b[0], ppd);
  Image map = make_image(reference.width, reference.height, {"FLIP"});
  for (std::size_t i = 0; i < seen_a.size(); ++i) {
    const double colour = compressed(hyab(seen_a[i], seen_b[i]));
    const double unlike = std::max(std::abs(has_a.edges.values[i] - has_b.edges.values[i]),
                                   std::abs(has_a.points.values[i] - has_b.points.values[i]));
    const double feature = std::sqrt(std::min(1., unlike / std::sqrt(2.)));  // eq. 9
    map.values[i] = float(std::pow(colour, 1 - feature));                    // eq. 10
  }
  return map;
}

double image_mean(const Image& one_channel) {
  double sum = 0;
  for (const float v : one_channel.values) sum += double(v);
  return one_channel.values.empty() ? 0 : sum / double(one_channel.values.size());
}

Image heat_image(const Image& one_channel) {
  Image map = make_image(one_channel.width, one_channel.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < one_channel.values.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      map.values[3 * i + k] = from_srgb(std::clamp(3 * one_channel.values[i] - float(k), 0.f, 1.f));
  }
  return map;
}

}  // namespace reflectree
