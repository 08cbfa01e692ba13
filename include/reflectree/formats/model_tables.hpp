// SPDX-License-Identifier: Apache-2.0
// Which model a table's columns describe, and the model of one of its rows.
#pragma once

#include "reflectree/brdf/models/abc.hpp"
#include "reflectree/brdf/models/neural_brdf.hpp"
#include "reflectree/brdf/models/sgd.hpp"
#include "reflectree/formats/parameter_table.hpp"

namespace reflectree {

// Columns of each, in any order, X standing for r, g, b; further columns are ignored:
//   neural  w1_I_J b1_J w2_I_J b2_J w3_I_J b3_J         (6 -> 21 -> 21 -> 3)
//   sgd     kd_X ks_X alpha_X p_X F0_X F1_X kap_X lambda_X c_X k_X theta0_X
//   abc     kd_X A_X B C ior
enum class TableModel { neural, sgd, abc };

// Throws Error where the columns fit none.
TableModel model_of(const ParameterTable& table);

// `name` becomes the model's name. Throws Error for parameters outside the model's domain.
NeuralBrdf make_neural(const ParameterTable& table, const ParameterTable::Row& row, const std::string& name);
Sgd make_sgd(const ParameterTable& table, const ParameterTable::Row& row, const std::string& name);
AbcMicrofacet make_abc(const ParameterTable& table, const ParameterTable::Row& row, const std::string& name);

}  // namespace reflectree
