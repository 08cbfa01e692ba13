// SPDX-License-Identifier: Apache-2.0
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/brdf/enclosure.hpp"

#include <algorithm>
#include <optional>

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
    for (const VariedRange& v : term.varied) {
      for (std::size_t i = v.first; i < v.first + v.count && i < values.size(); ++i) {
        values[i].value = {v.lo, v.lo, v.lo}, values[i].up_to = v.hi;
        values[i].quiet = false, values[i].joined = v.count > 1;
      }
    }
  }
  return text + model_text(term.model, values);
}

// The model of a term whose values are good.
const ModelInfo& model_of(const MaterialTerm& term) {
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
  // Of families every corner of the ranges must be good.
  for (unsigned corner = 0; corner < 1U << term.varied.size(); ++corner) {
    std::vector<Rgb> values = term.values;
    for (std::size_t k = 0; k < term.varied.size(); ++k) {
      const VariedRange& v = term.varied[k];
      const float value = corner >> k & 1U ? v.hi : v.lo;
      if (v.first + v.count > values.size() || !(v.lo < v.hi))
        throw Error("a range does not fit", term.model, "give the smaller number first");
      for (std::size_t i = v.first; i < v.first + v.count; ++i) {
        values[i] = {value, value, value};
        const ParameterInfo& p = model->parameters[i];
        if (p.channels != 1)
          throw Error(std::string(p.name) + " is a colour, and families vary numbers", term.model,
                      "give it one value");
        if (!in_range(p, values[i]))
          throw Error("is out of range", term.model + ":" + std::string(p.name), range_text(p, p.name));
      }
    }
    if (const char* fault = model->fault(values))
      throw Error("its parameters do not fit together", term.model, fault);
  }
  return *model;
}

AnyBrdf make_term(const MaterialTerm& term, const FileLoader& load_file) {
  if (term.model.empty()) {
    if (!load_file)
      throw Error("is a file, and files cannot be read here", term.path, "name a model instead");
    return load_file(term.path, term.member);
  }
  return model_of(term).make(term.values);
}

// "alpha" of a pair, or the parameter's own name.
std::string name_of(const VariedRange& v, const ModelInfo& model) {
  std::string name(model.parameters[v.first].name);
  if (v.count > 1) name.resize(name.size() - 2);
  return name;
}

std::vector<ParameterRange> ranges_of(const Material& material) {
  std::vector<ParameterRange> ranges;
  for (const MaterialTerm& term : material.terms) {
    if (term.varied.empty()) continue;
    const ModelInfo& model = model_of(term);
    for (const VariedRange& v : term.varied) ranges.push_back({name_of(v, model), v.lo, v.hi});
  }
  check_ranges(ranges, to_text(material));
  return ranges;
}

// A weighted sum of terms that vary and of others.
class SumFamily {
 public:
  // As eval() forms it, term after term.
  class Enclosure;
  struct Term {
    float weight;
    std::optional<AnyFamily> varying;
    std::optional<AnyBrdf> fixed;
    int channels() const { return varying ? varying->channels() : fixed->channels(); }
  };
  explicit SumFamily(std::vector<Term> terms) : terms_(std::move(terms)) {
    for (const Term& term : terms_) channels_ = std::max(channels_, term.channels());
  }

  Spectrum operator()(const ShadingGeometry<float>& g, const Parameters& at) const {
    Spectrum value(channels_);
    eval({&g, 1}, {&at, 1}, {value.data(), std::size_t(channels_)});
    return value;
  }
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<const Parameters> parameters,
            std::span<float> out) const {
    constexpr std::size_t block = 256;
    std::vector<float> values(std::min(block, geometry.size()) * std::size_t(channels_));
    const auto stride = std::size_t(channels_);
    std::fill(out.begin(), out.end(), 0.f);
    for (std::size_t first = 0; first < geometry.size(); first += block) {
      const std::size_t count = std::min(block, geometry.size() - first);
      for (const Term& term : terms_) {
        const auto own = std::size_t(term.channels());
        const std::span<float> some(values.data(), count * own);
        if (term.varying) {
          term.varying->eval(geometry.subspan(first, count), parameters.subspan(first, count), some);
        } else {
          term.fixed->eval(geometry.subspan(first, count), some);
        }
        // Grey: one value for all channels.
        float* sum = out.data() + first * stride;
        for (std::size_t i = 0; i < count * stride; ++i)
          sum[i] += term.weight * some[own == stride ? i : i / stride];
      }
    }
  }
  BrdfTraits traits(const Parameters& at) const {
    std::optional<BrdfTraits> sum;
    for (const Term& term : terms_) {
      BrdfTraits next = term.varying ? term.varying->traits(at) : term.fixed->traits();
      if (term.weight != 1) next.name = shortest_text(term.weight) + "*" + next.name;
      sum = sum ? combined(*sum, next) : next;
    }
    return *sum;
  }
  std::shared_ptr<const FamilyEnclosure> enclosure(const std::vector<ParameterRange>&) const;

 private:
  std::vector<Term> terms_;
  int channels_ = 1;
};

class SumFamily::Enclosure final : public FamilyEnclosure {
 public:
  explicit Enclosure(std::vector<Term> terms) : terms_(std::move(terms)) {}
  RgbT<AffineForm> operator()(const ShadingGeometry<AffineForm>& g, const ParameterForms& at) const override {
    RgbT<AffineForm> sum;
    for (const Term& term : terms_) {
      sum = sum + AffineForm(term.weight) * (term.varying ? (*term.varying->enclosure())(g, at)
                                                          : (*term.fixed->traits().enclosure)(g));
    }
    return sum;
  }
  ExactSymmetry keeps() const override {
    ExactSymmetry all{true, true, true};
    for (const Term& term : terms_) {
      const ExactSymmetry one =
          term.varying ? term.varying->enclosure()->keeps() : symmetry_of(*term.fixed->traits().enclosure);
      all = {all.in_plane_of_wo && one.in_plane_of_wo, all.half_turns && one.half_turns,
             all.mirrored_axes && one.mirrored_axes};
    }
    return all;
  }

 private:
  std::vector<Term> terms_;
};

std::shared_ptr<const FamilyEnclosure> SumFamily::enclosure(const std::vector<ParameterRange>&) const {
  const bool whole = std::all_of(terms_.begin(), terms_.end(), [](const Term& term) {
    return term.varying ? bool(term.varying->enclosure()) : bool(term.fixed->traits().enclosure);
  });
  return whole ? std::make_shared<Enclosure>(terms_) : nullptr;
}

}  // namespace

std::string model_text(std::string_view model, std::span<const NamedValue> values) {
  std::string text(model);
  char separator = ':';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i].quiet && values[i].value == Rgb{}) continue;
    std::string_view name = values[i].name;
    const bool varies = values[i].up_to > values[i].value.r;
    const bool alike = i + 1 < values.size() && values[i].value == values[i + 1].value &&
                       values[i].up_to == values[i + 1].up_to && (!varies || values[i].joined);
    const bool pair = alike && is_pair(name, values[i + 1].name);
    if (pair) name.remove_suffix(2);
    text += separator + std::string(name) + "=" + value_text(values[i].value);
    if (varies) text += ".." + shortest_text(values[i].up_to);
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

bool is_family(const Material& material) {
  return std::any_of(material.terms.begin(), material.terms.end(),
                     [](const MaterialTerm& term) { return !term.varied.empty(); });
}

AnyFamily make_family(const Material& material, const FileLoader& load_file) {
  const std::string name = to_text(material);
  if (!is_family(material))
    throw Error("no parameter has a range", name, "write one as NAME=FROM..TO, such as alpha=0.02..1");
  const std::vector<ParameterRange> ranges = ranges_of(material);
  std::vector<SumFamily::Term> terms;
  std::size_t parameter = 0;
  for (const MaterialTerm& term : material.terms) {
    if (term.varied.empty()) {
      terms.push_back({term.weight, std::nullopt, make_term(term, load_file)});
      continue;
    }
    std::vector<VariedValues> varied;
    for (const VariedRange& v : term.varied) varied.push_back({v.first, v.count, parameter++});
    terms.push_back(
        {term.weight, model_of(term).make_family(term.values, varied, ranges, name), std::nullopt});
  }
  if (terms.size() == 1 && terms[0].weight == 1) return *terms[0].varying;
  return Family<SumFamily>{SumFamily(std::move(terms)), ranges, name};
}

Material member_of(const Material& material, const Parameters& at) {
  const std::vector<ParameterRange> ranges = ranges_of(material);
  Material member = material;
  std::size_t parameter = 0;
  for (MaterialTerm& term : member.terms) {
    for (const VariedRange& v : term.varied) {
      const float value = at[parameter];
      if (!ranges[parameter].contains(value)) {
        throw Error("is out of its range", ranges[parameter].name,
                    "stay between " + shortest_text(v.lo) + " and " + shortest_text(v.hi));
      }
      for (std::size_t i = v.first; i < v.first + v.count; ++i) term.values[i] = {value, value, value};
      ++parameter;
    }
    term.varied.clear();
  }
  return member;
}

AnyBrdf make_brdf(const Material& material, const FileLoader& load_file) {
  if (is_family(material)) {
    throw Error("a parameter has a range, so that the material is a family and not one BRDF",
                to_text(material), "give each parameter one number");
  }
  std::vector<MixtureTerm> terms;
  for (const MaterialTerm& term : material.terms) terms.push_back({term.weight, make_term(term, load_file)});
  std::string name = to_text(material);
  const bool bare = terms.size() == 1 && terms[0].weight == 1 && terms[0].f.traits().name == name;
  return bare ? terms[0].f : mixture(std::move(terms), std::move(name));
}

}  // namespace reflectree
