// SPDX-License-Identifier: Apache-2.0
#include "rgl_enclosure.hpp"

#include <array>

#include "bent_pieces.hpp"
#include "channel_reduction.hpp"
#include "reflectree/brdf/tables/enclosed_difference.hpp"
#include "reflectree/math/affine_grid.hpp"
#include "rgl_places.hpp"
#include "rgl_slices.hpp"

namespace reflectree {

using namespace bent_pieces;
using namespace rgl_places;

namespace {

// Smaller ones count as this.
constexpr float least_cosine = 1e-6f;

RgbT<AffineForm> either(const RgbT<AffineForm>& a, const RgbT<AffineForm>& b) {
  return {either(a.r, b.r), either(a.g, b.g), either(a.b, b.b)};
}

// `known`: coordinates of wo that the table knows: theta_o, and phi_o of anisotropic ones.
template <class Table, std::size_t known>
class RglEnclosure final : public BrdfEnclosure {
 public:
  explicit RglEnclosure(const Table& table) : slices_{table} {
    if (reduces_channels()) norms_ = norms_of_nodes();
  }

  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g) const override {
    return value(g, one_by_cosine(g));
  }
  std::optional<RgbT<AffineForm>> times_cosine(const ShadingGeometry<AffineForm>& g) const override {
    return value(g, cosine_by_itself(g));
  }
  bool reduces_channels() const override { return slices_.channels() != 1 && slices_.channels() != 3; }
  AffineForm reduced(const Target& target, const ShadingGeometry<AffineForm>& g,
                     bool times_cosine) const override {
    const AffineForm factor = times_cosine ? cosine_by_itself(g) : one_by_cosine(g);
    return product(g, factor, [&](const KnownForms& wo, const Vec2<AffineForm>& at, const AffineForm& scale) {
      return scale * this->scalar(colours(wo, at), target);
    });
  }
  // What look-ups take into the part of the circle that is tabulated. Viewers on its border, for whom images differ, are
  // enclosed as both (for_each_place).
  bool keeps_half_turns() const override { return reduction() >= 2; }
  bool keeps_mirrored_axes() const override { return reduction() == 4; }

 private:
  using Pieces = GridPieces<known + 2, 100>;
  using Node = typename Pieces::Node;
  using Where = std::array<const Part*, known + 2>;
  using Places = std::array<double, known + 2>;
  using KnownForms = std::array<AffineForm, known>;

  static AffineForm one_by_cosine(const ShadingGeometry<AffineForm>& g) {
    return AffineForm(1) / max(AffineForm(least_cosine), g.cos_theta_i);
  }
  static AffineForm cosine_by_itself(const ShadingGeometry<AffineForm>& g) {
    const double lo = g.cos_theta_i.range.lo / double(least_cosine);
    return lo > 1 ? AffineForm(1) : AffineForm::anything_in({std::max(lo * (1 - 2 * u), 0.), 1});
  }

  // factor D S / (4 sigma), cut at 0.
  RgbT<AffineForm> value(const ShadingGeometry<AffineForm>& g, const AffineForm& factor) const {
    return product(g, factor, [&](const KnownForms& wo, const Vec2<AffineForm>& at, const AffineForm& scale) {
      const Pieces pieces = colours(wo, at);
      const AffineForm zero(0.f);
      const auto of = [&](int channel) { return max(scale * this->channel(pieces, channel), zero); };
      if (reduces_channels()) {
        const AffineForm any = AffineForm::anything_in({0, detail::infinity});
        return RgbT<AffineForm>{any, any, any};
      }
      if (slices_.channels() == 1) {
        const AffineForm grey = of(0);
        return RgbT<AffineForm>{grey, grey, grey};
      }
      return RgbT<AffineForm>{of(0), of(1), of(2)};
    });
  }

  // finish(wo, place of the colours, factor D / (4 sigma)), of all places of wo and wh in the tables.
  template <class Finish>
  auto product(const ShadingGeometry<AffineForm>& g, const AffineForm& factor, const Finish& finish) const {
    const AffineForm theta_o = polar_angle(sin_theta_o(g), g.cos_theta_o);
    const AffineForm theta_h = polar_angle(detail::half_frame(g).sin_theta_h, g.cos_theta_h);
    const AffineForm of_theta_o = elevation_to_u(theta_o), of_theta_h = elevation_to_u(theta_h);
    const auto at = [&](const KnownForms& wo, const AffineForm& v_of_wo, const AffineForm& phi_h) {
      const AffineForm of_phi_h = azimuth_to_v(phi_h);
      const AffineForm sigma = interpolated(slices_.sigma(), of_theta_o, v_of_wo);
      const GridSize size = slices_.warp_size();
      const Vec2<AffineForm> place =
          unwarped(wo, located(of_theta_h, size.width), located(of_phi_h, size.height));
      const AffineForm normals = max(interpolated(slices_.ndf(), of_theta_h, of_phi_h), AffineForm(0.f));
      return finish(wo, place, factor * (normals / (AffineForm(4.f) * sigma)));
    };
    if constexpr (known == 1) {
      return at({theta_o}, AffineForm(0.5f), relative_azimuth(g));
    } else {
      using Result = decltype(at({theta_o, theta_o}, theta_o, theta_o));
      std::optional<Result> out;
      for_each_place(g, [&](const AffineForm& phi_o, const AffineForm& phi_h) {
        const Result one = at({theta_o, phi_o}, azimuth_to_v(phi_o), phi_h);
        out = out ? either(*out, one) : one;
      });
      return *out;
    }
  }

  // Where the table looks wo and wh up, into the half or the quarter of the circle that it has: visit(phi_o, phi_h).
  // A viewer on the border of it belongs to one side, and a box whose border is that one may belong to either.
  template <class Visit>
  void for_each_place(const ShadingGeometry<AffineForm>& g, const Visit& visit) const {
    const int reduction = this->reduction();
    const RealInterval x = g.wo.x.range, y = g.wo.y.range;
    const bool on_plane = y.lo <= 0 && y.hi >= 0;
    const auto may = [&](bool flip_x, bool flip_y) {
      if (reduction == 1) return !flip_x && !flip_y;
      if (reduction == 4) return (flip_x ? x.hi >= 0 : x.lo < 0) && (flip_y ? y.hi >= 0 : y.lo <= 0);
      if (flip_x != flip_y) return false;
      return flip_x ? y.hi > 0 || (on_plane && x.hi >= 0) : y.lo < 0 || (on_plane && x.lo < 0);
    };
    const RealInterval span{-pi_v<double>, -pi_v<double> + 2 * pi_v<double> / reduction};
    for (const bool flip_x : {false, true}) {
      for (const bool flip_y : {false, true}) {
        if (!may(flip_x, flip_y)) continue;
        for_each_branch(flipped(azimuth_of_wo(g), flip_x, flip_y), span, 0, [&](const AffineForm& phi_o) {
          for_each_branch(flipped(azimuth_of_wh(g), flip_x, flip_y), {-pi_v<double>, pi_v<double>}, 1e-9,
                          [&](const AffineForm& phi_h) {
                            visit(between_nodes(rounded_angle(phi_o)), rounded_angle(phi_h));
                          });
        });
      }
    }
  }

  int reduction() const {
    if constexpr (known == 1) {
      return 1;
    } else {
      return slices_.reduction();
    }
  }
  // The nodes span the circle, or its part, up to rounding, and beyond them nothing changes.
  AffineForm between_nodes(AffineForm phi_o) const {
    constexpr double rounding = 1e-5;
    const double first = double(slices_.phi_o().front()), last = double(slices_.phi_o().back());
    if (phi_o.range.lo > first - rounding) phi_o.range.lo = std::max(phi_o.range.lo, first);
    if (phi_o.range.hi < last + rounding) phi_o.range.hi = std::min(phi_o.range.hi, last);
    return phi_o;
  }

  // The nodes of the known coordinates, and what of(slice) is between them.
  const std::vector<float>& nodes(std::size_t axis) const {
    if constexpr (known == 2) {
      if (axis == 1) return slices_.phi_o();
    }
    return slices_.theta_o();
  }
  int slice(int theta, int phi) const { return phi * int(slices_.theta_o().size()) + theta; }
  template <class Of>
  double mixed(const Where& where, const Places& place, const Of& of) const {
    const double t = where[0]->share(place[0]);
    const auto at_phi = [&](int phi) {
      const int s = slice(where[0]->cell, phi);
      return (1 - t) * of(s) + t * of(s + 1);
    };
    if constexpr (known == 1) {
      return at_phi(0);
    } else {
      const double p = where[1]->share(place[1]);
      return (1 - p) * at_phi(where[1]->cell) + p * at_phi(where[1]->cell + 1);
    }
  }
  // The first and the last node that values over a range touch.
  std::pair<int, int> touched(std::size_t axis, const KnownForms& wo) const {
    const std::vector<float>& all = nodes(axis);
    const RealInterval range = wo[axis].range;
    std::size_t first = 0, last = all.size() - 1;
    while (first + 2 < all.size() && double(all[first + 1]) < range.lo) ++first;
    while (last > first + 1 && double(all[last - 1]) > range.hi) --last;
    return {int(first), int(last)};
  }

  // Where V^-1 leads, each in [0, 1]: from a place in cells of the warp.
  Vec2<AffineForm> unwarped(const KnownForms& wo, const AffineForm& x, const AffineForm& y) const;
  Vec2<AffineForm> unwarped_range(const KnownForms& wo, RealInterval x, RealInterval y) const;

  Pieces colours(const KnownForms& wo, const Vec2<AffineForm>& at) const {
    const GridSize size = slices_.colour_size();
    std::array<GridAxis, known + 2> axes;
    std::array<AffineForm, known + 2> places;
    for (std::size_t a = 0; a < known; ++a)
      axes[a] = GridAxis{int(nodes(a).size()), false, nodes(a)}, places[a] = wo[a];
    axes[known] = GridAxis{size.width}, places[known] = located(at.x, size.width);
    axes[known + 1] = GridAxis{size.height}, places[known + 1] = located(at.y, size.height);
    return Pieces(axes, places);
  }
  const float* colour(const Node& n) const {
    return slices_.colour(slice(n[0], known == 2 ? n[1] : 0), n[known + 1], n[known]);
  }
  AffineForm channel(const Pieces& pieces, int channel) const {
    return pieces.interpolated_or_ranged([&](const Node& n) { return colour(n)[channel]; }, 32 * u);
  }

  // Of many channels the target of all.
  AffineForm scalar(const Pieces& pieces, const Target& target) const {
    const int channels = slices_.channels();
    const double share = (40 + 2 * channels) * u;
    if (pieces.touches_few()) {
      ChannelReduction reduction(target, channels, [this](const Node& n) { return colour(n); });
      return max(pieces.reduced(reduction, share), AffineForm(0.f));
    }
    // No target is more than the norm, which is largest at a node.
    const AffineForm norm = pieces.interpolated_or_ranged(
        [&](const Node& n) { return norms_[std::size_t(colour(n) - slices_.colour(0, 0, 0)) / stride()]; },
        share);
    return AffineForm::anything_in({0, double(target.scale) * norm.range.hi});
  }
  std::vector<float> norms_of_nodes() const {
    const GridSize size = slices_.colour_size();
    std::size_t slices = 1;
    for (std::size_t a = 0; a < known; ++a) slices *= nodes(a).size();
    std::vector<float> out;
    for (int s = 0; s < int(slices); ++s) {
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          double squares = 0;
          for (int c = 0; c < slices_.channels(); ++c) squares += sqr(double(slices_.colour(s, y, x)[c]));
          out.push_back(float(std::sqrt(squares) * (1 + 2 * u)));
        }
      }
    }
    return out;
  }
  std::size_t stride() const { return std::size_t(slices_.colour(0, 0, 1) - slices_.colour(0, 0, 0)); }

  RglSlices<Table> slices_;
  std::vector<float> norms_;  // of many channels, node by node
};

// Many cells, as where the azimuth of wh may be any. Between nodes of wo and of y the place along x is a quotient of two
// means with the same weights, and so between the quotients at the nodes; all masses ascend.
template <class Table, std::size_t known>
Vec2<AffineForm> RglEnclosure<Table, known>::unwarped_range(const KnownForms& wo, RealInterval x,
                                                            RealInterval y) const {
  const GridSize size = slices_.warp_size();
  const auto cell = [](double at, int cells) { return std::clamp(int(at), 0, cells - 1); };
  const int first_y = cell(y.lo, size.height - 1), last_y = cell(y.hi, size.height - 1);
  RealInterval sx{1, 0}, sy{1, 0};
  const auto add = [&](int slice) {
    const auto below = [&](double at) {
      const int j = cell(at, size.height - 1);
      const WarpLine row = slices_.row(slice, j);
      const double b = at - j, m0 = row.mass, m1 = slices_.row(slice, j + 1).mass;
      return row.cdf + b * (m0 + 0.5 * b * (m1 - m0));
    };
    sy = hull(sy, {below(y.lo), below(y.hi)});
    for (int j = first_y; j <= last_y + 1; ++j) {
      const double mass = slices_.row(slice, j).mass;
      const auto along = [&](double at) {
        const int i = cell(at, size.width - 1);
        const WarpPoint node = slices_.warp(slice, j, i);
        const double a = at - i, p0 = node.pdf, p1 = slices_.warp(slice, j, i + 1).pdf;
        return node.cdf + a * (p0 + 0.5 * a * (p1 - p0));
      };
      // Where nothing is visible the row adds nothing to the means, and alone it leads to 0.
      sx = hull(sx, mass > 0 ? RealInterval(along(x.lo) / mass, along(x.hi) / mass) : RealInterval(0, 0));
    }
  };
  const auto [first, last] = touched(0, wo);
  std::pair<int, int> rows{0, 0};
  if constexpr (known == 2) rows = touched(1, wo);
  for (int p = rows.first; p <= rows.second; ++p) {
    for (int t = first; t <= last; ++t) add(slice(t, p));
  }
  constexpr double share = 64 * u;
  const auto rounded = [](RealInterval r) {
    return within(AffineForm::anything_in({r.lo * (1 - share), r.hi * (1 + share)}), 0, 2);
  };
  return {rounded(sx), rounded(sy)};
}

template <class Table, std::size_t known>
Vec2<AffineForm> RglEnclosure<Table, known>::unwarped(const KnownForms& wo, const AffineForm& x,
                                                      const AffineForm& y) const {
  constexpr std::size_t n = known + 2;
  const AffineForm any = AffineForm::anything_in({0, 1});
  const GridSize size = slices_.warp_size();
  const auto unit = [](int i) { return double(i); };
  const Parts of_x(x.range, size.width, unit), of_y(y.range, size.height, unit);
  const Parts of_theta(wo[0].range, int(nodes(0).size()),
                       [&](int i) { return double(nodes(0)[std::size_t(i)]); });
  const Parts of_phi(wo[known - 1].range, known == 2 ? int(nodes(1).size()) : 2, [&](int i) {
    return known == 2 ? double(nodes(known - 1)[std::size_t(i)]) : double(i);
  });
  std::array<const Parts*, n> parts;
  std::array<AffineForm, n> at;
  parts[0] = &of_theta, parts[known - 1] = known == 2 ? &of_phi : &of_theta;
  parts[known] = &of_x, parts[known + 1] = &of_y;
  for (std::size_t a = 0; a < known; ++a) at[a] = wo[a];
  at[known] = x, at[known + 1] = y;
  std::size_t count = 1;
  bool few = true;
  for (const Parts* p : parts) few = few && p->are_few(), count *= p->size();
  if (!few || count > Parts::most * Parts::most * Parts::most) {
    // Where wh may be the normal its azimuth may stay unknown however small the box is. Elsewhere halving helps, and
    // a range without slopes would mislead the choice of the axis.
    if (x.range.lo < 1) return unwarped_range(wo, x.range, y.range);
    return {any, any};
  }
  constexpr double share = 32 * u;
  // Along a row up to x, on both rows of the cell.
  const auto along = [&](const Where& where, const Places& place) {
    const Part &px = *where[known], &py = *where[known + 1];
    const double a = px.share(place[known]), b = py.share(place[known + 1]);
    Bent sum{0, 0, px.hi - px.lo};
    for (const int upper : {0, 1}) {
      const auto node = [&](int s, int right) { return slices_.warp(s, py.cell + upper, px.cell + right); };
      const double cdf = mixed(where, place, [&](int s) { return node(s, 0).cdf; });
      const double p0 = mixed(where, place, [&](int s) { return node(s, 0).pdf; });
      const double p1 = mixed(where, place, [&](int s) { return node(s, 1).pdf; });
      const double w = upper ? b : 1 - b;
      sum.value += w * (cdf + a * (p0 + 0.5 * a * (p1 - p0)));
      sum.bend += w * (p1 - p0);
    }
    return sum;
  };
  const auto mass_of = [&](const Where& where, const Places& place, int upper) {
    return mixed(where, place, [&](int s) { return slices_.row(s, where[known + 1]->cell + upper).mass; });
  };
  const auto mass = [&](const Where& where, const Places& place) {
    const double b = where[known + 1]->share(place[known + 1]);
    return Bent{(1 - b) * mass_of(where, place, 0) + b * mass_of(where, place, 1), 0, 0};
  };
  const auto below = [&](const Where& where, const Places& place) {
    const Part& py = *where[known + 1];
    const double b = py.share(place[known + 1]);
    const double m0 = mass_of(where, place, 0), m1 = mass_of(where, place, 1);
    const double cdf = mixed(where, place, [&](int s) { return slices_.row(s, py.cell).cdf; });
    return Bent{cdf + b * (m0 + 0.5 * b * (m1 - m0)), m1 - m0, py.hi - py.lo};
  };
  // Where x does not enter one part of it stands for all.
  const Parts one(RealInterval(0, 0), 2, unit);
  std::array<const Parts*, n> flat = parts;
  std::array<AffineForm, n> flat_at = at;
  flat[known] = &one, flat_at[known] = AffineForm(0);
  const AffineForm sy = enclosed(flat, flat_at, below, share);
  const AffineForm m = enclosed(flat, flat_at, mass, share);
  if (!(m.range.lo > 0)) return {unwarped_range(wo, x.range, y.range).x, within(sy, 0, 2)};
  return {enclosed(parts, at, along, share) / m, sy};
}

}  // namespace

std::shared_ptr<const BrdfEnclosure> enclosure_of(const RglTable& table) {
  return std::make_shared<RglEnclosure<RglTable, 1>>(table);
}
std::shared_ptr<const BrdfEnclosure> enclosure_of(const RglWideTable& table) {
  const RglSlices<RglWideTable> slices{table};
  if (slices.phi_o().size() == 1) return std::make_shared<RglEnclosure<RglWideTable, 1>>(table);
  return std::make_shared<RglEnclosure<RglWideTable, 2>>(table);
}

}  // namespace reflectree
