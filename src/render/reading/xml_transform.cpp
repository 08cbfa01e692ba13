// SPDX-License-Identifier: Apache-2.0
#include "reflectree/error.hpp"
#include "xml_reader.hpp"

namespace reflectree::render {

namespace {

Matrix turn_about(Vec3<double> a, double degrees) {  // Rodrigues
  const double t = degrees * pi_v<double> / 180, c = std::cos(t), s = std::sin(t);
  const double axis[3] = {a.x, a.y, a.z};
  const double turn[3][3] = {{0, -a.z, a.y}, {a.z, 0, -a.x}, {-a.y, a.x, 0}};
  Matrix m = identity;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      m[i][j] = (i == j ? c : 0) + (1 - c) * axis[i] * axis[j] + s * turn[i][j];
  }
  return m;
}

}  // namespace

Matrix XmlReader::operation(Node op) const {
  const std::string_view tag = op.name();
  Matrix m = identity;
  if (tag == "translate" || tag == "scale") {
    const bool scales = tag == "scale";
    std::array<double, 3> v{scales ? 1. : 0., scales ? 1. : 0., scales ? 1. : 0.};
    if (op.attribute("value")) {
      const auto all = numbers(op, text(op, "value"));
      if (all.size() != 1 && all.size() != 3) fail(op, "one or three numbers are needed", "write x, y, z");
      for (std::size_t i = 0; i < 3; ++i) v[i] = all[all.size() == 1 ? 0 : i];
    }
    v = {number(op, "x", v[0]), number(op, "y", v[1]), number(op, "z", v[2])};
    for (std::size_t i = 0; i < 3; ++i) (scales ? m[i][i] : m[i][3]) = v[i];
    return m;
  }
  if (tag == "rotate") {
    const Vec3<double> axis = op.attribute("value")
                                  ? triple(op, "value")
                                  : Vec3<double>{number(op, "x", 0), number(op, "y", 0), number(op, "z", 0)};
    return turn_about(normalize(axis), number(op, "angle", 0));
  }
  if (tag == "lookat") {
    const auto o = triple(op, "origin"), d = normalize(triple(op, "target") - o);
    if (!op.attribute("up")) fail(op, "<lookat> without 'up'", "add up=\"x, y, z\"");
    const auto left = normalize(cross(triple(op, "up"), d)), up = cross(d, left);
    return {{{left.x, up.x, d.x, o.x}, {left.y, up.y, d.y, o.y}, {left.z, up.z, d.z, o.z}, {0, 0, 0, 1}}};
  }
  if (tag == "matrix") {  // by rows; nine numbers: without translation
    const auto v = numbers(op, text(op, "value"));
    if (v.size() != 16 && v.size() != 9) fail(op, "a matrix has 16 or 9 numbers", "write it by rows");
    const std::size_t n = v.size() == 16 ? 4 : 3;
    for (std::size_t i = 0; i < v.size(); ++i) m[i / n][i % n] = v[i];
    if (m[3] != identity[3]) fail(op, "the matrix is not affine", "end it with 0 0 0 1");
    return m;
  }
  fail(op, "no transform '" + std::string(tag) + "'", "use translate, scale, rotate, lookat or matrix");
}

// Each operation acts on what those before it have made.
Matrix XmlReader::transform(Node n) const {
  Matrix all = identity;
  if (n) need(n, {"transform"}, "a transform");
  for (const Node op : n.children()) {
    if (op.type() == pugi::node_element) all = operation(op) * all;
  }
  for (const auto& row : all) {
    for (const double v : row) {
      if (!std::isfinite(v)) fail(n, "the transform is not finite", "check axes, up and target");
      if (std::abs(v) > largest_coordinate) fail(n, "the transform reaches beyond 1e15", "use larger units");
    }
  }
  return all;
}

LocalFrame<float> XmlReader::rotation(Node n, const char* name) const {
  const Node c = named(n, name);
  const Matrix m = transform(c);
  const auto axis = [&](Vec3<double> v) { return apply_double(m, v, 0); };
  const Vec3<double> x = axis({1, 0, 0}), y = axis({0, 1, 0}), z = axis({0, 0, 1});
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-3; };
  if (!near(dot(x, x), 1) || !near(dot(y, y), 1) || !near(dot(z, z), 1) || !near(dot(x, y), 0) ||
      !near(dot(y, z), 0) || !near(dot(z, x), 0))
    fail(c, "'" + std::string(name) + "' scales, and may only turn and move here", "leave the scale out");
  return {to_float(normalize(x)), to_float(normalize(y)), to_float(normalize(z))};
}

}  // namespace reflectree::render
