// SPDX-License-Identifier: Apache-2.0
#include "rgl_enclosure.hpp"

#include <array>

#include "channel_reduction.hpp"
#include "reflectree/brdf/tables/enclosed_difference.hpp"
#include "reflectree/math/affine_grid.hpp"
#include "rgl_places.hpp"
#include "rgl_slices.hpp"
#include "rgl_unwarp.hpp"

namespace reflectree {

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
  explicit RglEnclosure(const Table& table) : slices_{table}, unwarped_(table) {
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
  using KnownForms = std::array<AffineForm, known>;

  static AffineForm one_by_cosine(const ShadingGeometry<AffineForm>& g) {
    return AffineForm(1) / max(AffineForm(least_cosine), g.cos_theta_i);
  }
  // At the rim, where the map keeps the cosine from 0, it is less than the least, and f cos theta_i a tenth.
  static AffineForm cosine_by_itself(const ShadingGeometry<AffineForm>& g) {
    const RealInterval c = g.cos_theta_i.range;
    if (c.hi <= double(least_cosine)) return max(g.cos_theta_i, AffineForm(0.f)) / AffineForm(least_cosine);
    const double lo = c.lo / double(least_cosine);
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
          unwarped_(wo, located(of_theta_h, size.width), located(of_phi_h, size.height));
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
  RglUnwarp<Table, known> unwarped_;  // V^-1
  std::vector<float> norms_;          // of many channels, node by node
};

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
