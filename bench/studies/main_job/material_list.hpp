// SPDX-License-Identifier: Apache-2.0
// The materials of the study of the main job.
#pragma once

#include <string>
#include <vector>

#include "reflectree/brdf/any_brdf.hpp"

namespace reflectree::study {

// Analytic or baked; measured; NBRDF; SGD. Of anisotropic materials: RGL files baked from others, Zemax files,
// Klems matrices.
enum class Group { model, rgl, network, fit, baked_rgl, zemax, klems };
const char* name_of(Group group);

struct StudyMaterial {
  std::string name;  // as in the tables; no folder
  Group group = Group::model;
  std::string text;    // of the material grammar, or no_symmetry; or
  std::string file;    // a file below the data folder, and
  std::string member;  // its member
};

// Every model of the registry at several sharpnesses, and the baked tables; with a data folder also all RGL
// materials, ten networks and ten SGD fits. reduced: a dozen of the models alone.
std::vector<StudyMaterial> study_materials(const std::string& data_folder, bool reduced);

// Anisotropic models, RGL files baked from three of them, and with a data folder all Zemax files with several
// rotations and all blocks of reflection of Klems's matrices.
std::vector<StudyMaterial> anisotropic_materials(const std::string& data_folder);
inline constexpr const char* no_symmetry = "without any symmetry";

AnyBrdf load(const StudyMaterial& material, const std::string& data_folder);

}  // namespace reflectree::study
