// SPDX-License-Identifier: Apache-2.0
// render: a scene to an EXR, with a PNG beside it.
#include <filesystem>

#include "commands.hpp"
#include "phase_clock.hpp"
#include "reflectree/error.hpp"
#include "reflectree/render/film/film.hpp"

namespace reflectree::cli {

namespace {

struct Options {
  std::string scene, output = "out.exr";
  std::vector<std::string> defines;
  render::SceneOptions reading;
  render::RenderOptions how;
  std::string technique, integrator, points;
  int split = 0, photons = 0;
  float radius = 0, alpha = 0;
  bool no_gather = false;
  bool resume = false, profile = false;
};

render::Technique technique_of(const std::string& name) {
  using render::Technique;
  return name == "power"       ? Technique::power
         : name == "light"     ? Technique::light
         : name == "brdf"      ? Technique::surface
         : name == "resampled" ? Technique::resampled
                               : Technique::balance;
}

void say_profile(const Context& context, const PhaseClock::Reading& r, double paths) {
  using render::Phase;
  const auto share = [&](Phase p) { return r.share[std::size_t(p)]; };
  if (context.json) {
    context.print_json("render", {{"cpu_seconds", r.seconds},
                                  {"paths_per_second", paths / r.seconds},
                                  {"timer_rings", r.rings},
                                  {"traversal", share(Phase::traversal)},
                                  {"sample", share(Phase::sample)},
                                  {"eval", share(Phase::eval)},
                                  {"rest", share(Phase::rest)}});
    return;
  }
  context.print(
      fmt::format("{:.2f} s of CPU time, {:.3f} million paths per second of one core, {} looks\n"
                  "traversal {:5.1f} %\nsample    {:5.1f} %\neval      {:5.1f} %\nrest      {:5.1f} %\n",
                  r.seconds, paths / r.seconds / 1e6, r.rings, 100 * share(Phase::traversal),
                  100 * share(Phase::sample), 100 * share(Phase::eval), 100 * share(Phase::rest)));
}

int run_render(const Context& context, Options& o) {
  for (const std::string& define : o.defines) {
    const std::size_t at = define.find('=');
    if (at == std::string::npos || at == 0)
      throw Error("no '=' in '" + define + "'", "-D", "write NAME=VALUE");
    o.reading.defines[define.substr(0, at)] = define.substr(at + 1);
  }
  render::Scene scene = render::load_scene(o.scene, o.reading, context.host("building"));
  for (const std::string& note : scene.notes) context.say("note: " + note);
  if (!o.integrator.empty()) scene.transport.method = *render::method_of(o.integrator);
  if (!o.points.empty()) scene.points.kind = *render::points_of(o.points);
  if (o.split > 0) scene.transport.split = o.split;
  if (o.photons > 0) scene.transport.photons.count = o.photons;
  if (o.radius > 0) scene.transport.photons.radius = o.radius;
  if (o.alpha > 0) scene.transport.photons.shrink = o.alpha;
  if (o.no_gather) scene.transport.photons.gather = false;
  const std::string sums = o.output + ".sums";
  render::Film film;
  if (o.resume) film = render::load_film(sums);
  o.how.seed = context.seed;
  if (!o.technique.empty()) o.how.technique = technique_of(o.technique);
  std::optional<PhaseClock> clock;
  if (o.profile) clock.emplace();
  const int before = film.samples;
  const bool whole = render::render_into(film, scene, o.how, context.host("rendering"));
  if (clock) say_profile(context, clock->stop(), double(film.samples - before) * scene.width * scene.height);
  if (film.samples == 0) throw Cancelled();
  const Image image = render::to_image(film);
  render::save_film(sums, film);
  const std::string png = std::filesystem::path(o.output).replace_extension(".png").string();
  write_exr(o.output, image);
  write_png(png, image);
  context.say(fmt::format("saved {} and {}, {} samples per pixel{}", o.output, png, film.samples,
                          whole ? "" : "; --resume goes on"));
  return whole ? exit_success : exit_interrupted;
}

}  // namespace

void add_render(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand("render", "Render a Mitsuba 3 scene");
  auto o = std::make_shared<Options>();
  command->add_option("scene", o->scene, "Scene (.xml)")->required()->type_name("SCENE");
  command->add_option("-o,--output", o->output, "OpenEXR picture; a PNG is put beside it")
      ->capture_default_str()
      ->type_name("FILE");
  command->add_option("-D", o->defines, "What $NAME stands for in the scene")->type_name("NAME=VALUE");
  command->add_option("--spp", o->how.samples, "Samples per pixel; 0: the scene's")
      ->check(CLI::Range(0, 1 << 30).description(""))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--sampler", o->reading.sampler, "Sampler of type=\"reflectree\" materials")
      ->capture_default_str()
      ->type_name("NAME");
  command
      ->add_option("--adjoint", o->reading.adjoint,
                   "Sampler of the side of light, for photons; else the same with a cosine lobe")
      ->type_name("NAME");
  command
      ->add_option("--time", o->how.seconds, "Render for so long instead; the picture depends on the machine")
      ->check(CLI::Range(0., 1e7).description(""))
      ->type_name("SECONDS");
  command->add_flag("--resume", o->resume, "Go on from FILE.sums, with the same scene and seed");
  command->add_flag("--profile", o->profile, "Tell where the time goes: traversal, sample, eval, rest");
  command
      ->add_option(
          "--technique", o->technique,
          "How lights are found: balance or power (both ways, by that heuristic), light, brdf; "
          "with --integrator direct, also resampled: brdf directions resampled by the light they see; "
          "else the scene's, which is balance if it says nothing")
      ->check(CLI::IsMember({"balance", "power", "light", "brdf", "resampled"}).description(""))
      ->type_name("NAME");
  command->add_option("--integrator", o->integrator, "path, direct, recursive or photons; else the scene's")
      ->check(CLI::IsMember({"path", "direct", "recursive", "photons"}).description(""))
      ->type_name("NAME");
  command->add_option("--points", o->points, "independent, stratified or sobol; else the scene's")
      ->check(CLI::IsMember({"independent", "stratified", "sobol"}).description(""))
      ->type_name("NAME");
  command->add_option("--split", o->split, "Directions at a hit: recursive, photons, direct")
      ->check(CLI::Range(1, 64).description(""))
      ->type_name("N");
  command->add_option("--photons", o->photons, "Light paths per pass; else as many as pixels")
      ->check(CLI::Range(1, 1 << 26).description(""))
      ->type_name("N");
  command->add_option("--radius", o->radius, "Photons' radius in the first pass; else four pixels")
      ->check(CLI::Range(1e-9, 1e9).description(""))
      ->type_name("LENGTH");
  command->add_option("--alpha", o->alpha, "How the radius shrinks, in (0, 1]; 1: it stays; else 2/3")
      ->check(CLI::Range(1e-3, 1.).description(""))
      ->type_name("X");
  command->add_flag("--no-gather", o->no_gather, "Look photons up where the camera's path ends");
  command->callback([&context, &run, o] { run = [&context, o] { return run_render(context, *o); }; });
}

}  // namespace reflectree::cli
