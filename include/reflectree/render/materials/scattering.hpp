// SPDX-License-Identifier: Apache-2.0
// How a surface scatters light, on the whole sphere of directions: what a path tracer asks of a material.
// Values, shared and immutable inside. The materials are Mitsuba 3's, with its parameters and conventions.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "reflectree/brdf/any_brdf.hpp"
#include "reflectree/brdf/models/widths.hpp"
#include "reflectree/render/integrators/path_bits.hpp"
#include "reflectree/render/materials/texture.hpp"
#include "reflectree/sampler/any_sampler.hpp"

namespace reflectree::render {

inline constexpr std::size_t max_split = 64;  // of directions drawn at once

struct Scattered {
  Direction wi{};
  float pdf = 0;  // per solid angle; 0 for a delta: nothing competes with it
  Rgb weight{};   // f |cos| / pdf
  bool delta = false;
};

// What a function is made of.
enum class Lobes : std::uint8_t { finite, delta, both };

// Directions are local to the shading frame; wo.z < 0 is the back.
class Scattering {
 public:
  virtual ~Scattering() = default;
  // f |cos_theta_i|, without deltas.
  virtual Rgb f_cos(Direction wo, Direction wi, Place place) const = 0;
  // Density of `sample`, without deltas.
  virtual float pdf(Direction wo, Direction wi, Place place) const = 0;
  // Both at once.
  struct Value {
    Rgb f_cos;
    float pdf = 0;
  };
  virtual Value value(Direction wo, Direction wi, Place place) const {
    return {f_cos(wo, wi, place), pdf(wo, wi, place)};
  }
  virtual std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const = 0;
  // Many at once, each its own: of a surface's point, from where it is seen. Without light, `values` need
  // give no density.
  struct View {
    Direction wo;
    Place place;
  };
  virtual void values(std::span<const View> views, std::span<const Direction> wi, std::span<Value> out) const;
  virtual void samples(std::span<const View> views, std::span<PathBits* const> u,
                       std::span<std::optional<Scattered>> out) const;
  // One direction for each of `u`, whose bits stand at its decision; returns how many were filled, with their
  // bits moved to the front. A mean over the directions is a sum over those filled divided by u.size().
  virtual std::size_t sample_n(Direction wo, Place place, std::span<PathBits> u,
                               std::span<Scattered> out) const;
  // For light that is known to come from `wi`: a direction wo in which it goes on, in the sample's `wi`, with
  // weight f(wo, wi) |cos_theta_o| / pdf: the adjoint f*(wo, wi) = f(wi, wo) (Veach 1997, 3.7.5), since
  // functions are not reciprocal. By default drawn as `sample` would, were wi the viewer's direction.
  virtual std::optional<Scattered> sample_adjoint(Direction wi, Place place, PathBits& u) const;
  virtual Lobes lobes() const { return Lobes::finite; }
  // Whether light goes on behind the surface.
  virtual bool transmits() const { return false; }
  bool only_delta() const { return lobes() == Lobes::delta; }
  // False for a method without a density: lights are left to its own directions.
  virtual bool has_pdf() const { return true; }
  // What it wants to know of a surface's point besides the normal.
  enum class Asks : std::uint8_t {
    nothing,
    frame,  // x and y of the shading frame matter: it follows the texture coordinates
    detail  // that, and SurfaceDetail
  };
  virtual Asks asks() const { return Asks::nothing; }
};
using ScatteringPtr = std::shared_ptr<const Scattering>;

struct Roughness {
  enum class Kind { beckmann, ggx } kind = Kind::beckmann;
  Widths alpha = .1f;  // along the shading frame's x and y
  bool sample_visible = true;
};

ScatteringPtr diffuse(Texture reflectance);
// eta = k = 0: a mirror that reflects all.
ScatteringPtr conductor(Rgb eta, Rgb k, Texture specular);
// `alpha_x`, `alpha_y`: grey pictures in place of the numbers, where there are any.
ScatteringPtr rough_conductor(Roughness roughness, Rgb eta, Rgb k, Texture specular, Texture alpha_x = {},
                              Texture alpha_y = {});
// `eta`: inside over outside. `nonlinear`: colour shifts of the light that goes round inside.
struct PlasticParameters {
  float eta = 1.49f / 1.000277f;
  Texture diffuse{{.5f, .5f, .5f}, nullptr}, specular{{1, 1, 1}, nullptr};
  bool nonlinear = false;
};
ScatteringPtr plastic(PlasticParameters parameters);
ScatteringPtr rough_plastic(PlasticParameters parameters, Roughness roughness);
ScatteringPtr dielectric(float eta, Texture reflectance, Texture transmittance);
// A pane: light is mirrored or goes on as it came, after all reflections inside.
ScatteringPtr thin_dielectric(float eta, Texture reflectance, Texture transmittance);
// Lets 1 - opacity of the light pass as it came.
ScatteringPtr mask(Texture opacity, ScatteringPtr inner);
// `inner` about a normal of its own: from colours, 2 c - 1 in the shading frame, or from the gradient of a
// height. `flip_invalid`: normals that look away from wo are turned (Schuessler et al. 2017); `shadowing`: of
// the bumps on each other (Estevez, Lecocq & Stein 2019).
struct NormalRules {
  bool flip_invalid = true, shadowing = true;
};
ScatteringPtr normal_map(Texture normals, NormalRules rules, ScatteringPtr inner);
ScatteringPtr bump_map(Texture height, float scale, NormalRules rules, ScatteringPtr inner);
// A function above the surface with a sampler of it, ours or any other.
// Light's side is drawn by `adjoint`, a sampler of the swapped function; without one, by `sampler` and a
// tenth of a cosine lobe, which reaches what the ordinary sampler may miss.
ScatteringPtr sampled(AnyBrdf f, AnySampler<Spectrum> sampler,
                      std::optional<AnySampler<Spectrum>> adjoint = std::nullopt);
// f with its directions swapped: what a sampler of light's side is made of.
AnyBrdf adjoint_of(AnyBrdf f);
ScatteringPtr two_sided(ScatteringPtr front, ScatteringPtr back);
// (1 - weight) a + weight b.
ScatteringPtr blend(Texture weight, ScatteringPtr a, ScatteringPtr b);

}  // namespace reflectree::render
