// SPDX-License-Identifier: Apache-2.0
#include "settings.hpp"

#include <cmath>
#include <cstdlib>

#include "reflectree/error.hpp"

namespace reflectree::pictures {

namespace {

using namespace render;

constexpr const char* beckmann_metals[] = {"gold",   "cook_torrance:kd=0,ks=1,alpha=0.1,f0=1/0.8/0.3",
                                           "steel",  "cook_torrance:kd=0,ks=1,alpha=0.15,f0=0.7",
                                           "copper", "cook_torrance:kd=0,ks=1,alpha=0.05,f0=0.9/0.6/0.5"};
constexpr const char* paint_and_sky[] = {"material", "/rgl/chm_light_blue_rgb.bsdf", "sky",
                                         "/envmaps/venice_sunset_1k.hdr"};

constexpr Setting all[] = {
    {"metal", "metal.xml", "glossy metal (GGX) in a room", false, true, true, {}},
    {"metals", "metal.xml", "the same room, metals of Cook and Torrance (Beckmann)", false, false, false,
     beckmann_metals},
    {"retro", "retro.xml", "retro-reflective spheres under a sun", false, true, true, {}},
    {"ball", "ball.xml", "a ball of a measured metallic paint under a measured sky", true, true, true,
     paint_and_sky},
    {"plates", "plates.xml", "Veach's plates (GGX)", false, true, true, {}},
};

// Everything of another material's but N directions at once: by default they are drawn one by one.
struct Undivided final : Scattering {
  ScatteringPtr whole;
  explicit Undivided(ScatteringPtr s) : whole(std::move(s)) {}
  Rgb f_cos(Direction wo, Direction wi, Place place) const override { return whole->f_cos(wo, wi, place); }
  float pdf(Direction wo, Direction wi, Place place) const override { return whole->pdf(wo, wi, place); }
  Value value(Direction wo, Direction wi, Place place) const override { return whole->value(wo, wi, place); }
  std::optional<Scattered> sample(Direction wo, Place place, PathBits& u) const override {
    return whole->sample(wo, place, u);
  }
  void values(std::span<const View> views, std::span<const Direction> wi,
              std::span<Value> out) const override {
    whole->values(views, wi, out);
  }
  void samples(std::span<const View> views, std::span<PathBits* const> u,
               std::span<std::optional<Scattered>> out) const override {
    whole->samples(views, u, out);
  }
  std::optional<Scattered> sample_adjoint(Direction wi, Place place, PathBits& u) const override {
    return whole->sample_adjoint(wi, place, u);
  }
  Lobes lobes() const override { return whole->lobes(); }
  Asks asks() const override { return whole->asks(); }
  bool has_pdf() const override { return whole->has_pdf(); }
};

// Diffuse surfaces draw by the cosine, whatever the sampler; lamps reflect nothing that counts.
bool is_sampled(const Surface& surface) {
  if (surface.radiance != Rgb{} || !surface.scattering) return false;
  for (const float x : {.1f, .5f, .9f}) {
    const Direction wo = normalize(Direction{.6f, 0, .8f}), wi{x, 0, std::sqrt(1 - x * x)};
    if (std::abs(surface.scattering->pdf(wo, wi, {}) - wi.z / pi) > 1e-3f) return true;
  }
  return false;
}

}  // namespace

std::span<const Setting> settings() { return all; }

std::string data_folder() {
  const char* folder = std::getenv("REFLECTREE_DATA");
  return folder ? folder : "";
}

Scene load(const Setting& setting, const std::string& folder, const std::string& sampler, const Host& host) {
  SceneOptions options;
  options.sampler = sampler;
  for (std::size_t i = 0; i + 1 < setting.defines.size(); i += 2) {
    const std::string value = setting.defines[i + 1];
    options.defines[setting.defines[i]] = value.front() == '/' ? data_folder() + value : value;
  }
  return load_scene(folder + "/" + setting.file, options, host);
}

Scene sampled_part(const Scene& scene) {
  Scene part = scene;
  for (Surface& s : part.surfaces) s.radiance = is_sampled(s) ? Rgb{1, 1, 1} : Rgb{};
  part.environment.reset();
  part.point_lights.clear(), part.directional_lights.clear();
  part.transport = {}, part.max_depth = 1;
  return part;
}

Scene undivided(Scene scene) {
  for (Surface& s : scene.surfaces) {
    if (s.scattering) s.scattering = std::make_shared<Undivided>(s.scattering);
  }
  return scene;
}

}  // namespace reflectree::pictures
