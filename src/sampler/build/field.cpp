// SPDX-License-Identifier: Apache-2.0
#include "field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <mutex>

#include "reflectree/error.hpp"
#include "reflectree/math/frame.hpp"
#include "reflectree/math/lanes.hpp"
#include "refuse.hpp"

namespace reflectree::detail {

namespace {

// Points evaluated by one call. A function that is called from one thread may be one of another language,
// whose calls are dear.
constexpr std::size_t block = 512, large_block = 65536;

struct Turn {
  float cosine = 1, sine = 0;
};
// From the frame in which the domain sees wo to the viewer's.
Turn turn_of(const Field& field, Direction wo) {
  if (field.frame.isotropic() || field.domain.follows_surface()) return {};
  const float sine = sqrt(wo.x * wo.x + wo.y * wo.y);
  return sine > 0 ? Turn{wo.x / sine, wo.y / sine} : Turn{};
}
// wo as the domain sees it.
Direction seen_by_domain(const Field& field, Direction wo) {
  if (field.frame.isotropic() || field.domain.follows_surface()) return wo;
  return {sqrt(wo.x * wo.x + wo.y * wo.y), 0, wo.z};
}

// The domain of the member.
Domain domain_of(const Field& field, const Coordinates& at) {
  Domain domain = field.domain;
  if (!field.parameters.empty())
    domain.scale_x = scale_by(field.law.x, at), domain.scale_y = scale_by(field.law.y, at);
  return domain;
}

// lift() of points that share their domain, as many side by side as there are lanes: each lane computes what
// lift() computes, bit for bit.
void lift_side_by_side(const Field& field, const Domain& domain, std::span<const FieldPoint> points,
                       std::span<DomainPoint> out) {
  for (std::size_t first = 0; first < points.size(); first += lane_count) {
    const std::size_t count = std::min(lane_count, points.size() - first);
    std::array<std::array<float, lane_count>, 5> in;
    for (std::size_t i = 0; i < lane_count; ++i) {
      const FieldPoint& point = points[first + std::min(i, count - 1)];
      const Direction wo = seen_by_domain(field, point.wo);
      in[0][i] = wo.x, in[1][i] = wo.y, in[2][i] = wo.z, in[3][i] = point.p.x, in[4][i] = point.p.y;
    }
    const auto lanes = [&in](std::size_t k) { return Lanes::load(in[k].data()); };
    const Vec3<Lanes> wo{lanes(0), lanes(1), lanes(2)};
    const DomainPointT<Lanes> q = lift_point(domain, wo, Vec2<Lanes>{lanes(3), lanes(4)});
    const ShadingGeometry<Lanes>& g = q.geometry;
    for (std::size_t i = 0; i < count; ++i) {
      const auto lane = [i](const Vec3<Lanes>& w) { return Direction{w.x[i], w.y[i], w.z[i]}; };
      out[first + i] = {{lane(g.wo), lane(g.wi), lane(g.wh), g.cos_theta_o[i], g.cos_theta_i[i],
                         g.cos_theta_h[i], g.cos_theta_d[i]},
                        q.projected_area[i]};
    }
  }
}

// In the caller's frame; `axis`: from the viewer's frame to it.
ShadingGeometry<float> geometry_for_caller(const Field& field, Turn axis, const FieldPoint& point,
                                           const ShadingGeometry<float>& g) {
  const Turn t = turn_of(field, point.wo);
  const auto to_caller = [&](Direction w) { return turn(w, axis.cosine, axis.sine); };
  const auto turned = [&](Direction w) { return to_caller(turn(w, t.cosine, t.sine)); };
  return {to_caller(point.wo), turned(g.wi),  turned(g.wh), g.cos_theta_o,
          g.cos_theta_i,       g.cos_theta_h, g.cos_theta_d};
}

}  // namespace

Direction Field::to_caller(Direction w) const {
  return frame.isotropic() ? w : turn(w, cos(frame.axis), sin(frame.axis));
}

KnownBox Field::whole() const {
  KnownBox box{{}, {theta_max}, 1};
  const auto add = [&box](std::size_t slot, float lo, float hi) {
    box.lo[slot] = lo, box.hi[slot] = hi;
    box.slot[std::size_t(box.axes++)] = std::uint8_t(slot);
  };
  if (!frame.isotropic()) add(1, 0, azimuth_span(frame.symmetry));
  for (std::size_t i = 0; i < parameters.size(); ++i)
    add(2 + i, lowest(parameters[i]), highest(parameters[i]));
  return box;
}

Vec2<float> Field::place_of(const Viewer& viewer, Direction wi) const {
  const Turn t = turn_of(*this, viewer.wo);
  return lower(domain_of(*this, viewer.at), seen_by_domain(*this, viewer.wo),
               fold(domain.symmetry, turn(wi, t.cosine, -t.sine)));
}

Direction Field::direction_at(const FieldPoint& point) const {
  const Turn t = turn_of(*this, point.wo);
  const Domain member = domain_of(*this, point.at);
  return turn(lift(member, seen_by_domain(*this, point.wo), point.p).geometry.wi, t.cosine, t.sine);
}

void Field::eval(std::span<const FieldPoint> points, std::span<FieldValue> out) const {
  const int channels = f.channels();
  const std::size_t images = both_sides ? 2 : 1;
  const std::size_t most = std::min(points.size(), f.traits().concurrent ? block : large_block);
  std::vector<ShadingGeometry<float>> geometry(most * images);
  std::vector<float> values(geometry.size() * std::size_t(channels));
  std::vector<DomainPoint> lifted(most);
  std::vector<Parameters> members(family ? geometry.size() : 0);
  const Turn axis{cos(frame.axis), sin(frame.axis)};
  Domain member = domain;
  Parameters member_values{};
  const FieldPoint* last = nullptr;  // whose member is at hand
  for (std::size_t begin = 0; begin < points.size(); begin += most) {
    const std::size_t end = std::min(points.size(), begin + most);
    const std::size_t count = end - begin;
    if (!family) lift_side_by_side(*this, domain, points.subspan(begin, count), lifted);
    for (std::size_t k = 0; k < count; ++k) {
      const FieldPoint& point = points[begin + k];
      if (family) {
        if (!last || last->at != point.at)
          member = domain_of(*this, point.at), member_values = values_of(parameters, point.at);
        last = &point;
        for (std::size_t i = 0; i < images; ++i) members[k * images + i] = member_values;
        lifted[k] = lift(member, seen_by_domain(*this, point.wo), point.p);
      }
      const DomainPoint& q = lifted[k];
      geometry[k * images] =
          frame.isotropic() ? q.geometry : geometry_for_caller(*this, axis, point, q.geometry);
      if (!both_sides) continue;
      ShadingGeometry<float>& mirrored = geometry[k * images + 1] = q.geometry;
      mirrored.wi.y = -mirrored.wi.y, mirrored.wh.y = -mirrored.wh.y;
    }
    const std::span<const ShadingGeometry<float>> asked(geometry.data(), count * images);
    const std::span<float> answers(values.data(), count * images * std::size_t(channels));
    if (family) {
      family->eval(asked, {members.data(), asked.size()}, answers);
    } else {
      f.eval(asked, answers);
    }
    const auto target_of = [&](std::size_t k) {
      const std::span<const float> value(values.data() + k * std::size_t(channels), std::size_t(channels));
      const float t = target(value.data(), channels);
      bool good = is_good(t);
      for (const float v : value) good = good && v >= 0;
      if (!good) {
        const std::string member_name = family ? ", " + to_text(family->ranges(), members[k]) : "";
        refuse_values(value, f.traits().name + member_name, geometry[k].wo, geometry[k].wi);
      }
      return t;
    };
    for (std::size_t k = 0; k < count; ++k) {
      const float a = target_of(k * images) * lifted[k].projected_area;
      const float b = both_sides ? target_of(k * images + 1) * lifted[k].projected_area : a;
      out[begin + k] = {0.5f * (a + b), max(a, b)};
    }
  }
}

std::vector<Landmark> Field::landmarks(const Viewer& viewer) const {
  const Direction wo = viewer.wo;
  constexpr float coarse = 1.f / 128;
  std::vector<Landmark> places;
  for (const Direction& wi : {Direction{-wo.x, -wo.y, wo.z}, wo})
    places.push_back({place_of(viewer, wi), {coarse, coarse}});
  std::vector<SharpLobe> lobes;
  if (f.traits().sharp && !family) {  // of a member, which others need not share
    lobes = f.traits().sharp(to_caller(wo));
    for (SharpLobe& lobe : lobes) {
      if (!frame.isotropic()) lobe.centre = turn(lobe.centre, cos(frame.axis), -sin(frame.axis));
    }
  }
  for (const Ridge& ridge : ridges) {
    if (const auto lobe = ridge.at(theta_of_viewer(wo))) lobes.push_back(*lobe);
  }
  for (const SharpLobe& lobe : lobes) {
    if (!(lobe.centre.z > 0) || !(lobe.width > 0)) continue;
    const LocalFrame<float> around = frame_from_normal(lobe.centre);
    Landmark at{place_of(viewer, lobe.centre), {0, 0}};
    // How far the square's coordinates reach over the lobe, along two directions; azimuths that wrap are far.
    for (const Direction& tangent : {around.s, around.t}) {
      const Direction beside = normalize(lobe.centre + min(lobe.width, 0.5f) * tangent);
      if (!(beside.z > 0)) continue;
      const Vec2<float> q = place_of(viewer, beside);
      at.size = {max(at.size.x, abs(q.x - at.p.x)), max(at.size.y, abs(q.y - at.p.y))};
    }
    at.size = {clamp(at.size.x, 0x1p-15f, coarse), clamp(at.size.y, 0x1p-15f, coarse)};
    places.push_back(at);
  }
  return places;
}

float albedo_of(const Field& field, const AlbedoTable& albedo, const Viewer& viewer) {
  const Direction wo = viewer.wo;
  if (field.family)
    return reflectree::albedo_at(albedo, wo.z, field.frame.isotropic() ? 0 : azimuth_of(wo), viewer.at);
  if (field.frame.isotropic()) return reflectree::albedo_at(albedo, wo.z);
  return reflectree::albedo_at(albedo, wo.z, azimuth_of(wo));
}

bool Survey::at_jump(Direction wo) const {
  if (!jumps || (jumps->theta_o.empty() && jumps->phi_o.empty())) return false;
  const float theta = theta_of_viewer(wo);
  for (const ThetaJump& jump : jumps->theta_o) {
    if (abs(theta - jump.at) < 4e-6f + 4e-7f / sin(max(jump.at, 1e-3f))) return true;
  }
  if (jumps->phi_o.empty()) return false;
  const float phi = azimuth_of(wo), narrow = 4e-6f + 4e-7f / sin(max(theta, 1e-3f));
  const float span = azimuth_span(field.frame.symmetry);
  const float around = is_mirrored(field.frame.symmetry) ? 2 * span : span;
  return std::any_of(jumps->phi_o.begin(), jumps->phi_o.end(), [&](float jump) {
    const float away = abs(phi - jump);
    return min(away, around - away) < narrow;
  });
}

void eval_in_parallel(const Field& field, const Host& host, Effort& effort,
                      std::span<const FieldPoint> points, std::span<FieldValue> out) {
  effort.evaluations += points.size();
  if (host.cancelled()) throw Cancelled();
  if (!field.f.traits().concurrent) return field.eval(points, out);
  // The error of the lowest block wins, so that the message does not depend on the threads.
  std::mutex mutex;
  std::size_t first_bad = points.size();
  std::exception_ptr error;
  const std::size_t blocks = (points.size() + block - 1) / block;
  host.parallel_for(blocks, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t from = b * block, count = std::min(block, points.size() - from);
      try {
        field.eval(points.subspan(from, count), out.subspan(from, count));
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (b < first_bad) first_bad = b, error = std::current_exception();
      }
    }
  });
  if (error) std::rethrow_exception(error);
}

}  // namespace reflectree::detail
