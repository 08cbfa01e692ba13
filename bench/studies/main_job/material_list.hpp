// SPDX-License-Identifier: Apache-2.0
// The materials of the study of the main job.
#pragma once

#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"

namespace reflectree::study {

enum class Group { model, rgl, network, fit };  // analytic or baked; measured; NBRDF; SGD
const char* name_of(Group group);

struct StudyMaterial {
  std::string name;  // as in the tables; no folder
  Group group = Group::model;
  std::string text;    // of the material grammar; or
  std::string file;    // a file below the data folder, and
  std::string member;  // its member
};

// Every model of the registry at several sharpnesses, and the baked tables; with a data folder also all RGL
// materials, ten networks and ten SGD fits. reduced: a dozen of the models alone.
std::vector<StudyMaterial> study_materials(const std::string& data_folder, bool reduced);

AnyBrdf load(const StudyMaterial& material, const std::string& data_folder);

}  // namespace reflectree::study
