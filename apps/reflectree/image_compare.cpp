// SPDX-License-Identifier: Apache-2.0
// image-compare: how far one picture is from another.
#include "reflectree/picture/image_compare.hpp"
#include "commands.hpp"
#include "reflectree/picture/flip.hpp"

namespace reflectree::cli {

namespace {

struct Options {
  std::string a, b, map, flip;
  double scale = .02;
  ImageCompareOptions how;
  FlipOptions eye;
};

// Channels of other names, such as stderr.R, stay; what is in sRGB becomes linear light.
Image linear(const std::string& path) {
  Image image = read_image(path);
  return image.encoded || image.find("R") < 0 ? rgb_of(image, path) : image;
}

int run_compare(const Context& context, const Options& o) {
  const Image a = linear(o.a), b = linear(o.b);
  const ImageDifference d = compare_images(a, b, o.how);
  if (!o.map.empty()) write_png(o.map, difference_map(a, b, o.how.block, o.scale));
  const Image seen = flip_difference(b, a, o.eye);
  if (!o.flip.empty()) write_png(o.flip, heat_image(seen));
  Json json;
  json["flip"] = image_mean(seen);
  std::string text = fmt::format("{:8}{:>12}{:>12}{:>11}{:>9}{:>12}{:>12}\n", "channel", "mean A", "mean B",
                                 "A / B - 1", "z", "MSE", "relMSE");
  for (const auto& c : d.channels) {
    const double z = c.mean_error > 0 ? (c.mean_a - c.mean_b) / c.mean_error : 0;
    text += fmt::format("{:8}{:12.6g}{:12.6g}{:10.3f}%{:9.2f}{:12.4g}{:12.4g}\n", c.channel, c.mean_a,
                        c.mean_b, 100 * (c.mean_a / c.mean_b - 1), z, c.mse, c.relative_mse);
    json["channels"].push_back({{"channel", c.channel},
                                {"mean_a", c.mean_a},
                                {"mean_b", c.mean_b},
                                {"mean_error", c.mean_error},
                                {"mse", c.mse},
                                {"relative_mse", c.relative_mse}});
  }
  text += fmt::format("FLIP {:.4f}\n", image_mean(seen));
  if (d.z) {
    text += fmt::format("z-scores of {} blocks of {} pixels ({} left out), quantiles:\n", d.z->blocks,
                        o.how.block * o.how.block, d.z->left_out);
    for (std::size_t i = 0; i < d.z->quantiles.size(); ++i) {
      text += fmt::format("{:8.0f} %{:8.2f}\n", 100 * z_probabilities[i], d.z->quantiles[i]);
      json["z"].push_back({{"probability", z_probabilities[i]}, {"quantile", d.z->quantiles[i]}});
    }
  }
  if (context.json) {
    context.print_json("image-compare", json);
  } else {
    context.print(text);
  }
  return exit_success;
}

}  // namespace

void add_image_compare(CLI::App& app, Context& context, Run& run) {
  CLI::App* command =
      app.add_subcommand("image-compare", "Compare two pictures: means, MSE, relMSE, FLIP, z-scores");
  auto o = std::make_shared<Options>();
  command->add_option("a", o->a, "Picture")->required()->type_name("A");
  command->add_option("b", o->b, "Picture to compare with, the reference")->required()->type_name("B");
  command->add_option("--block", o->how.block, "Side of the blocks whose z-scores are taken")
      ->check(CLI::Range(1, 4096).description(""))
      ->capture_default_str()
      ->type_name("PIXELS");
  command->add_option("-o,--map", o->map, "PNG: red where A is brighter, blue where darker")
      ->type_name("FILE");
  command->add_option("--scale", o->scale, "Relative difference of full colour in the map")
      ->check(CLI::Range(1e-6, 1e6).description(""))
      ->capture_default_str()
      ->type_name("X");
  command->add_option("--flip", o->flip, "PNG of FLIP, what an eye would see: black, red, yellow, white")
      ->type_name("FILE");
  command->add_option("--exposure", o->eye.exposure, "Stops by which both are brightened for FLIP")
      ->type_name("EV");
  command->add_option("--ppd", o->eye.pixels_per_degree, "Pixels per degree on FLIP's screen")
      ->check(CLI::Range(1., 999.).description(""))
      ->capture_default_str()
      ->type_name("X");
  command->callback([&context, &run, o] { run = [&context, o] { return run_compare(context, *o); }; });
}

}  // namespace reflectree::cli
