// SPDX-License-Identifier: Apache-2.0
// Writer of RGL files: named fields of numbers, each aligned to 8 bytes.
#include "reflectree/formats/rgl_fit.hpp"

namespace reflectree {
namespace {

void append_u16(Bytes& out, unsigned v) {
  out.push_back(std::uint8_t(v & 0xffU));
  out.push_back(std::uint8_t(v >> 8U));
}

struct Field {
  const char* name;
  std::uint8_t type;  // 1: bytes, 10: floats
  std::vector<std::uint64_t> shape;
  Bytes data;
};

Field floats(const char* name, std::vector<std::uint64_t> shape, const std::vector<float>& values) {
  Field field{name, 10, std::move(shape), {}};
  field.data.reserve(values.size() * 4);
  for (const float v : values) append_f32(field.data, v);
  return field;
}

std::uint64_t aligned(std::uint64_t offset) { return (offset + 7) / 8 * 8; }

}  // namespace

Bytes write_rgl(const RglFit& fit, const std::string& description) {
  const RglWideFields& f = fit.fields;
  const auto u64 = [](auto n) { return std::uint64_t(n); };
  const std::uint64_t azimuths = f.phi_o.size(), elevations = f.theta_o.size(), h = u64(f.colour_height),
                      w = u64(f.colour_width);
  std::vector<Field> fields{{"version", 1, {2}, {1, 0}}, {"description", 1, {description.size()}, {}}};
  append_text(fields.back().data, description);
  fields.push_back(floats("phi_i", {azimuths}, f.phi_o));
  fields.push_back(floats("theta_i", {elevations}, f.theta_o));
  fields.push_back(floats("sigma", {u64(f.sigma.height), u64(f.sigma.width)}, f.sigma.values));
  fields.push_back(floats("ndf", {u64(f.ndf.height), u64(f.ndf.width)}, f.ndf.values));
  fields.push_back(floats("vndf", {azimuths, elevations, u64(f.warp_height), u64(f.warp_width)}, f.vndf));
  fields.push_back(floats("luminance", {azimuths, elevations, h, w}, fit.luminance));
  fields.push_back(floats("rgb", {azimuths, elevations, 3, h, w}, f.colours));
  fields.push_back({"jacobian", 1, {1}, {std::uint8_t(f.jacobian)}});
  std::uint64_t header = 18;
  for (const Field& field : fields)
    header += 2 + std::string_view(field.name).size() + 11 + 8 * field.shape.size();
  Bytes out;
  append_text(out, std::string_view("tensor_file\0\x01\x00", 14));
  append_u32(out, std::uint32_t(fields.size()));
  std::uint64_t offset = aligned(header);
  for (const Field& field : fields) {
    append_u16(out, unsigned(std::string_view(field.name).size()));
    append_text(out, field.name);
    append_u16(out, unsigned(field.shape.size()));
    out.push_back(field.type);
    append_u64(out, offset);
    for (const std::uint64_t n : field.shape) append_u64(out, n);
    offset = aligned(offset + field.data.size());
  }
  for (const Field& field : fields) {
    out.resize(std::size_t(aligned(out.size())));
    out.insert(out.end(), field.data.begin(), field.data.end());
  }
  return out;
}

}  // namespace reflectree
