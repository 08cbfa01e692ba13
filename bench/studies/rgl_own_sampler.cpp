// SPDX-License-Identifier: Apache-2.0
#include "rgl_own_sampler.hpp"

#include <algorithm>

#include "reflectree/error.hpp"
#include "reflectree/formats/bytes.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/rgl.hpp"
#include "reflectree/math/frame.hpp"
#include "reflectree/peers/bilinear_table.hpp"
#include "reflectree/peers/density.hpp"

namespace reflectree::study {

namespace {

struct Field {
  std::vector<std::uint64_t> shape;
  std::vector<float> values;
};

// One field of 32-bit floats. That the file is whole its own reader has seen.
Field read_field(ByteView bytes, const std::string& wanted, const std::string& path) {
  ByteReader in(bytes, path);
  in.take(12 + 2);  // the magic and the version
  for (std::uint32_t left = in.u32(); left > 0; --left) {
    const std::string name = in.text(in.u16());
    const int dimensions = in.u16();
    const int type = in.u8();
    const std::uint64_t offset = in.u64();
    Field field;
    std::uint64_t count = 1;
    for (int d = 0; d < dimensions; ++d) field.shape.push_back(in.u64()), count *= field.shape.back();
    if (name != wanted || type != 10) continue;
    ByteReader data(bytes, path);
    data.seek(offset);
    for (; count > 0; --count) field.values.push_back(max(data.f32(), 0.f));
    return field;
  }
  throw Error("no field '" + wanted + "'", path, "use an isotropic RGB file of the RGL database");
}

// One table per elevation: [1][theta][height][width], in the file's square, u = sqrt(2 theta / pi) across.
std::vector<BilinearTable> tables_of(const Field& field, const std::string& path) {
  if (field.shape.size() != 4 || field.shape[0] != 1) throw Error("not isotropic", path, "use another file");
  std::vector<BilinearTable> tables;
  const auto height = std::size_t(field.shape[2]), width = std::size_t(field.shape[3]);
  for (std::size_t k = 0; k < field.shape[1]; ++k) {
    tables.emplace_back(std::span(field.values).subspan(k * height * width, height * width), int(width),
                        int(height));
  }
  return tables;
}

struct OwnDensity {
  std::vector<float> theta_o;
  std::vector<BilinearTable> normals, luminance;

  struct Place {
    BilinearTable::Pair normals, luminance;
  };
  Place place(Direction wo) const {
    const float theta = theta_of(wo);
    const auto above = std::upper_bound(theta_o.begin() + 1, theta_o.end() - 1, theta);
    const auto i = std::size_t(above - theta_o.begin()) - 1;
    const float t = std::clamp((theta - theta_o[i]) / (theta_o[i + 1] - theta_o[i]), 0.f, 1.f);
    return {{normals[i], normals[i + 1], t}, {luminance[i], luminance[i + 1], t}};
  }
  // Of the half vector's place on the square: a solid angle is sin theta_h * d theta_h * d phi.
  static float jacobian(float u, Direction wo, Direction wh) {
    const float sin_theta = sqrt(max(0.f, 1 - wh.z * wh.z));
    return max(2 * pi * pi * u * sin_theta, 1e-6f) * 4 * max(dot(wo, wh), 1e-6f);
  }
  std::optional<DrawnFromDensity> sample(Direction wo, UniformBits& bits) const {
    const Place p = place(wo);
    const Vec2<float> s = p.luminance.sample(bits), m = p.normals.warp(double(s.x), double(s.y));
    const float theta = 0.5f * pi * m.x * m.x, phi = (2 * m.y - 1) * pi + std::atan2(wo.y, wo.x);
    const Direction wh = direction_from_angles(theta, phi);
    const Direction wi = 2 * dot(wo, wh) * wh - wo;
    if (!(wi.z > 0)) return std::nullopt;
    return DrawnFromDensity{wi, p.normals.pdf(m) * p.luminance.pdf(s) / jacobian(m.x, wo, wh)};
  }
  float pdf(Direction wo, Direction wi) const {
    const Direction wh = normalize(wo + wi);
    const float u = sqrt(theta_of(wh) * 2 / pi);
    float turn = (std::atan2(wh.y, wh.x) - std::atan2(wo.y, wo.x)) / (2 * pi) + 0.5f;
    turn -= std::floor(turn);
    const Place p = place(wo);
    const Vec2<double> s = p.normals.unwarp({u, turn});
    return p.normals.pdf({u, turn}) * p.luminance.pdf({float(s.x), float(s.y)}) / jacobian(u, wo, wh);
  }
  std::size_t bytes() const {
    std::size_t sum = theta_o.size() * sizeof(float);
    for (const BilinearTable& t : normals) sum += t.bytes();
    for (const BilinearTable& t : luminance) sum += t.bytes();
    return sum;
  }
};

}  // namespace

AnySampler<Spectrum> rgl_own_sampler(const std::string& path, const AnyBrdf& f) {
  const Bytes bytes = read_file(path, max_rgl_bytes);
  OwnDensity own{read_field(bytes, "theta_i", path).values, tables_of(read_field(bytes, "vndf", path), path),
                 tables_of(read_field(bytes, "luminance", path), path)};
  if (own.theta_o.size() < 2 || own.normals.size() != own.theta_o.size() ||
      own.luminance.size() != own.theta_o.size())
    throw Error("fields of unequal size", path, "fetch the file again");
  const std::size_t size = own.bytes();
  return {"file's own", WeightedSampler<AnyBrdf, OwnDensity>(f, std::move(own)), size};
}

std::vector<float> rgl_elevations(const std::string& path) {
  return read_field(read_file(path, max_rgl_bytes), "theta_i", path).values;
}

}  // namespace reflectree::study
