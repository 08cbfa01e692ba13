// SPDX-License-Identifier: Apache-2.0
// info: the facts of a sampler.
#include "info.hpp"

#include <algorithm>

#include "commands.hpp"
#include "measured.hpp"

namespace reflectree::cli {

namespace {

const char* name_of(TargetKind kind) {
  switch (kind) {
    case TargetKind::norm:
      return "norm";
    case TargetKind::luminance:
      return "luminance";
    case TargetKind::maximum:
      return "maximum";
    case TargetKind::channel:
      return "channel";
  }
  return "unknown";
}

std::string target_text(const Target& target) {
  std::string text = name_of(target.kind);
  if (target.kind == TargetKind::channel) text += ":" + std::to_string(target.index);
  return text;
}

struct Leaves {
  std::size_t total = 0, largest = 0;
};
template <class T>
Leaves leaves_of(const std::vector<T>& trees) {
  Leaves leaves;
  for (const CanonicalTree& tree : trees) {
    leaves.total += tree.mass.size();
    leaves.largest = std::max(leaves.largest, tree.mass.size());
  }
  return leaves;
}

// Of a proved bound to the best value seen in its leaf.
float largest_ratio(const SamplerData& data) {
  float ratio = 0;
  for (const MajorantTree& tree : data.exact) ratio = max(ratio, tree.bound_ratio);
  return ratio;
}

// What is told of samplers and of those of families.
struct Facts {
  const SamplerData& data;
  const PackedSampler& packed;
  int channels;
  const FilePlaces& places;
  std::optional<std::uint64_t> file_size;
  std::optional<double> build_seconds;
};

Json parameters_json(const SamplerData& d) {
  Json all = Json::array();
  for (const KnownParameter& p : d.parameters) {
    all.push_back({{"name", p.range.name},
                   {"from", shortest(p.range.lo)},
                   {"to", shortest(p.range.hi)},
                   {"logarithmic", p.logarithmic}});
  }
  return all;
}

Json json_of(const Facts& s, const std::vector<MeasuredFile>& measured) {
  const SamplerData& d = s.data;
  const auto certified = std::count_if(d.exact.begin(), d.exact.end(), [](const MajorantTree& tree) {
    return tree.status == BoundStatus::certified;
  });
  const auto [low, high] = std::minmax_element(d.albedo.albedo.begin(), d.albedo.albedo.end());
  const bool proved = d.albedo.proved_error > 0;
  Json json{{"material", d.material},
            {"channels", s.channels},
            {"target", target_text(d.target)},
            {"domain", reflectree::name_of(d.domain.kind)},
            {"half_square", d.domain.half()},
            {"symmetry", reflectree::name_of(d.frame.symmetry)},
            {"axis_deg", d.frame.isotropic() ? Json() : Json(shortest(d.frame.axis * 180 / pi))},
            {"stretch", d.domain.kind == DomainKind::slope_star ? Json(shortest(d.domain.stretch)) : Json()},
            {"exact_slabs", d.exact.size()},
            {"exact_leaves", leaves_of(d.exact).total},
            {"largest_exact_tree", leaves_of(d.exact).largest},
            {"one_shot_slabs", d.one_shot.size()},
            {"one_shot_leaves", leaves_of(d.one_shot).total},
            {"certified_slabs", certified},
            {"estimated_slabs", std::ptrdiff_t(d.exact.size()) - certified},
            {"largest_bound_ratio", certified > 0 ? Json(shortest(largest_ratio(d))) : Json()},
            {"bytes_in_memory", bytes_of(s.packed)},
            {"bytes_on_disk", nullptr},
            {"albedo_minimum", shortest(*low)},
            {"albedo_maximum", shortest(*high)},
            {"albedo_nodes", d.albedo.albedo.size()},
            {"albedo_relative_error", shortest(d.albedo.relative_error)},
            {"albedo_proved_error", proved ? Json(shortest(d.albedo.proved_error)) : Json()},
            {"expected_trials", shortest(d.report.expected_trials)},
            {"overshoot_mass", shortest(d.report.overshoot_mass)},
            {"one_shot_variance", shortest(d.report.one_shot_variance)},
            {"asymmetry", shortest(d.report.asymmetry)},
            {"evaluations", d.report.evaluations},
            {"notes", d.report.notes},
            {"build_seconds", nullptr}};
  if (s.file_size) json["bytes_on_disk"] = *s.file_size;
  if (s.build_seconds) json["build_seconds"] = *s.build_seconds;
  if (!d.parameters.empty()) json["parameters"] = parameters_json(d);
  json["measured"] = measured_json(measured);
  return json;
}

std::string bounds_text(const Facts& s) {
  const auto certified =
      std::count_if(s.data.exact.begin(), s.data.exact.end(),
                    [](const MajorantTree& tree) { return tree.status == BoundStatus::certified; });
  const auto estimated = std::ptrdiff_t(s.data.exact.size()) - certified;
  if (certified == 0) return "estimated: sampled maxima, attacked at build";
  const std::string ratio =
      fmt::format("at most {:.3g} times the best value seen in their leaves", largest_ratio(s.data));
  if (estimated == 0) return "certified: proved; " + ratio;
  return fmt::format("certified in {} slabs, estimated in {}; the proved ones are {}", certified, estimated,
                     ratio);
}

void show(const Context& context, const std::string& command, const Facts& s) {
  const std::vector<MeasuredFile> measured = measured_files(s.data.material, s.places);
  if (context.json) {
    context.print_json(command, json_of(s, measured));
    return;
  }
  const SamplerData& d = s.data;
  const auto line = [&context](const char* name, const std::string& value) {
    context.print(fmt::format("{:<18} {}\n", name, value));
  };
  const Leaves exact = leaves_of(d.exact), one_shot = leaves_of(d.one_shot);
  const auto [low, high] = std::minmax_element(d.albedo.albedo.begin(), d.albedo.albedo.end());
  line("material", d.material);
  line("channels", std::to_string(s.channels));
  line("target", target_text(d.target));
  line("domain", std::string(reflectree::name_of(d.domain.kind)) +
                     (d.domain.half() ? ", half a square (mirror symmetry)" : ", whole square"));
  std::string known = "theta_o";
  if (!d.frame.isotropic()) {
    known = "theta_o and phi_o";
    line("anisotropic", fmt::format("{}, axis at {:.4g} degrees", reflectree::name_of(d.frame.symmetry),
                                    d.frame.axis * 180 / pi));
  }
  for (const KnownParameter& p : d.parameters) {
    known += " and " + p.range.name;
    line("family", fmt::format("{} from {:.6g} to {:.6g}{}", p.range.name, p.range.lo, p.range.hi,
                               p.logarithmic ? ", divided by its logarithm" : ""));
  }
  line("exact", fmt::format("{} slabs of {}, {} leaves, at most {} in a slab", d.exact.size(), known,
                            exact.total, exact.largest));
  line("one-shot", fmt::format("{} slabs of {}, {} leaves, at most {} in a slab", d.one_shot.size(), known,
                               one_shot.total, one_shot.largest));
  line("bounds", bounds_text(s));
  line("memory", fmt::format("{:.1f} KiB packed", double(bytes_of(s.packed)) / 1024));
  if (s.file_size) line("on disk", fmt::format("{:.1f} KiB", double(*s.file_size) / 1024));
  line("albedo of target",
       fmt::format("{:.4g} to {:.4g}, {} nodes, relative error at most {:.3g} up to 89.9 degrees{}",
                   *low / d.target.scale, *high / d.target.scale, d.albedo.albedo.size(),
                   d.albedo.relative_error,
                   d.albedo.proved_error > 0 ? fmt::format(" ({:.3g} proved)", d.albedo.proved_error) : ""));
  line("expected trials", fmt::format("{:.4g} in the worst slab", d.report.expected_trials));
  const bool proved = std::all_of(d.exact.begin(), d.exact.end(), [](const MajorantTree& tree) {
    return tree.status == BoundStatus::certified;
  });
  line("overshoot mass", proved ? "0, proved"
                                : fmt::format("{:.2g} in the worst slab, as the build's attack estimates it",
                                              d.report.overshoot_mass));
  line("one-shot variance", fmt::format("{:.3g} relative, median over slabs", d.report.one_shot_variance));
  line("asymmetry", fmt::format("{:.2g} between mirror images", d.report.asymmetry));
  line("evaluations", std::to_string(d.report.evaluations));
  if (s.build_seconds) line("build", fmt::format("{:.2f} s", *s.build_seconds));
  for (const std::string& note : d.report.notes) line("note", note);
  for (const MeasuredFile& file : measured) {
    for (const auto& [name, value] : measured_lines(file)) line(name, value);
  }
}

}  // namespace

void show_info(const Context& context, const std::string& command, const OpenedSampler& s) {
  show(context, command, {s.data, *s.packed, s.f.channels(), s.places, s.file_size, s.build_seconds});
}
void show_info(const Context& context, const std::string& command, const OpenedFamily& s) {
  show(context, command, {s.data, *s.packed, s.family.channels(), s.places, s.file_size, s.build_seconds});
}

void add_info(CLI::App& app, Context& context, Run& run) {
  CLI::App* command = app.add_subcommand("info", "Show the facts of a sampler, saved or built on the fly");
  struct Options {
    std::string subject;
    BuildChoices choices;
  };
  auto o = std::make_shared<Options>();
  command->add_option("SAMPLER", o->subject, "A sampler file, or a material (built on the fly)")
      ->type_name("")
      ->required();
  add_build_choices(*command, o->choices);
  command->footer(
      "Examples:\n"
      "  reflectree info gold.rfl\n"
      "  reflectree info --json ggx:alpha=0.1");
  command->callback([&context, &run, o] {
    run = [&context, o] {
      if (names_family(o->subject, context.places())) {
        show_info(context, "info", open_family(context, o->subject, o->choices));
      } else {
        show_info(context, "info", open_sampler(context, o->subject, o->choices));
      }
      return int(exit_success);
    };
  });
}

}  // namespace reflectree::cli
