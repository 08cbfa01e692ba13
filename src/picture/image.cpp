// SPDX-License-Identifier: Apache-2.0
#include "reflectree/picture/image.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/file_kind.hpp"

namespace reflectree {

int Image::find(const std::string& name) const {
  const auto at = std::find(channels.begin(), channels.end(), name);
  return at == channels.end() ? -1 : int(at - channels.begin());
}

Image make_image(int width, int height, std::vector<std::string> channels) {
  constexpr std::uint64_t most = std::uint64_t(1) << 28U;
  const auto size = std::to_string(width) + " x " + std::to_string(height);
  if (width <= 0 || height <= 0 || channels.empty()) {
    throw Error("an empty picture: " + size, "image", "give it a positive width and height");
  }
  const std::uint64_t count = std::uint64_t(width) * std::uint64_t(height);
  if (count > most / channels.size()) throw Error("too large: " + size, "image", "make it smaller");
  Image image{width, height, std::move(channels), {}, {}};
  image.values.resize(std::size_t(count) * image.channels.size());
  return image;
}

namespace {

// By its name, or by what its second version ends with.
bool is_tga(ByteView bytes, const std::string& path) {
  std::string end = path.substr(path.size() - std::min<std::size_t>(path.size(), 4));
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return end == ".tga" || (bytes.size() >= 18 && starts_with(bytes.last(18), "TRUEVISION-XFILE."));
}

}  // namespace

Image read_image(const std::string& path) {
  const Bytes bytes = read_file(path, std::uint64_t(1) << 30U);
  if (starts_with(bytes, "#?")) return read_hdr(bytes, path);
  if (starts_with(bytes, "\x76\x2f\x31\x01")) return read_exr(bytes, path);
  if (starts_with(bytes, "\x89PNG")) return read_png(bytes, path);
  if (starts_with(bytes, "\xff\xd8\xff")) return read_jpeg(bytes, path);
  if (starts_with(bytes, "BM")) return read_bmp(bytes, path);
  if (is_tga(bytes, path)) return read_tga(bytes, path);
  refuse_recognised(bytes, path, "convert it to PNG or OpenEXR");
  throw Error("neither Radiance .hdr, OpenEXR, PNG, JPEG, BMP nor TGA", path,
              "convert the picture to one of them");
}

float to_srgb(float v) { return v <= .0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - .055f; }
float from_srgb(float v) { return v <= .04045f ? v / 12.92f : std::pow((v + .055f) / 1.055f, 2.4f); }

}  // namespace reflectree
