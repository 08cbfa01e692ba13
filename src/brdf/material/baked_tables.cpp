// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/material/baked_tables.hpp"

#include "reflectree/brdf/models/ggx.hpp"
#include "reflectree/brdf/models/oren_nayar.hpp"
#include "reflectree/brdf/models/retro_reflector.hpp"
#include "reflectree/error.hpp"
#include "reflectree/math/random.hpp"

namespace reflectree {
namespace {

constexpr BakedTable all[] = {
    {"baked_matt", "matt paper, tabulated with noise"},
    {"baked_glossy", "lacquer with a sharp highlight, tabulated with noise"},
    {"baked_retro", "safety cloth with a retro-reflective peak, tabulated with noise"},
};

Rgb ideal(std::string_view name, const ShadingGeometry<float>& g) {
  if (name == "baked_matt")
    return OrenNayar{{0.72f, 0.66f, 0.55f}, 0.35f}(g) + Ggx{0.55f, {0.03f, 0.03f, 0.03f}}(g);
  if (name == "baked_glossy") {
    return OrenNayar{{0.30f, 0.05f, 0.04f}, 0.1f}(g) + Ggx{0.09f, {0.05f, 0.05f, 0.05f}}(g);
  }
  return OrenNayar{{0.25f, 0.28f, 0.06f}, 0.2f}(g) + RetroReflector{0.15f, {0.30f, 0.32f, 0.20f}}(g);
}

}  // namespace

std::span<const BakedTable> baked_tables() { return all; }

HalfAngleTable bake_table(std::string_view name) {
  bool known = false;
  for (const BakedTable& table : all) known = known || table.name == name;
  if (!known) throw Error("no baked table of that name", std::string(name), "name one of baked_tables()");

  HalfAngleTable table;
  table.name = name;
  table.n_h = 48, table.n_d = 48, table.n_p = 48;
  table.reciprocal = false;
  table.lookup = TableLookup::linear;
  Pcg32 noise(2008);
  for (int h = 0; h < table.n_h; ++h) {
    for (int d = 0; d < table.n_d; ++d) {
      for (int p = 0; p < table.n_p; ++p) {
        const auto [wo, wi] = cell_centre(table, h, d, p);
        const Rgb f = ideal(name, shading_geometry(wo, wi));
        // Drift: the instrument sees a little more where the light, not the viewer, stands high: 6 %.
        const float drift = 1 + 0.06f * (wi.z - wo.z);
        for (const float channel : {f.r, f.g, f.b}) {
          const float speckle = 1 + 0.04f * (to_unit_float(noise()) - 0.5f);  // 2 % to either side
          table.rgb.push_back(channel * drift * speckle);
        }
      }
    }
  }
  return table;
}

}  // namespace reflectree
