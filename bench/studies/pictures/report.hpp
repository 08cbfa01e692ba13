// SPDX-License-Identifier: Apache-2.0
// The study in pictures as a page.
#pragma once

#include "page.hpp"
#include "settings.hpp"
#include "verdict.hpp"

namespace reflectree::pictures {

// What was asked for.
struct Plan {
  int width = 450, height = 200;
  int samples = 25;      // per pixel
  int rounds = 4;        // seeds
  int other_rounds = 3;  // of the other two integrators
  int reference = 400;   // samples of the converged picture
  int directions = 16;   // per pixel, where ways of reducing variance are combined
  std::uint64_t seed = 1;
  std::string ours = "one-shot";      // whom the verdict is about
  std::vector<std::string> samplers;  // empty: all
  std::vector<std::string> parts;     // of parts(); empty: all
  std::vector<const Setting*> settings;
};

// The methods and "ways": what can be asked for by itself.
std::vector<std::string> parts();
bool is_wanted(const Plan& plan, std::string_view part);
// The methods' names, and those samplers that each is shown with.
std::vector<std::string> methods();
bool is_wanted(const Plan& plan, std::string_view method, std::string_view sampler);
// Of whose pictures are shown.
std::vector<std::string> shown_samplers();
std::string picture_file(const Setting& setting, const std::string& sampler, bool error);

// Parts of the page, in a file each.
void add_verdict(Page& page, const Verdict& verdict);
void add_scene(Page& page, const Results& results, const Plan& plan, const Setting& setting);
void add_ways(Page& page, const Results& results, const Plan& plan);

Page page_of(const Results& results, const Plan& plan);

std::string shown(const Estimate& e);
std::string shown(double x);

}  // namespace reflectree::pictures
