// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/material/material.hpp"

#include "material_words.hpp"
#include "reflectree/brdf/material/mixture.hpp"
#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree {
namespace {

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string path_text(std::string_view path) {
  const std::string_view marks = "./";
  std::string_view rest = path;
  const bool plain =
      is_word(path) && path.find_first_of(marks) != std::string_view::npos && !take_number(rest);
  return plain ? std::string(path) : quoted(path);
}

std::string value_text(Rgb value) {
  if (value.r == value.g && value.g == value.b) return shortest_text(value.r);
  return shortest_text(value.r) + "/" + shortest_text(value.g) + "/" + shortest_text(value.b);
}

std::string term_text(const MaterialTerm& term) {
  const std::string text = term.weight == 1 ? "" : shortest_text(term.weight) + "*";
  if (term.model.empty()) return text + file_text(term.path, term.member);
  std::vector<NamedValue> values;
  if (const ModelInfo* model = find_model(term.model)) {
    for (std::size_t i = 0; i < std::min(model->parameters.size(), term.values.size()); ++i)
      values.push_back({model->parameters[i].name, term.values[i], model->parameters[i].quiet});
  }
  return text + model_text(term.model, values);
}

AnyBrdf make_term(const MaterialTerm& term, const FileLoader& load_file) {
  if (term.model.empty()) {
    if (!load_file)
      throw Error("is a file, and files cannot be read here", term.path, "name a model instead");
    return load_file(term.path, term.member);
  }
  const ModelInfo* model = find_model(term.model);
  if (!model) throw Error("is no known model", term.model, "see `list`");
  if (term.values.size() != model->parameters.size()) {
    throw Error("has " + std::to_string(term.values.size()) + " values", term.model,
                "give one for each of its " + std::to_string(model->parameters.size()) + " parameters");
  }
  for (std::size_t i = 0; i < term.values.size(); ++i) {
    const ParameterInfo& p = model->parameters[i];
    if (!in_range(p, term.values[i]))
      throw Error("is out of range", term.model + ":" + std::string(p.name), range_text(p, p.name));
  }
  if (const char* fault = model->fault(term.values))
    throw Error("its parameters do not fit together", term.model, fault);
  return model->make(term.values);
}

}  // namespace

std::string model_text(std::string_view model, std::span<const NamedValue> values) {
  std::string text(model);
  char separator = ':';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i].quiet && values[i].value == Rgb{}) continue;
    std::string_view name = values[i].name;
    const bool pair =
        i + 1 < values.size() && is_pair(name, values[i + 1].name) && values[i].value == values[i + 1].value;
    if (pair) name.remove_suffix(2);
    text += separator + std::string(name) + "=" + value_text(values[i].value);
    separator = ',';
    if (pair) ++i;
  }
  return text;
}

std::string file_text(const std::string& path, const std::string& member) {
  if (member.empty()) return path_text(path);
  return path_text(path) + "#" + (is_word(member) ? member : quoted(member));
}

std::string to_text(const Material& material) {
  std::string text;
  for (const MaterialTerm& term : material.terms) text += (text.empty() ? "" : " + ") + term_text(term);
  return text;
}

AnyBrdf make_brdf(const Material& material, const FileLoader& load_file) {
  std::vector<MixtureTerm> terms;
  for (const MaterialTerm& term : material.terms) terms.push_back({term.weight, make_term(term, load_file)});
  std::string name = to_text(material);
  const bool bare = terms.size() == 1 && terms[0].weight == 1 && terms[0].f.traits().name == name;
  return bare ? terms[0].f : mixture(std::move(terms), std::move(name));
}

}  // namespace reflectree
