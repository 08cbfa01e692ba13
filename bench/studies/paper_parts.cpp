// SPDX-License-Identifier: Apache-2.0
#include "paper_parts.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "judged.hpp"
#include "reflectree/draw/material_figures.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/peers/paper_sampler.hpp"
#include "reflectree/peers/paper_statistics.hpp"

namespace reflectree::study {

namespace {

namespace fs = std::filesystem;
using Draws = std::vector<DirectionSample<Spectrum>>;

AnyBrdf brdf_of(const char* text) { return make_brdf(parse_material(text)); }

// The leaves' squares over the disk of samples_figure's place.
std::string squares(const PaperTree& tree, double x, double y, double radius) {
  std::string out;
  for (const PaperNode& n : tree.nodes) {
    if (n.first_child >= 0) continue;
    const PaperBox box = clip_to_disk(n);
    if (!(box.area() > 0)) continue;
    out += draw::rectangle(x + radius * box.x0, y - radius * box.y1, radius * (box.x1 - box.x0),
                           radius * (box.y1 - box.y0), "cells-dark");
  }
  return out;
}

draw::Figure tree_picture(const char* text, const AnyBrdf& f, const PaperTree& tree, Direction wo) {
  constexpr double radius = 160, x = 180, y = 190;
  const draw::DiskImage image = draw::target_image(f, {}, wo);
  draw::Figure figure{
      360, 370, std::string("Quadtree, ") + text, "Leaves of the paper's tree over the target.", {}};
  figure.body =
      draw::disk_raster(image, draw::log_range(image), x, y, 2 * radius, "pale") +
      draw::circle(x, y, radius, "rim") + squares(tree, x, y, radius) +
      draw::label(x, 18,
                  std::string(text) + ", " + std::to_string((tree.nodes.size() * 3 + 1) / 4) + " leaves",
                  draw::Anchor::middle, "head");
  return figure;
}

// The mean square error of the mean of a group, averaged over rotations: what is left of the mean square of
// the group's radiance without that of independent groups (illumination.hpp).
template <class Group>
double grouped_error(const Group& group, std::size_t groups, const Illumination& light) {
  double within = 0, across = 0;
  Draws before;
  const auto radiance = [&](const Draws& a, const Draws& b) {
    double sum = 0;
    for (const auto& p : a) {
      for (const auto& q : b) {
        double w = 0;
        for (int c = 0; c < std::min(p.weight.channels(), q.weight.channels()); ++c)
          w += double(p.weight[c]) * double(q.weight[c]);
        if (w > 0) sum += w * light.correlation_at(&p == &q ? 1 : double(dot(p.wi, q.wi)));
      }
    }
    return sum;
  };
  for (std::size_t g = 0; g <= groups; ++g) {
    const Draws now = group(g);
    if (g > 0) within += radiance(now, now), across += radiance(now, before);
    before = now;
  }
  return max(0., (within - across) / double(groups));
}

// side^2 directions, one in each equal part of the hemisphere; weights over their number.
Draws jittered(const AnyBrdf& f, Direction wo, int side, Pcg32& u) {
  Draws draws;
  for (int i = 0; i < side * side; ++i) {
    const float z = 1 - (float(i % side) + to_unit_float(u())) / float(side);
    const float phi = 2 * pi * (float(i / side) + to_unit_float(u())) / float(side);
    const float r = sqrt(max(0.f, 1 - z * z));
    const Direction wi{r * cos(phi), r * sin(phi), z};
    draws.push_back({wi, 1 / (2 * pi), scaled_value(eval(f, wo, wi), 2 * pi * z / float(side * side))});
  }
  return draws;
}

struct MeasuredFile {
  std::string path, member;
};

std::vector<std::string> with_ending(const std::string& folder, const char* ending) {
  std::vector<std::string> paths;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    if (entry.path().extension() == ending) paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

// Real MERL files first, then the networks fitted to MERL and the RGL files of the data folder.
std::vector<MeasuredFile> measured_files(const Measured& what) {
  std::vector<MeasuredFile> files, of_data;
  if (!what.merl.empty()) {
    for (const std::string& path : with_ending(what.merl, ".binary")) files.push_back({path, ""});
    if (files.empty()) throw Error("no .binary files in this folder", what.merl, "name another after --merl");
  }
  const char* data = std::getenv("REFLECTREE_DATA");
  if (!data || !fs::is_directory(data)) return files;
  const std::string networks = std::string(data) + "/nbrdf/nbrdf_merl.csv";
  if (fs::exists(networks)) {
    for (const std::string& member : list_members(networks)) of_data.push_back({networks, member});
  }
  for (const std::string& path : with_ending(std::string(data) + "/rgl", ".bsdf"))
    of_data.push_back({path, ""});
  for (std::size_t i = 0; i < of_data.size(); i += what.all ? 1 : 12) files.push_back(of_data[i]);
  return files;
}

}  // namespace

void show_pictures(const std::string& folder) {
  std::printf("## Quadtree and samples\n\n    build/bin/study_paper docs/results\n\n45°; n_max 4.\n\n");
  for (const auto& [text, file] : {std::pair{"ggx:alpha=0.1", "paper-tree-ggx"},
                                   std::pair{"phong:kd=0.3,ks=0.5,n=20", "paper-tree-phong"}}) {
    const AnyBrdf f = brdf_of(text);
    const Direction wo = wo_at_deg(45);
    const PaperSampler paper(f, {}, wo, {});
    Draws draws(2500);
    UniformBits u{Pcg32(1)};
    draws.resize(paper.sample_n(wo, u, draws));
    std::vector<Direction> directions;
    for (const auto& d : draws) directions.push_back(d.wi);
    const draw::Figure figure =
        draw::side_by_side(text, "The paper's quadtree and 2500 samples of it.",
                           {tree_picture(text, f, paper.trees()[0], wo),
                            draw::samples_figure(draw::target_image(f, {}, wo), wo, directions)},
                           2);
    if (!folder.empty()) write_file_atomically(folder + "/" + file + ".svg", draw::to_svg(figure));
    std::printf("![%s](%s.svg)\n\n", text, file);
  }
}

void show_few_against_many() {
  std::printf(
      "## 5² and 10² uniform against 10² adaptive samples\n\n    build/bin/study_paper "
      "docs/results\n\nRelative "
      "RMSE of reflected radiance at 45°, averaged over rotations of the light. Uniform ones are jittered; "
      "the "
      "adaptive ones are divided among the leaves in one call.\n\n| material | light | 5² uniform | 10² "
      "uniform | "
      "10² adaptive | 10² uniform / adaptive |\n|---|---|---|---|---|---|\n");
  const std::vector<Illumination> lights = procedural_illuminations();
  const Direction wo = wo_at_deg(45);
  constexpr std::size_t groups = 400;
  for (const char* text : {"lambert", "phong:kd=0.3,ks=0.5,n=20", "ggx:alpha=0.3", "ggx:alpha=0.1"}) {
    const AnyBrdf f = brdf_of(text);
    const double albedo = reference_albedo(target_function(f), wo).value;
    const PaperSampler paper(f, {}, wo, {});
    for (const Illumination& light : lights) {
      const auto uniform = [&](int side) {
        return [&f, wo, side](std::size_t g) {
          Pcg32 u(g + 1, 7);
          return jittered(f, wo, side, u);
        };
      };
      const auto adaptive = [&](std::size_t g) {
        UniformBits u{Pcg32(g + 1, 8)};
        Draws draws(100);
        draws.resize(paper.sample_n(wo, u, draws));
        for (auto& d : draws) d.weight = scaled_value(d.weight, 1.f / 100);
        return draws;
      };
      const double scale = light.mean * albedo;
      const double five = std::sqrt(grouped_error(uniform(5), groups, light)) / scale;
      const double ten = std::sqrt(grouped_error(uniform(10), groups, light)) / scale;
      const double ours = std::sqrt(grouped_error(adaptive, groups, light)) / scale;
      std::printf("| %s | %s | %.3g | %.3g | %.3g | %.3g |\n", text, light.name.c_str(), five, ten, ours,
                  ten / ours);
    }
  }
  std::printf("\n");
}

void show_time() {
  std::printf(
      "## Error against time: adaptive, direct and general methods\n\n    build/bin/study_paper "
      "docs/results\n\nMicroseconds (*) to a relative RMSE of 1 %% at 45° under the sky. Direct: the model's "
      "own "
      "sampler.\n\n| sampler |");
  constexpr const char* materials[] = {"lambert", "ggx:alpha=0.3", "ggx:alpha=0.05", "plastic"};
  StudyOptions o;
  o.samples = 1U << 15U;
  const std::vector<Illumination> lights{procedural_illuminations()[1]};
  std::vector<JudgedSubject> subjects;
  for (const char* text : materials) {
    subjects.push_back(subject_of(text, brdf_of(text), {45}, lights, o));
    std::printf(" %s |", text);
  }
  std::printf("\n|---|---|---|---|---|\n");
  for (const SamplerInfo& info : samplers()) {
    std::printf("| %s |", info.name == "textbook" ? "textbook (direct)" : std::string(info.name).c_str());
    for (const JudgedSubject& s : subjects) {
      const auto sampler = info.make({s.f, parse_material(s.name), {}, nullptr}, {});
      if (!sampler) {
        std::printf(" – |");
        continue;
      }
      const Judged j = judged(*sampler, s, lights, o);
      std::printf(" %.3g |", j.cost / j.x_floor * j.ns * 1e-3 / 1e-4);
    }
    std::printf("\n");
  }
  std::printf("\n");
}

void show_measured(const Measured& what) {
  std::printf(
      "\n## Memory and precomputation of measured materials\n\n    REFLECTREE_DATA=... build/bin/study_paper "
      "docs/results%s%s\n\n",
      what.all ? " --all" : "", what.merl.empty() ? "" : " --merl FOLDER");
  const std::vector<MeasuredFile> files = measured_files(what);
  if (files.empty()) {
    std::printf("Left out: REFLECTREE_DATA names no folder, and --merl was not given.\n");
    return;
  }
  std::printf(
      "90 elevations, n_max 4; ours: both modes of one build.\n\n| material | leaves | MB | build s (*) | "
      "trials "
      "| unmet | worst error of I_0 | ours MB | ours build s (*) |\n|---|---|---|---|---|---|---|---|---|\n");
  std::vector<double> mb, seconds, our_mb, our_seconds;
  for (const auto& [path, member] : files) {
    const AnyBrdf f = load_brdf(path, member);
    const double start = thread_seconds();
    const PaperSampler paper(f, {}, PaperOptions{});
    const double middle = thread_seconds();
    const SamplerData built = build(f);
    const double end = thread_seconds();
    const PaperStatistics s = paper_statistics(f, {}, paper.trees(), {}, 2);
    mb.push_back(double(paper.bytes()) / 1e6), seconds.push_back(middle - start);
    our_mb.push_back(double(bytes_of(pack(built))) / 1e6), our_seconds.push_back(end - middle);
    const std::string name = member.empty() ? fs::path(path).stem().string() : member;
    std::printf("| %s | %zu | %.2f | %.2f | %.2f | %zu | %.1e | %.3f | %.2f |\n", name.c_str(), s.leaves,
                mb.back(), seconds.back(), s.trials, s.unmet, s.albedo_error, our_mb.back(),
                our_seconds.back());
    std::fflush(stdout);
  }
  const auto median = [](std::vector<double> x) {
    if (x.empty()) return 0.;
    std::nth_element(x.begin(), x.begin() + std::ptrdiff_t(x.size() / 2), x.end());
    return x[x.size() / 2];
  };
  std::printf("| median of %zu | | %.2f | %.2f | | | | %.3f | %.2f |\n", mb.size(), median(mb),
              median(seconds), median(our_mb), median(our_seconds));
}

}  // namespace reflectree::study
