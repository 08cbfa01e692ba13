// SPDX-License-Identifier: Apache-2.0
#include "material_list.hpp"

#include <algorithm>
#include <filesystem>

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/error.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/rgl_fit.hpp"
#include "without_symmetry.hpp"

namespace reflectree::study {

namespace {

constexpr const char* all_models[] = {
    "lambert:rho=0.5",
    "oren_nayar:rho=0.8,sigma=0.5",
    "phong:kd=0.3,ks=0.5,n=20",
    "phong:kd=0,ks=0.9,n=5000",
    "lafortune:kd=0.1,ks=0.5,cx=-1,cy=-1,cz=1,n=30",
    "lafortune:kd=0.1,ks=0.4,cx=0.6,cy=0.6,cz=0.8,n=20",
    "ward:kd=0.2,ks=0.4,alpha=0.2",
    "ward:kd=0.2/0.1/0.05,ks=0.4,alpha=0.03",
    "ashikhmin_shirley:kd=0.3,f0=0.05,n=10",
    "ashikhmin_shirley:kd=0.3/0.1/0.1,f0=0.1,n=2000",
    "cook_torrance:kd=0.2,ks=0.7,f0=0.6,alpha=0.4",
    "cook_torrance:kd=0.1,ks=0.9,f0=0.8/0.6/0.3,alpha=0.05",
    "ggx:alpha=1",
    "ggx:alpha=0.5",
    "ggx:alpha=0.2,f0=1/0.8/0.3",
    "ggx:alpha=0.1",
    "ggx:alpha=0.05",
    "ggx:alpha=0.01",
    "ggx:alpha=0.002",
    "ggx:alpha=0.001",
    "plastic:alpha=0.3",
    "plastic:alpha=0.1",
    "plastic:kd=0.5/0.1/0.05,alpha=0.02",
    "retro_reflector:alpha=0.3",
    "retro_reflector:alpha=0.05",
    "retro_reflector:alpha=0.005",
    "low_smooth:a=1,b=3,f0=1",
    "low_smooth:a=1,b=300,f0=1",
    "low_smooth:a=10,b=1e5,f0=0.1",
    "0.5*lambert:rho=0.4/0.2/0.1 + 0.3*ggx:alpha=0.08 + 0.2*retro_reflector:alpha=0.1",
    "baked_matt",
    "baked_glossy",
    "baked_retro",
};

constexpr const char* reduced_models[] = {
    "lambert:rho=0.5",
    "oren_nayar:rho=0.8,sigma=0.5",
    "phong:kd=0.3,ks=0.5,n=20",
    "ward:kd=0.2,ks=0.4,alpha=0.2",
    "cook_torrance:kd=0.2,ks=0.7,f0=0.6,alpha=0.4",
    "ggx:alpha=0.1",
    "ggx:alpha=0.01",
    "plastic:alpha=0.1",
    "retro_reflector:alpha=0.05",
    "low_smooth:a=1,b=300,f0=1",
    "baked_matt",
    "baked_retro",
};

constexpr const char* networks[] = {
    "alum-bronze", "aluminium",   "blue-acrylic",           "chrome",      "dark-red-paint", "green-fabric",
    "nickel",      "pearl-paint", "specular-blue-phenolic", "white-marble"};
constexpr const char* fits[] = {
    "alum-bronze", "beige-fabric",          "black-oxidized-steel", "blue-rubber",          "brass",
    "chrome",      "color-changing-paint1", "fruitwood-241",        "gold-metallic-paint2", "green-plastic"};

}  // namespace

const char* name_of(Group group) {
  constexpr const char* names[] = {"model", "rgl", "network", "fit", "baked rgl", "zemax", "klems"};
  return names[int(group)];
}

std::vector<StudyMaterial> study_materials(const std::string& data_folder, bool reduced) {
  std::vector<StudyMaterial> list;
  if (reduced) {
    for (const char* text : reduced_models) list.push_back({text, Group::model, text, "", ""});
    return list;
  }
  for (const char* text : all_models) list.push_back({text, Group::model, text, "", ""});
  if (data_folder.empty()) return list;
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder + "/rgl")) {
    if (entry.path().extension() == ".bsdf") files.push_back(entry.path().stem().string());
  }
  std::sort(files.begin(), files.end());
  for (const std::string& f : files) list.push_back({f, Group::rgl, "", "rgl/" + f + ".bsdf", ""});
  for (const std::string m : networks) {
    list.push_back({"nbrdf " + m, Group::network, "", "nbrdf/nbrdf_merl.csv", m});
  }
  for (const std::string m : fits) list.push_back({"sgd " + m, Group::fit, "", "fits/sgd_merl100.csv", m});
  return list;
}

namespace {

constexpr const char* anisotropic_models[] = {
    "ggx:alpha_x=0.05,alpha_y=0.3",
    "ggx:alpha_x=0.02,alpha_y=0.6",
    "ward:alpha_x=0.1,alpha_y=0.4",
    "cook_torrance:kd=0,ks=1,alpha_x=0.1,alpha_y=0.3",
    "ashikhmin_shirley:n_x=10,n_y=1000",
    // A woven cloth: warp and weft.
    "0.2*lambert:rho=0.4/0.1/0.1 + 0.5*ggx:alpha_x=0.1,alpha_y=0.4,phi_deg=20 + "
    "0.3*ggx:alpha_x=0.1,alpha_y=0.4,phi_deg=110",
    "0.5*plastic:alpha=0.2 + 0.5*ggx:alpha_x=0.1,alpha_y=0.4",
    no_symmetry,
};
constexpr const char* baked_models[] = {"ggx:alpha_x=0.05,alpha_y=0.3", "ward:alpha_x=0.1,alpha_y=0.4",
                                        no_symmetry};

AnyBrdf brdf_of(const std::string& text) {
  if (text == no_symmetry) return AnyBrdf(without_symmetry);
  return make_brdf(parse_material(text));
}

std::vector<std::string> files_in(const std::string& folder, const char* extension) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == extension) files.push_back(entry.path().stem().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::vector<StudyMaterial> anisotropic_materials(const std::string& data_folder) {
  std::vector<StudyMaterial> list;
  for (const char* text : anisotropic_models) list.push_back({text, Group::model, text, "", ""});
  for (const std::string text : baked_models)
    list.push_back({"RGL of " + text, Group::baked_rgl, text, "", ""});
  if (data_folder.empty()) return list;
  for (const std::string& f : files_in(data_folder + "/zemax", ".bsdf")) {
    const std::string file = "zemax/" + f + ".bsdf";
    try {
      if (!load_brdf(data_folder + "/" + file).traits().isotropic)
        list.push_back({f, Group::zemax, "", file, ""});
    } catch (const Error&) {  // transmission
    }
  }
  for (const std::string& f : files_in(data_folder + "/radiance_xml", ".xml")) {
    const std::string file = "radiance_xml/" + f + ".xml";
    try {
      for (const std::string& m : list_members(data_folder + "/" + file)) {
        if (m == "front" || m == "back") list.push_back({f + " " + m, Group::klems, "", file, m});
      }
    } catch (const Error&) {  // tensor trees
    }
  }
  return list;
}

AnyBrdf load(const StudyMaterial& material, const std::string& data_folder) {
  if (material.group == Group::baked_rgl)
    return read_brdf(write_rgl(fit_rgl(brdf_of(material.text)), material.name), material.name + ".bsdf");
  if (!material.text.empty()) return brdf_of(material.text);
  return load_brdf(data_folder + "/" + material.file, material.member);
}

}  // namespace reflectree::study
