// SPDX-License-Identifier: Apache-2.0
// Which channels of a picture are its colours. OpenEXR lists channels by the alphabet, so that B, G, R is
// what a file of three begins with and A what one of four does: names alone tell.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/picture/image.hpp"

namespace reflectree {

namespace {

// The channels of one layer; -1: not there.
struct Layer {
  std::string name;
  int r = -1, g = -1, b = -1, x = -1, y = -1, z = -1, ry = -1, by = -1;
  bool some_rgb() const { return r >= 0 || g >= 0 || b >= 0; }
  bool xyz() const { return x >= 0 && y >= 0 && z >= 0; }
  bool shows() const { return some_rgb() || y >= 0; }
};

std::vector<Layer> layers_of(const Image& p) {
  std::vector<Layer> all;
  for (std::size_t i = 0; i < p.channels.size(); ++i) {
    const std::string& whole = p.channels[i];
    const std::size_t dot = whole.rfind('.');
    const std::string layer = dot == std::string::npos ? "" : whole.substr(0, dot);
    std::string name = dot == std::string::npos ? whole : whole.substr(dot + 1);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return char(std::toupper(c)); });
    auto at = std::find_if(all.begin(), all.end(), [&](const Layer& l) { return l.name == layer; });
    if (at == all.end()) at = all.insert(at, Layer{layer});
    const std::pair<const char*, int Layer::*> places[] = {
        {"R", &Layer::r}, {"G", &Layer::g}, {"B", &Layer::b},   {"X", &Layer::x},
        {"Y", &Layer::y}, {"Z", &Layer::z}, {"RY", &Layer::ry}, {"BY", &Layer::by}};
    for (const auto& [word, place] : places) {
      if (name == word) (*at).*place = int(i);
    }
  }
  return all;
}

std::string names_of(const Image& p) {
  std::string all;
  for (const std::string& name : p.channels) all += (all.empty() ? "" : ", ") + name;
  return all;
}

Layer shown(const Image& p, const std::string& where) {
  const std::vector<Layer> all = layers_of(p);
  const Layer* found = nullptr;
  for (const Layer& l : all) {
    if (!l.shows()) continue;
    if (l.name.empty()) return l;
    if (found) {
      throw Error("colours in several layers, '" + found->name + "' and '" + l.name + "'", where,
                  "save one of them as R, G and B");
    }
    found = &l;
  }
  if (!found) {
    throw Error("no channels R, G and B, and no Y: " + names_of(p), where, "name the channels so");
  }
  return *found;
}

}  // namespace

Image colours_of(const Image& p, const std::string& where, bool raw) {
  const Layer l = shown(p, where);
  if (l.some_rgb() && std::min({l.r, l.g, l.b}) < 0) {
    const char* missing = l.r < 0 ? "R" : l.g < 0 ? "G" : "B";
    throw Error(std::string("no channel ") + missing + " beside " + names_of(p), where,
                "save R, G and B, or Y alone");
  }
  if (!l.some_rgb() && (l.ry >= 0 || l.by >= 0))
    throw Error("luminance and chroma, Y, RY and BY", where, "save it as R, G and B");
  const bool coloured = l.some_rgb() || l.xyz();
  Image out = make_image(p.width, p.height,
                         coloured ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"});
  out.metadata = p.metadata, out.encoded = raw && p.encoded;
  const std::array<int, 3> from = l.some_rgb() ? std::array{l.r, l.g, l.b}
                                  : l.xyz()    ? std::array{l.x, l.y, l.z}
                                               : std::array{l.y, l.y, l.y};
  const std::size_t n = out.channels.size(), stride = p.channels.size();
  for (std::size_t i = 0; i * n < out.values.size(); ++i) {
    float* to = out.values.data() + i * n;
    for (std::size_t k = 0; k < n; ++k) {
      const float v = p.values[i * stride + std::size_t(from[k])];
      if (!std::isfinite(v)) {
        throw Error("pixel (" + std::to_string(i % std::size_t(p.width)) + ", " +
                        std::to_string(i / std::size_t(p.width)) + ") is not finite in channel " +
                        p.channels[std::size_t(from[k])],
                    where, "mend the picture");
      }
      to[k] = p.encoded && !raw ? from_srgb(v) : v;
    }
    if (!l.some_rgb() && l.xyz()) {  // IEC 61966-2-1
      const float x = to[0], y = to[1], z = to[2];
      to[0] = 3.240479f * x - 1.537150f * y - .498535f * z;
      to[1] = -.969256f * x + 1.875991f * y + .041556f * z;
      to[2] = .055648f * x - .204043f * y + 1.057311f * z;
    }
  }
  return out;
}

Image rgb_of(const Image& picture, const std::string& where) {
  Image grey = colours_of(picture, where);
  if (grey.channels.size() == 3) return grey;
  Image out = make_image(grey.width, grey.height, {"R", "G", "B"});
  out.metadata = grey.metadata;
  for (std::size_t i = 0; i < grey.values.size(); ++i)
    std::fill_n(out.values.begin() + std::ptrdiff_t(3 * i), 3, grey.values[i]);
  return out;
}

}  // namespace reflectree
