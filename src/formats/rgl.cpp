// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/rgl.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>

#include "reflectree/error.hpp"
#include "spectral_colour.hpp"

namespace reflectree {
namespace {

constexpr std::string_view magic{"tensor_file\0", 12};
constexpr std::uint32_t max_fields = 64;
constexpr std::size_t max_name = 64;
constexpr float largest = 1e9f, smallest_sigma = 1e-6f;  // of plausible values: products stay finite
constexpr std::uint64_t max_side = 4096;  // of any grid: keeps index arithmetic far from overflow
enum : std::uint8_t { type_u8 = 1, type_f32 = 10, type_last = 11 };
constexpr std::uint64_t type_bytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};

struct Tensor {
  std::uint8_t type = 0;
  std::vector<std::uint64_t> shape;
  ByteView data;
};

[[noreturn]] void damaged(const std::string& what, const std::string& where) {
  throw Error("damaged: " + what, where, "fetch the file again");
}
[[noreturn]] void unsupported(const std::string& what, const std::string& where) {
  throw Error("unsupported: " + what, where, "use a file of the RGL database");
}

using Tensors = std::map<std::string, Tensor>;

Tensors read_tensors(ByteView bytes, const std::string& where) {
  ByteReader in(bytes, where);
  in.take(magic.size());
  const int major = in.u8();
  in.u8();  // minor versions are compatible
  if (major != 1) unsupported("tensor_file version " + std::to_string(major), where);
  const std::uint32_t fields = in.u32();
  if (fields > max_fields) damaged(std::to_string(fields) + " fields", where);
  Tensors tensors;
  for (std::uint32_t i = 0; i < fields; ++i) {
    const std::string name = in.text(in.u16());
    if (name.size() > max_name) damaged("a field's name of " + std::to_string(name.size()) + " bytes", where);
    Tensor t;
    const int dimensions = in.u16();
    t.type = in.u8();
    const std::uint64_t offset = in.u64();
    if (dimensions > 8) damaged("a field of " + std::to_string(dimensions) + " dimensions", where);
    if (t.type == 0 || t.type > type_last) damaged("field type " + std::to_string(t.type), where);
    std::uint64_t size = type_bytes[t.type];
    for (int d = 0; d < dimensions; ++d) {
      t.shape.push_back(in.u64());
      if (t.shape.back() > bytes.size()) damaged("field '" + name + "' is larger than the file", where);
      size *= t.shape.back();  // both factors <= file size < 2^32
      if (size > bytes.size()) damaged("field '" + name + "' is larger than the file", where);
    }
    ByteReader data(bytes, where);
    data.seek(offset);
    t.data = data.take(size);
    tensors[name] = t;
  }
  return tensors;
}

// A field of 32-bit floats, all within the bounds below, of the shape wanted; 0 there stands for any length
// in [2, max_side].
std::vector<float> floats(const Tensors& tensors, const std::string& name, std::vector<std::uint64_t> wanted,
                          std::vector<std::uint64_t>& shape, const std::string& where) {
  const auto found = tensors.find(name);
  if (found == tensors.end()) unsupported("no field '" + name + "'", where);
  const Tensor& t = found->second;
  if (t.type != type_f32) unsupported("field '" + name + "' is not of 32-bit floats", where);
  bool fits = t.shape.size() == wanted.size();
  for (std::size_t d = 0; fits && d < wanted.size(); ++d) {
    fits = wanted[d] == 0 ? t.shape[d] >= 2 && t.shape[d] <= max_side : t.shape[d] == wanted[d];
  }
  if (!fits) damaged("field '" + name + "' has an unexpected shape", where);
  ByteReader in(t.data, where);
  std::vector<float> values(t.data.size() / 4);
  for (float& v : values) {
    v = in.f32();
    if (!(std::abs(v) <= largest)) damaged("field '" + name + "' holds an impossible value", where);
  }
  shape = t.shape;
  return values;
}

// Tables over (v, u) that isotropy makes independent of v: one row.
std::vector<float> row(std::vector<float> table, std::uint64_t width, const std::string& name,
                       const std::string& where) {
  for (std::size_t i = std::size_t(width); i < table.size(); ++i) {
    if (table[i] != table[i - std::size_t(width)]) unsupported("'" + name + "' varies with azimuth", where);
  }
  table.resize(std::size_t(width));
  return table;
}

Tensors read_material_tensors(ByteView bytes, const std::string& where) {
  if (!is_tensor_file(bytes)) {
    throw Error("not a tensor_file", where, "use a file of the RGL database");
  }
  if (bytes.size() > max_rgl_bytes) {
    throw Error("larger than " + std::to_string(max_rgl_bytes) + " bytes", where, "use a smaller file");
  }
  return read_tensors(bytes, where);
}

void demand(const Tensors& tensors, std::initializer_list<const char*> names, const std::string& where) {
  for (const char* name : names) {
    if (!tensors.count(name)) unsupported("no field '" + std::string(name) + "'", where);
  }
}

std::uint64_t azimuth_count(const Tensors& tensors, const std::string& where) {
  const auto& shape = tensors.at("phi_i").shape;
  if (shape.size() != 1 || shape[0] == 0) damaged("field 'phi_i' has an unexpected shape", where);
  return shape[0];
}

bool is_spectral(const Tensors& tensors) { return tensors.count("spectra") && !tensors.count("rgb"); }

std::vector<float> elevations(const Tensors& tensors, const std::string& where) {
  std::vector<std::uint64_t> shape;
  std::vector<float> theta = floats(tensors, "theta_i", {0}, shape, where);
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const float previous = i == 0 ? -1e-6f : theta[i - 1];
    if (!(theta[i] > previous && theta[i] < 1.571f)) damaged("'theta_i' does not ascend to pi/2", where);
  }
  return theta;
}

bool jacobian(const Tensors& tensors, const std::string& where) {
  const Tensor& t = tensors.at("jacobian");
  if (t.type != type_u8 || t.data.size() != 1) damaged("field 'jacobian' has an unexpected shape", where);
  return t.data[0] != 0;
}

// Colours and the distribution of normals may be negative by noise; a density that a warp inverts may not.
void check_signs(const std::vector<float>& sigma, const std::vector<float>& vndf, const std::string& where) {
  for (const float s : sigma) {
    if (!(s >= smallest_sigma)) damaged("'sigma' is not positive", where);
  }
  for (const float v : vndf) {
    if (v < 0) damaged("'vndf' is a density and holds a negative value", where);
  }
}

RglSquare square(const Tensors& tensors, const std::string& name, const std::string& where) {
  RglSquare table;
  std::vector<std::uint64_t> shape;
  table.values = floats(tensors, name, {0, 0}, shape, where);
  table.height = int(shape[0]), table.width = int(shape[1]);
  return table;
}

// What a turn is divided by. Nodes of azimuths begin at -pi, where the readers of these files fold them to.
int reduction_of(const std::vector<float>& phi, const std::string& where) {
  for (std::size_t i = 1; i < phi.size(); ++i) {
    if (!(phi[i] > phi[i - 1])) damaged("'phi_i' does not ascend", where);
  }
  const float span = phi.back() - phi.front(), near = 0.01f;
  for (const int reduction : {1, 2, 4}) {
    if (std::abs(span * float(reduction) - 2 * pi) < near && std::abs(phi.front() + pi) < near)
      return reduction;
  }
  unsupported("azimuths that do not go from -pi over a turn, a half or a quarter of one", where);
}

// Two azimuths make no anisotropic file: readers take such a one for isotropic.
void keep_first_of_two(RglWideFields& f, const std::string& where) {
  for (std::vector<float>* table : {&f.vndf, &f.colours}) {
    const std::size_t half = table->size() / 2;
    if (!std::equal(table->begin(), table->begin() + std::ptrdiff_t(half),
                    table->begin() + std::ptrdiff_t(half)))
      unsupported("two azimuths that differ", where);
    table->resize(half);
  }
  f.phi_o = {0};
}

// The colours of spectra, channel by channel.
void reduce_to_rgb(RglWideFields& f, const std::vector<float>& wavelengths) {
  const std::vector<Rgb> weights = rgb_of_wavelengths(wavelengths);
  const std::size_t plane = std::size_t(f.colour_width) * std::size_t(f.colour_height), n = weights.size();
  std::vector<float> rgb(f.colours.size() / n * 3);
  for (std::size_t slice = 0; slice * n * plane < f.colours.size(); ++slice) {
    for (std::size_t i = 0; i < plane; ++i) {
      double sum[3] = {0, 0, 0};
      for (std::size_t c = 0; c < n; ++c) {
        const double v = double(f.colours[(slice * n + c) * plane + i]);
        sum[0] += v * double(weights[c].r), sum[1] += v * double(weights[c].g),
            sum[2] += v * double(weights[c].b);
      }
      for (std::size_t c = 0; c < 3; ++c) rgb[(slice * 3 + c) * plane + i] = float(sum[c]);
    }
  }
  f.colours = std::move(rgb), f.channels = 3;
}

}  // namespace

bool is_tensor_file(ByteView bytes) { return starts_with(bytes, magic); }

RglFields read_rgl_fields(ByteView bytes, const std::string& where) {
  const Tensors tensors = read_material_tensors(bytes, where);
  if (is_spectral(tensors)) unsupported("a spectral material", where);
  demand(tensors, {"phi_i", "theta_i", "rgb", "jacobian"}, where);
  if (azimuth_count(tensors, where) != 1) unsupported("an anisotropic material", where);

  RglFields f;
  f.name = where;
  f.theta_o = elevations(tensors, where);
  const std::uint64_t nodes = f.theta_o.size();
  std::vector<std::uint64_t> shape;
  f.sigma = floats(tensors, "sigma", {0, 0}, shape, where);
  f.sigma = row(std::move(f.sigma), shape[1], "sigma", where);
  f.ndf = floats(tensors, "ndf", {0, 0}, shape, where);
  f.ndf = row(std::move(f.ndf), shape[1], "ndf", where);
  f.vndf = floats(tensors, "vndf", {1, nodes, 0, 0}, shape, where);
  f.warp_height = int(shape[2]), f.warp_width = int(shape[3]);
  f.rgb = floats(tensors, "rgb", {1, nodes, 3, 0, 0}, shape, where);
  f.colour_height = int(shape[3]), f.colour_width = int(shape[4]);
  f.jacobian = jacobian(tensors, where);
  check_signs(f.sigma, f.vndf, where);
  return f;
}

RglTable read_rgl(ByteView bytes, const std::string& where) {
  return RglTable(read_rgl_fields(bytes, where));
}

RglLayout rgl_layout(ByteView bytes, const std::string& where) {
  const Tensors tensors = read_material_tensors(bytes, where);
  demand(tensors, {"phi_i"}, where);
  RglLayout layout;
  layout.azimuths = azimuth_count(tensors, where);
  if (!is_spectral(tensors)) return layout;
  demand(tensors, {"wavelengths"}, where);
  std::vector<std::uint64_t> shape;
  layout.wavelengths = floats(tensors, "wavelengths", {0}, shape, where);
  for (std::size_t i = 0; i < layout.wavelengths.size(); ++i) {
    if (!(layout.wavelengths[i] > (i == 0 ? 0 : layout.wavelengths[i - 1])))
      damaged("'wavelengths' does not ascend", where);
  }
  return layout;
}

RglWideFields read_rgl_wide_fields(ByteView bytes, const std::string& where, bool as_rgb) {
  const RglLayout layout = rgl_layout(bytes, where);
  const Tensors tensors = read_material_tensors(bytes, where);
  const bool spectral = !layout.wavelengths.empty();
  const char* colours = spectral ? "spectra" : "rgb";
  demand(tensors, {"theta_i", colours, "jacobian"}, where);
  RglWideFields f;
  f.name = where;
  f.theta_o = elevations(tensors, where);
  const std::uint64_t nodes = f.theta_o.size(), azimuths = layout.azimuths;
  f.channels = spectral ? int(layout.wavelengths.size()) : 3;
  std::vector<std::uint64_t> shape;
  if (azimuths > 2) {
    f.phi_o = floats(tensors, "phi_i", {0}, shape, where);
    f.reduction = reduction_of(f.phi_o, where);
  }
  f.sigma = square(tensors, "sigma", where), f.ndf = square(tensors, "ndf", where);
  f.vndf = floats(tensors, "vndf", {azimuths, nodes, 0, 0}, shape, where);
  f.warp_height = int(shape[2]), f.warp_width = int(shape[3]);
  f.colours = floats(tensors, colours, {azimuths, nodes, std::uint64_t(f.channels), 0, 0}, shape, where);
  f.colour_height = int(shape[3]), f.colour_width = int(shape[4]);
  f.jacobian = jacobian(tensors, where);
  check_signs(f.sigma.values, f.vndf, where);
  if (azimuths == 2) keep_first_of_two(f, where);
  if (spectral && (as_rgb || f.channels > max_channels)) reduce_to_rgb(f, layout.wavelengths);
  return f;
}

}  // namespace reflectree
