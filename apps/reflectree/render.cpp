// SPDX-License-Identifier: Apache-2.0
// render: a scene to an EXR, with a PNG beside it.
#include <filesystem>

#include "commands.hpp"
#include "reflectree/error.hpp"
#include "reflectree/render/film.hpp"

namespace reflectree::cli {

namespace {

struct Options {
  std::string scene, output = "out.exr";
  std::vector<std::string> defines;
  render::SceneOptions reading;
  int samples = 0;
};

int run_render(const Context& context, Options& o) {
  for (const std::string& define : o.defines) {
    const std::size_t at = define.find('=');
    if (at == std::string::npos || at == 0)
      throw Error("no '=' in '" + define + "'", "-D", "write NAME=VALUE");
    o.reading.defines[define.substr(0, at)] = define.substr(at + 1);
  }
  const render::Scene scene = render::load_scene(o.scene, o.reading, context.host("building"));
  const Image image = render::render(scene, {.samples = o.samples, .seed = context.seed}, context.host("rendering"));
  const std::string png = std::filesystem::path(o.output).replace_extension(".png").string();
  write_exr(o.output, image);
  write_png(png, image);
  context.say(fmt::format("saved {} and {}", o.output, png));
  return exit_success;
}

}  // namespace

void add_render(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand("render", "Render a Mitsuba 3 scene by path tracing");
  auto o = std::make_shared<Options>();
  command->add_option("scene", o->scene, "Scene (.xml)")->required()->type_name("SCENE");
  command->add_option("-o,--output", o->output, "OpenEXR picture; a PNG is put beside it")
      ->capture_default_str()
      ->type_name("FILE");
  command->add_option("-D", o->defines, "What $NAME stands for in the scene")->type_name("NAME=VALUE");
  command->add_option("--spp", o->samples, "Samples a pixel; 0: the scene's")
      ->check(CLI::Range(0, 1 << 30).description(""))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--sampler", o->reading.sampler, "Sampler of type=\"reflectree\" materials")
      ->capture_default_str()
      ->type_name("NAME");
  command->callback([&context, &run, o] { run = [&context, o] { return run_render(context, *o); }; });
}

}  // namespace reflectree::cli
