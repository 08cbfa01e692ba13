// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/sampler_data.hpp"

#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/sampler/albedo.hpp"

namespace reflectree {

const char* name_of(DomainKind kind) {
  switch (kind) {
    case DomainKind::projected_disk:
      return "projected_disk";
    case DomainKind::equal_area:
      return "equal_area";
    case DomainKind::half_vector:
      return "half_vector";
    case DomainKind::back_vector:
      return "back_vector";
    case DomainKind::stretched:
      return "stretched";
    case DomainKind::mirror_vector:
      return "mirror_vector";
    case DomainKind::normal_vector:
      return "normal_vector";
  }
  return "unknown";
}

std::vector<SquareCell> leaf_cells(const std::vector<TreeSplit>& nodes, const Domain& domain) {
  std::vector<SquareCell> cells, stack{{-1, 1, domain.half ? 0.f : -1.f, 1}};
  for (const TreeSplit split : nodes) {
    if (stack.empty()) break;
    const SquareCell c = stack.back();
    stack.pop_back();
    if (split == TreeSplit::leaf) {
      cells.push_back(c);
    } else if (split == TreeSplit::x) {
      const float mid = 0.5f * (c.x0 + c.x1);
      stack.push_back({mid, c.x1, c.y0, c.y1});
      stack.push_back({c.x0, mid, c.y0, c.y1});
    } else {
      const float mid = 0.5f * (c.y0 + c.y1);
      stack.push_back({c.x0, c.x1, mid, c.y1});
      stack.push_back({c.x0, c.x1, c.y0, mid});
    }
  }
  return cells;
}

namespace {

[[noreturn]] void fail(const std::string& what, const std::string& where) {
  throw Error(what, where, "build the sampler again");
}

// Complete preorder tree of at most 15 levels an axis, one nonzero mass a leaf.
void check_tree(const CanonicalTree& tree, const std::string& where) {
  struct Levels {
    int x, y;
  };
  std::vector<Levels> stack{{0, 0}};
  std::size_t leaves = 0;
  for (const TreeSplit split : tree.nodes) {
    if (stack.empty()) fail("the tree goes on after its end", where);
    const Levels l = stack.back();
    stack.pop_back();
    if (split == TreeSplit::leaf) {
      ++leaves;
      continue;
    }
    if (split != TreeSplit::x && split != TreeSplit::y) fail("unknown kind of node", where);
    const Levels child{l.x + (split == TreeSplit::x), l.y + (split == TreeSplit::y)};
    if (child.x > 15 || child.y > 15) fail("the tree is deeper than 15 levels an axis", where);
    stack.push_back(child);
    stack.push_back(child);
  }
  if (!stack.empty()) fail("the tree is incomplete", where);
  if (leaves > 65535) fail("more than 65535 leaves", where);
  if (tree.mass.size() != leaves || tree.slope_x.size() != leaves || tree.slope_y.size() != leaves) {
    fail("one mass and two slopes a leaf are needed", where);
  }
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < leaves; ++i) {
    if (tree.mass[i] == 0) fail("a leaf has lost its support (mass 0)", where);
    if (tree.slope_x[i] == -128 || tree.slope_y[i] == -128)
      fail("a slope empties an edge of its leaf", where);
    sum += tree.mass[i];
  }
  if (sum > 0xffffffffULL) fail("the masses sum to more than 2^32 - 1", where);
}

}  // namespace

void validate(const SamplerData& data) {
  validate(data.exact_partition);
  validate(data.one_shot_partition);
  const auto is_theta = [](const Partition& p) {
    return p.coordinates.size() == 1 && p.coordinates[0].name == "theta_o";
  };
  if (!is_theta(data.exact_partition) || !is_theta(data.one_shot_partition)) {
    fail("this version serves one known coordinate, theta_o", "partition of the known coordinates");
  }
  const auto spans_hemisphere = [](const Partition& p) {
    return p.coordinates[0].lo == 0 && p.coordinates[0].hi > 1.5707f && p.coordinates[0].hi <= 0.5f * pi;
  };
  if (!spans_hemisphere(data.exact_partition) || !spans_hemisphere(data.one_shot_partition)) {
    fail("theta_o does not span the hemisphere", "partition of the known coordinates");
  }
  if (slab_count(data.exact_partition) != data.exact.size()) fail("one tree a slab is needed", "exact trees");
  if (slab_count(data.one_shot_partition) != data.one_shot.size())
    fail("one tree a slab is needed", "one-shot trees");
  if (data.exact.size() > 60000 || data.one_shot.size() > 60000) fail("more than 60000 slabs", "partitions");
  for (std::size_t s = 0; s < data.exact.size(); ++s) {
    const std::string where = "exact tree " + std::to_string(s);
    check_tree(data.exact[s], where);
    if (!(std::isfinite(data.exact[s].volume) && data.exact[s].volume >= 0))
      fail("the volume is not a number", where);
    if (data.exact[s].status != BoundStatus::certified && data.exact[s].status != BoundStatus::estimated) {
      fail("unknown status of the bounds", where);
    }
  }
  for (std::size_t s = 0; s < data.one_shot.size(); ++s) {
    check_tree(data.one_shot[s], "one-shot tree " + std::to_string(s));
  }
  const AlbedoTable& a = data.albedo;
  if (a.cos_theta_o.size() < 2 || a.cos_theta_o.size() != a.albedo.size() || a.cos_theta_o.size() > 60000) {
    fail("needs 2 to 60000 nodes, a value each", "albedo table");
  }
  if (!(a.relative_error >= 0 && a.relative_error <= 1)) fail("the error is not in [0, 1]", "albedo table");
  for (std::size_t i = 0; i < a.albedo.size(); ++i) {
    if (!(std::isfinite(a.albedo[i]) && a.albedo[i] >= 0)) fail("a value is not a number", "albedo table");
    if (i > 0 && !(a.cos_theta_o[i] > a.cos_theta_o[i - 1])) fail("the nodes do not ascend", "albedo table");
  }
  if (a.cos_theta_o.front() != min_cos_theta_o || a.cos_theta_o.back() != 1) {
    fail("the nodes do not span the hemisphere", "albedo table");
  }
  if (!(data.target.scale > 0 && std::isfinite(data.target.scale)))
    fail("the scale is not a positive number", "target");
  const std::vector<float>& channels = data.probes.channels;
  if (channels.size() % BrdfProbes::count != 0 ||
      channels.size() > BrdfProbes::count * std::size_t(max_channels)) {
    fail("a value of every channel is needed at every pair", "probes");
  }
  const Domain& d = data.domain;
  if (std::uint8_t(d.kind) > std::uint8_t(DomainKind::normal_vector)) fail("unknown domain", "domain");
  if (!(d.exponent >= 0 && d.exponent < 2)) fail("the exponent is not in [0, 2)", "domain");
}

}  // namespace reflectree
