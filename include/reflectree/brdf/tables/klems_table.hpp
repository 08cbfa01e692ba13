// SPDX-License-Identifier: Apache-2.0
// A BRDF that is constant over patches of the hemisphere: the matrices of Klems 1994, "A New Method for
// Predicting the Solar Heat Gain of Complex Fenestration Systems", in the files of WINDOW and Radiance.
#pragma once

#include <string>
#include <vector>

#include "reflectree/brdf/brdf.hpp"
#include "reflectree/math/affine_form.hpp"

namespace reflectree {

// How directions stand to those of a basis.
enum class KlemsView { as_is, half_turn, mirrored_x, mirrored_y };

// Rings about the normal, cut into equal patches. Patch 0 of a ring is centred at azimuth 0; patches count
// counter-clockwise, rings from the normal outwards.
class KlemsBasis {
 public:
  KlemsBasis() = default;
  // theta: radians, where rings begin and the last one ends, ascending from 0; patches: as many as rings.
  KlemsBasis(const std::vector<double>& theta, const std::vector<int>& patches);

  int size() const { return size_; }
  // The patch of a direction with z > 0, -1 beyond the last ring. Whoever compares its azimuth_key with those of
  // azimuth_borders(), upper borders belonging to what is above, and its cosine with cos() of ring_borders(),
  // belonging to what is outside, finds the same patch: samplers do (slab_tree.hpp).
  int patch_of(Direction w, KlemsView view = KlemsView::as_is) const;
  // Of all directions of a box: patches that they may lie in, and whether some may lie beyond the last ring.
  struct Touched {
    std::vector<int> patches;
    bool beyond = false;
  };
  Touched patches_of(const Vec3<AffineForm>& w) const;
  // The first patch of the ring of a patch.
  int first_of_ring(int patch) const;
  // In radians.
  const std::vector<float>& ring_borders() const { return theta_; }
  // Where patches of a ring meet, radians in [0, 2 pi), ascending; none where the ring is one patch.
  std::vector<float> azimuth_borders(std::size_t ring, KlemsView view = KlemsView::as_is) const;
  // The measure of a patch: its projected solid angle.
  double projected_solid_angle(int patch) const;

 private:
  // The patches of a ring by the azimuth_key at which each begins, ascending; one may begin at 0.
  struct Circle {
    std::vector<float> key;
    std::vector<int> patch;
  };
  std::size_t ring_of(int patch) const;
  std::vector<float> theta_, cos_theta_;      // one more than rings
  std::vector<std::vector<Circle>> circles_;  // [view][ring]
  std::vector<int> patches_, first_;
  int size_ = 0;
};

// f(wo, wi) in sr^-1 with wo the file's incident direction, 0 outside of the rings. The matrix counts
// incident azimuths from the opposite side, so that light that goes straight on keeps its number.
struct KlemsTable {
  std::string name = "klems";
  KlemsBasis incident, exiting;
  // Azimuths of the file are seen through the layer: x points the other way on this side; y does not.
  bool seen_through = false;
  std::vector<float> values;  // [incident][exiting], not negative

  float value(int in, int out) const {
    return values[std::size_t(in) * std::size_t(exiting.size()) + std::size_t(out)];
  }
  KlemsView incident_view() const { return seen_through ? KlemsView::mirrored_y : KlemsView::half_turn; }
  KlemsView exiting_view() const { return seen_through ? KlemsView::mirrored_x : KlemsView::as_is; }
  // Whether values are the same in all patches of a ring.
  bool knows_rings_alone() const;
  float operator()(const ShadingGeometry<float>& g) const;
  BrdfTraits traits() const;
};

}  // namespace reflectree
