// SPDX-License-Identifier: Apache-2.0
// draw: pictures of a material, its tree and its samples.
#include <algorithm>
#include <filesystem>

#include "commands.hpp"
#include "interrupt.hpp"
#include "measure.hpp"
#include "pictures.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/open.hpp"

namespace reflectree::cli {

namespace fs = std::filesystem;

draw::ReportMaterial draw_material(const OpenedSampler& subject, const std::vector<double>& theta_o_deg,
                                   std::size_t samples, std::uint64_t seed) {
  std::vector<float> theta_o;
  for (const double theta : theta_o_deg) theta_o.push_back(float(theta * pi_v<double> / 180));
  draw::ReportMaterial material = draw::material_report(subject.f, subject.data, theta_o, [&](Direction wo) {
    Pcg32 u(seed, 3);
    std::vector<Direction> drawn;
    for (std::size_t i = 0; i < samples; ++i) {
      if (i % 4096 == 0 && interrupted()) throw Cancelled();
      if (const auto s = subject.sampler.exact.sample(wo, u)) drawn.push_back(s->wi);
    }
    return drawn;
  });
  material.figures.kib = double(bytes_of(*subject.packed)) / 1024;
  material.figures.build_seconds = subject.build_seconds;
  return material;
}

void make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path)) {
    throw Error("the folder cannot be made (" + error.message() + ")", path, "choose another with -o");
  }
}

namespace {

constexpr std::size_t drawn_samples = 200'000;

struct Options {
  std::string subject, output, at;
  std::string theta_o_deg = "15,45,75";
  BuildChoices choices;
};

std::vector<draw::Figure> all_figures(const draw::ReportMaterial& material) {
  std::vector<draw::Figure> figures;
  for (const draw::ReportView& view : material.views) {
    figures.insert(figures.end(), view.pictures.begin(), view.pictures.end());
  }
  return figures;
}

// One SVG per picture, and the page.
std::vector<std::string> write_folder(const std::string& folder, const draw::ReportMaterial& material,
                                      const std::string& html) {
  static constexpr const char* names[] = {"target", "tree", "samples", "lobe"};
  static constexpr const char* overview_names[] = {"slabs", "square"};
  make_folder(folder);
  std::vector<std::string> written;
  const auto write = [&](const std::string& name, const std::string& text) {
    written.push_back((fs::path(folder) / name).string());
    write_file_atomically(written.back(), text);
  };
  for (const draw::ReportView& view : material.views) {
    for (std::size_t i = 0; i < view.pictures.size(); ++i) {
      const std::string name = i < std::size(names) ? names[i] : "picture" + std::to_string(i);
      write(fmt::format("{}_{:g}deg.svg", name, view.theta_o_deg), draw::to_svg(view.pictures[i]));
    }
  }
  for (std::size_t i = 0; i < material.overview.size(); ++i) {
    const std::string name =
        i < std::size(overview_names) ? overview_names[i] : "overview" + std::to_string(i);
    write(name + ".svg", draw::to_svg(material.overview[i]));
  }
  write("index.html", html);
  return written;
}

int run_draw(const Context& context, const Options& o) {
  const std::vector<double> theta_o_deg = parse_theta_o(o.theta_o_deg);
  const OpenedSampler subject = open_sampler(context, o.subject, o.choices, o.at);
  const draw::ReportMaterial material = draw_material(subject, theta_o_deg, drawn_samples, context.seed);
  draw::ReportMeta meta;
  meta.command = "reflectree draw";
  meta.version = REFLECTREE_VERSION;
  std::vector<std::string> written{o.output};
  if (o.output.ends_with(".svg")) {
    const std::vector<draw::Figure> figures = all_figures(material);
    const int columns = int(figures.size() / std::max<std::size_t>(material.views.size(), 1));
    write_file_atomically(o.output, draw::to_svg(draw::side_by_side(
                                        material.name, "Target, tree, samples and lobe", figures, columns)));
  } else if (o.output.ends_with(".html")) {
    write_file_atomically(o.output, draw::report_html({material}, meta));
  } else {
    written = write_folder(o.output, material, draw::report_html({material}, meta));
  }
  if (context.json) {
    context.print_json(
        "draw", {{"material", subject.data.material}, {"theta_o_deg", theta_o_deg}, {"files", written}});
  } else {
    for (const std::string& path : written) context.print(path + "\n");
  }
  return exit_success;
}

}  // namespace

void add_draw(CLI::App& app, Context& context, Run& run) {
  CLI::App* command =
      app.add_subcommand("draw", "Draw a material: its target, the tree over it, samples, and the lobe");
  auto o = std::make_shared<Options>();
  command->add_option("SAMPLER", o->subject, "A sampler file, or a material (built on the fly)")
      ->type_name("")
      ->required();
  command
      ->add_option("-o,--output", o->output, "A .html page, one .svg, or a folder for a page and many .svg")
      ->type_name("PATH")
      ->required();
  command
      ->add_option("--theta-o-deg", o->theta_o_deg,
                   "Elevations of wo from the normal, with commas between them")
      ->type_name("DEG,...")
      ->capture_default_str();
  add_member_choice(*command, o->at);
  add_build_choices(*command, o->choices);
  command->footer(
      "Examples:\n"
      "  reflectree draw gold.rfl -o gold.html\n"
      "  reflectree draw '0.3*lambert + ggx:alpha=0.1' -o pictures --theta-o-deg 10,80");
  command->callback([&context, &run, o] { run = [&context, o] { return run_draw(context, *o); }; });
}

}  // namespace reflectree::cli
