// SPDX-License-Identifier: Apache-2.0
// What compare is asked to measure: materials, samplers, lights.
#include <algorithm>
#include <filesystem>

#include "compare.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/format_table.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/picture/image.hpp"
#include "reflectree/text/joined_words.hpp"

namespace reflectree::cli {

namespace fs = std::filesystem;
using namespace study;

namespace {

// Of --quick, and where there is no measured file.
constexpr const char* built_in[] = {"lambert",       "oren_nayar",     "phong",         "ward:alpha=0.1",
                                    "cook_torrance", "ggx:alpha=0.5",  "ggx:alpha=0.1", "ggx:alpha=0.02",
                                    "plastic",       "retro_reflector"};

std::vector<std::string> default_materials(const Context& context, bool quick) {
  std::error_code ignored;
  const fs::path rgl = context.locate("rgl"), networks = context.locate("nbrdf/nbrdf_merl.csv");
  std::vector<std::string> measured;
  if (fs::is_directory(rgl, ignored)) {
    for (const auto& entry : fs::directory_iterator(rgl)) {
      if (entry.path().extension() == ".bsdf") measured.push_back("rgl/" + entry.path().filename().string());
    }
    std::sort(measured.begin(), measured.end());
  }
  if (fs::exists(networks, ignored)) {
    for (const std::string& m : list_members(networks.string()))
      measured.push_back("nbrdf/nbrdf_merl.csv#" + m);
  }
  if (!quick && !measured.empty()) return measured;
  if (measured.empty()) context.say("No measured files: name some, or set REFLECTREE_DATA");
  std::vector<std::string> all(std::begin(built_in), std::end(built_in));
  if (quick) all = {"lambert", "ggx:alpha=0.1", "plastic", "retro_reflector"};
  for (std::size_t i = 0; i < measured.size(); i += 15) all.push_back(measured[i]);
  return all;
}

// The measured files of a folder.
std::vector<std::string> files_of(const std::string& folder) {
  const std::vector<std::string_view> endings = material_endings();
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string ending = entry.path().extension().string();
    if (std::find(endings.begin(), endings.end(), ending) != endings.end())
      files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw Error("no measured files in this folder", folder,
                "name one with " + joined_words(endings, " or ") + " files");
  return files;
}

// Row 0 of the picture is the zenith; luminance by ITU-R BT.709.
Illumination read_illumination(const std::string& path) {
  const Image image = rgb_of(read_image(path), path);
  LatLong map{image.width, image.height, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float* pixel = image.values.data() + image.index(x, y);
      map.radiance.push_back(0.2126f * pixel[0] + 0.7152f * pixel[1] + 0.0722f * pixel[2]);
    }
  }
  return make_illumination(fs::path(path).stem().string(), std::move(map));
}

}  // namespace

std::vector<std::string> material_names(const Context& context, const CompareOptions& given) {
  if (given.materials.empty()) return default_materials(context, given.quick);
  std::vector<std::string> names;
  for (const std::string& name : given.materials) {
    std::error_code ignored;
    const std::string folder = context.locate(name);
    if (fs::is_directory(folder, ignored)) {
      for (std::string& file : files_of(folder)) names.push_back(std::move(file));
    } else {
      names.push_back(name);
    }
  }
  return names;
}

std::vector<const SamplerInfo*> chosen_samplers(const std::string& list) {
  std::vector<const SamplerInfo*> all;
  std::string names;
  for (const SamplerInfo& info : samplers()) names += (names.empty() ? "" : ", ") + std::string(info.name);
  for (std::size_t from = 0; !list.empty() && from <= list.size();) {
    const std::size_t to = std::min(list.find(',', from), list.size());
    const std::string name = list.substr(from, to - from);
    const SamplerInfo* info = find_sampler(name);
    if (!info) throw Error("no sampler '" + name + "'", "--samplers", "choose of " + names);
    if (std::find(all.begin(), all.end(), info) == all.end()) all.push_back(info);
    from = to + 1;
  }
  if (list.empty()) {
    for (const SamplerInfo& info : samplers()) all.push_back(&info);
  }
  return all;
}

std::vector<Illumination> read_lights(const Context& context, const CompareOptions& given) {
  std::vector<Illumination> lights = procedural_illuminations();
  std::vector<std::string> paths;
  for (const std::string& path : given.envmaps) paths.push_back(context.locate(path));
  const fs::path folder = context.locate("envmaps");
  std::error_code ignored;
  if (paths.empty() && !given.quick && fs::is_directory(folder, ignored)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".hdr") paths.push_back(entry.path().string());
    }
    std::sort(paths.begin(), paths.end());
  }
  for (const std::string& path : paths) lights.push_back(read_illumination(path));
  return lights;
}

}  // namespace reflectree::cli
