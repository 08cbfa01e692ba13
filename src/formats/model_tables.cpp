// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/model_tables.hpp"

#include <cmath>
#include <limits>

#include "reflectree/error.hpp"

namespace reflectree {
namespace {

// The names of a network's weights in the order in which NeuralBrdf takes them.
std::vector<std::string> weight_names() {
  constexpr std::size_t sizes[] = {NeuralBrdf::inputs, NeuralBrdf::hidden, NeuralBrdf::hidden,
                                   NeuralBrdf::outputs};
  std::vector<std::string> names;
  for (std::size_t layer = 1; layer <= 3; ++layer) {
    const std::string l = std::to_string(layer) + "_";
    for (std::size_t i = 0; i < sizes[layer - 1]; ++i) {
      for (std::size_t j = 0; j < sizes[layer]; ++j) {
        names.push_back("w" + l + std::to_string(i) + "_" + std::to_string(j));
      }
    }
    for (std::size_t j = 0; j < sizes[layer]; ++j) names.push_back("b" + l + std::to_string(j));
  }
  return names;
}

// Reads a row's values by name and checks their range.
struct Values {
  const ParameterTable& table;
  const ParameterTable::Row& row;

  double get(const std::string& name) const {
    const int column = table.column(name);
    if (column < 0) {
      throw Error("no column '" + name + "'", table.where, "fetch the file again");
    }
    return row.values[std::size_t(column)];
  }
  [[noreturn]] void out_of_range(const std::string& name) const {
    throw Error("'" + name + "' of '" + row.material + "' is out of range", table.where,
                "mend the line or fetch the file again");
  }
  // A value in [lo, hi], as a float.
  float in(const std::string& name, double lo, double hi) const {
    const double v = get(name);
    if (!(v >= lo && v <= hi)) out_of_range(name);
    return float(v);
  }
  // A value that no float need hold.
  double at_least(const std::string& name, double lo) const {
    const double v = get(name);
    if (!(v >= lo)) out_of_range(name);
    return v;
  }
  Rgb rgb(const std::string& name, double lo, double hi) const {
    return {in(name + "_r", lo, hi), in(name + "_g", lo, hi), in(name + "_b", lo, hi)};
  }
};

constexpr double largest = 1e9;  // of parameters without a natural bound: products stay finite floats

}  // namespace

TableModel model_of(const ParameterTable& table) {
  const auto has = [&](const char* name) { return table.column(name) >= 0; };
  if (has("w1_0_0") && has("b3_2")) return TableModel::neural;
  if (has("kap_r") && has("theta0_r")) return TableModel::sgd;
  if (has("A_r") && has("B") && has("C") && has("ior")) return TableModel::abc;
  throw Error("its columns fit no model that is read", table.where,
              "name a table of NBRDF, SGD or ABC materials");
}

NeuralBrdf make_neural(const ParameterTable& table, const ParameterTable::Row& row, const std::string& name) {
  const Values values{table, row};
  std::vector<float> weights;
  for (const std::string& weight : weight_names()) weights.push_back(values.in(weight, -1e6, 1e6));
  return {name, std::span<const float, NeuralBrdf::weight_count>(weights.data(), weights.size())};
}

Sgd make_sgd(const ParameterTable& table, const ParameterTable::Row& row, const std::string& name) {
  const Values values{table, row};
  Sgd model;
  model.name = name;
  const char* suffix[] = {"_r", "_g", "_b"};
  for (int i = 0; i < 3; ++i) {
    const std::string s = suffix[i];
    SgdChannel& c = model.channels[i];
    c.kd = values.in("kd" + s, 0, largest);
    c.ks = values.in("ks" + s, 0, largest);
    c.alpha = values.in("alpha" + s, 1e-6, 1e3);
    c.p = values.in("p" + s, 0, 100);
    c.kappa = values.in("kap" + s, 0, largest);
    c.f0 = values.in("F0" + s, -largest, largest);
    c.f1 = values.in("F1" + s, -largest, largest);
    c.lambda = values.in("lambda" + s, 0, largest);
    // Up to 1e92: kept as a logarithm.
    const double scale = values.at_least("c" + s, 0);
    c.log_c = scale > 0 ? float(std::log(scale)) : -std::numeric_limits<float>::max();
    c.k = values.in("k" + s, 0, 1e4);
    c.theta_0 = values.in("theta0" + s, -10, 10);
  }
  return model;
}

AbcMicrofacet make_abc(const ParameterTable& table, const ParameterTable::Row& row, const std::string& name) {
  const Values values{table, row};
  AbcMicrofacet model;
  model.name = name;
  model.kd = values.rgb("kd", 0, largest);
  model.a = values.rgb("A", 0, largest);
  model.b = values.in("B", 0, largest);
  model.c = values.in("C", 0, 100);
  model.ior = values.in("ior", 1, 1e3);
  return model;
}

}  // namespace reflectree
