// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/rgl.hpp"

#include <cmath>
#include <map>

#include "reflectree/error.hpp"

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
  throw Error("unsupported: " + what, where, "use an isotropic RGB file (*_rgb.bsdf) of the RGL database");
}

std::map<std::string, Tensor> read_tensors(ByteView bytes, const std::string& where) {
  ByteReader in(bytes, where);
  in.take(magic.size());
  const int major = in.u8();
  in.u8();  // minor versions are compatible
  if (major != 1) unsupported("tensor_file version " + std::to_string(major), where);
  const std::uint32_t fields = in.u32();
  if (fields > max_fields) damaged(std::to_string(fields) + " fields", where);
  std::map<std::string, Tensor> tensors;
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
std::vector<float> floats(const std::map<std::string, Tensor>& tensors, const std::string& name,
                          std::vector<std::uint64_t> wanted, std::vector<std::uint64_t>& shape,
                          const std::string& where) {
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

}  // namespace

bool is_tensor_file(ByteView bytes) { return starts_with(bytes, magic); }

RglFields read_rgl_fields(ByteView bytes, const std::string& where) {
  if (!is_tensor_file(bytes)) {
    throw Error("not a tensor_file", where, "use an isotropic RGB file (*_rgb.bsdf) of the RGL database");
  }
  if (bytes.size() > max_rgl_bytes) {
    throw Error("larger than " + std::to_string(max_rgl_bytes) + " bytes", where, "use a smaller file");
  }
  const auto tensors = read_tensors(bytes, where);
  if (tensors.count("spectra") && !tensors.count("rgb")) unsupported("a spectral material", where);
  for (const char* name : {"phi_i", "theta_i", "rgb", "jacobian"}) {
    if (!tensors.count(name)) unsupported("no field '" + std::string(name) + "'", where);
  }
  const auto& phi_shape = tensors.at("phi_i").shape;
  if (phi_shape.size() != 1 || phi_shape[0] == 0) damaged("field 'phi_i' has an unexpected shape", where);
  if (phi_shape[0] != 1) unsupported("an anisotropic material", where);

  RglFields f;
  f.name = where;
  std::vector<std::uint64_t> shape;
  f.theta_o = floats(tensors, "theta_i", {0}, shape, where);
  const std::uint64_t nodes = shape[0];
  for (std::size_t i = 0; i < f.theta_o.size(); ++i) {
    const float previous = i == 0 ? -1e-6f : f.theta_o[i - 1];
    if (!(f.theta_o[i] > previous && f.theta_o[i] < 1.571f))
      damaged("'theta_i' does not ascend to pi/2", where);
  }
  f.sigma = floats(tensors, "sigma", {0, 0}, shape, where);
  f.sigma = row(std::move(f.sigma), shape[1], "sigma", where);
  f.ndf = floats(tensors, "ndf", {0, 0}, shape, where);
  f.ndf = row(std::move(f.ndf), shape[1], "ndf", where);
  f.vndf = floats(tensors, "vndf", {1, nodes, 0, 0}, shape, where);
  f.warp_height = int(shape[2]), f.warp_width = int(shape[3]);
  f.rgb = floats(tensors, "rgb", {1, nodes, 3, 0, 0}, shape, where);
  f.colour_height = int(shape[3]), f.colour_width = int(shape[4]);
  const Tensor& jacobian = tensors.at("jacobian");
  if (jacobian.type != type_u8 || jacobian.data.size() != 1)
    damaged("field 'jacobian' has an unexpected shape", where);
  f.jacobian = jacobian.data[0] != 0;

  for (const float s : f.sigma) {
    if (!(s >= smallest_sigma)) damaged("'sigma' is not positive", where);
  }
  // Colours and the distribution of normals may be negative by noise; a density that a warp inverts may not.
  for (const float v : f.vndf) {
    if (v < 0) damaged("'vndf' is a density and holds a negative value", where);
  }
  return f;
}

RglTable read_rgl(ByteView bytes, const std::string& where) {
  return RglTable(read_rgl_fields(bytes, where));
}

}  // namespace reflectree
