// SPDX-License-Identifier: Apache-2.0
// Writes the figures of docs/method.md:  method_figures DIRECTORY
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "figures.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/error.hpp"
#include "reflectree/sampler/build.hpp"

namespace reflectree::method {

Example make_example() {
  const AnyBrdf f = make_brdf(
      parse_material("plastic:kd=0.1/0.02/0.015,f0=0.05,alpha=0.12 + 0.06*retro_reflector:alpha=0.15"));
  BuildOptions options;
  options.domain =
      Domain{DomainKind::half_vector, Symmetry::mirror, 0};  // named: figures and text speak of its cells
  return {f, build(f, options), draw::viewer_at(50 * pi / 180)};
}

}  // namespace reflectree::method

int main(int count, char** arguments) {
  using namespace reflectree;
  if (count != 2 || arguments[1][0] == '-') {
    const bool help = count == 2 && std::string_view(arguments[1]) == "--help";
    std::fputs("Usage: method_figures DIRECTORY\nDraws the figures of docs/method.md as SVG.\n",
               help ? stdout : stderr);
    return help ? 0 : 2;
  }
  const std::filesystem::path directory = arguments[1];
  try {
    std::filesystem::create_directories(directory);
    const method::Example example = method::make_example();
    const std::pair<const char*, draw::Figure> figures[] = {
        {"overview", method::overview_figure(example)},
        {"problem", method::problem_figure(example)},
        {"domains", method::domains_figure()},
        {"slabs", draw::slabs_figure(example.data)},
        {"normalised-bounds", method::normalised_bounds_figure()},
        {"tree", method::tree_growth_figure(example)},
        {"descent", method::descent_figure(example)},
        {"corner-codes", method::corner_codes_figure()},
        {"rejection", method::rejection_figure(example)},
        {"restart", method::restart_figure(example)},
        {"one-shot", method::one_shot_figure(example)},
        {"albedo", method::albedo_figure()},
    };
    for (const auto& [name, figure] : figures) {
      const std::filesystem::path path = directory / (std::string(name) + ".svg");
      std::ofstream file(path, std::ios::binary);
      file << draw::to_svg(figure);
      if (!file.flush()) throw Error("cannot be written", path.string(), "check the directory");
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "method_figures: %s\n", error.what());
    return 2;
  }
  return 0;
}
