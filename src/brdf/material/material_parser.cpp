// SPDX-License-Identifier: Apache-2.0
// Recursive descent over the grammar in material.hpp; every error names its column.
#include <algorithm>
#include <cmath>
#include <optional>

#include "material_words.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree {
namespace {

constexpr std::size_t max_length = 4096, max_terms = 16;
constexpr float max_weight = 1e6f;

bool is_control(char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; }

// For messages: no control characters, not too long.
std::string excerpt(std::string_view text) {
  std::string out(text.substr(0, 40));
  for (char& c : out) c = is_control(c) ? '?' : c;
  return "'" + out + (text.size() > out.size() ? "...'" : "'");
}

class Parser {
 public:
  explicit Parser(std::string_view text, const FileExists& exists)
      : text_(text), rest_(text), exists_(exists) {}

  Material material() {
    Material result;
    do {
      if (result.terms.size() == max_terms) {
        fail("has too many terms", "use at most " + std::to_string(max_terms));
      }
      result.terms.push_back(term());
    } while (take('+'));
    if (!rest_.empty()) fail("unexpected " + found(), "join terms with '+', parameters with ','");
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& how) const {
    fail_at(text_.size() - rest_.size(), what, how);
  }
  [[noreturn]] void fail_at(std::size_t position, const std::string& what, const std::string& how) const {
    throw Error(what, "material " + excerpt(text_) + ", column " + std::to_string(position + 1), how);
  }
  std::size_t position() const { return text_.size() - rest_.size(); }
  std::string found() const { return rest_.empty() ? "end" : excerpt(rest_); }

  void skip_blanks() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t')) rest_.remove_prefix(1);
  }
  bool take(char c) {
    skip_blanks();
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    skip_blanks();
    return true;
  }
  std::string_view word() {
    std::size_t n = 0;
    while (n < rest_.size() && is_word_char(rest_[n])) ++n;
    const std::string_view result = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return result;
  }
  // The text between double quotes; the opening one has been taken.
  std::string quoted() {
    std::string result;
    for (std::size_t i = 0; i < rest_.size(); ++i) {
      if (rest_[i] == '"') {
        rest_.remove_prefix(i + 1);
        return result;
      }
      if (rest_[i] == '\\' && i + 1 < rest_.size()) ++i;
      result += rest_[i];
    }
    fail("has an opening quote without its closing one", "add '\"'");
  }

  MaterialTerm term() {
    skip_blanks();
    MaterialTerm result;
    result.weight = weight().value_or(1.f);
    const std::size_t start = position();
    if (!rest_.empty() && rest_.front() == '"') {
      rest_.remove_prefix(1);
      result.path = quoted();
      if (result.path.empty()) fail_at(start, "an empty path", "name a file");
      member(result);
      return result;
    }
    const std::string_view name = word();
    if (name.empty()) fail("expected a model or a file, found " + found(), "see `list` for the models");
    std::string_view after_number = name;
    if (take_number(after_number) && after_number.empty()) {
      fail_at(start, "a number without a model", "write WEIGHT*MODEL");
    }
    if (const ModelInfo* model = find_model(name); model && (rest_.empty() || rest_.front() != '#')) {
      result.model = model->name;
      parameters(*model, result);
      if (const char* fault = model->fault(result.values)) {
        fail_at(start, "parameters of " + result.model + " do not fit together", fault);
      }
      return result;
    }
    const bool has_mark = name.find_first_of("./") != std::string_view::npos;
    if (has_mark || (!rest_.empty() && rest_.front() == '#') || (exists_ && exists_(std::string(name)))) {
      result.path = name;
      member(result);
      if (take(':')) fail("a file takes no parameters", "put a path that contains ':' in double quotes");
      return result;
    }
    fail_at(start, "unknown model " + excerpt(name),
            "did you mean '" + std::string(nearest_model(name).name) +
                "'? see `list`; a file in this folder is ./FILE");
  }

  // [ number "*" ]; a number that is not followed by "*" may start a path.
  std::optional<float> weight() {
    std::string_view after = rest_;
    const std::optional<float> value = take_number(after);
    if (!value) return std::nullopt;
    while (!after.empty() && (after.front() == ' ' || after.front() == '\t')) after.remove_prefix(1);
    if (after.empty() || after.front() != '*') return std::nullopt;
    if (!(*value > 0 && *value <= max_weight)) {
      fail("weight out of range", "give a weight above 0 and up to " + shortest_text(max_weight));
    }
    rest_ = after.substr(1);
    skip_blanks();
    return value;
  }

  void member(MaterialTerm& result) {
    if (rest_.empty() || rest_.front() != '#') return;
    rest_.remove_prefix(1);
    if (!rest_.empty() && rest_.front() == '"') {
      rest_.remove_prefix(1);
      result.member = quoted();
    } else {
      result.member = word();
    }
    if (result.member.empty()) fail("missing member after '#'", "write PATH#MEMBER");
  }

  void parameters(const ModelInfo& model, MaterialTerm& term) {
    std::vector<Rgb>& values = term.values;
    for (const ParameterInfo& p : model.parameters) values.push_back(p.initial);
    std::vector<bool> given(values.size());
    if (!take(':')) return;
    do {
      skip_blanks();
      const std::size_t start = position();
      const std::string_view name = word();
      const auto [first, count] = find_parameter(model, name);
      if (count == 0) unknown_parameter(model, name, start);
      if (!take('=')) fail("missing value of " + std::string(name), "write " + std::string(name) + "=NUMBER");
      for (std::size_t i = first; i < first + count; ++i) {
        if (given[i]) fail_at(start, "parameter " + excerpt(name) + " is given twice", "give it once");
        given[i] = true;
      }
      const std::size_t number_at = position();
      const Rgb read = value(model.parameters[first], name);
      for (std::size_t i = first; i < first + count; ++i) values[i] = read;
      if (take_dots())
        term.varied.push_back(range(model.parameters[first], name, first, count, read, number_at));
    } while (take(','));
  }

  bool take_dots() {
    skip_blanks();
    if (!rest_.starts_with("..")) return false;
    rest_.remove_prefix(2);
    skip_blanks();
    return true;
  }
  // The rest of name=FROM..TO.
  VariedRange range(const ParameterInfo& p, std::string_view name, std::size_t first, std::size_t count,
                    Rgb from, std::size_t start) {
    const std::string word(name);
    if (p.channels != 1) fail_at(start, word + " is a colour: no range of it can vary", "give it one value");
    const Rgb to = value(p, name);
    if (!(from.r < to.r)) {
      fail_at(start,
              "the range of " + word + " is from " + shortest_text(from.r) + " to " + shortest_text(to.r),
              "give the smaller number first, or one number alone");
    }
    if (++ranges_ > max_parameters) fail_at(start, "has more than two ranges", "give the others one number");
    if (std::find(names_.begin(), names_.end(), word) != names_.end())
      fail_at(start, "two ranges are both named " + word, "give one of them one number");
    names_.push_back(word);
    return {first, count, from.r, to.r};
  }

  // The parameters that `name` sets: one, or the two of a pair, or none.
  struct Range {
    std::size_t first, count;
  };
  static Range find_parameter(const ModelInfo& model, std::string_view name) {
    const auto& all = model.parameters;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].name == name) return {i, 1};
      if (i + 1 < all.size() && is_pair(all[i].name, all[i + 1].name) &&
          all[i].name.substr(0, all[i].name.size() - 2) == name) {
        return {i, 2};
      }
    }
    return {0, 0};
  }
  [[noreturn]] void unknown_parameter(const ModelInfo& model, std::string_view name,
                                      std::size_t start) const {
    std::string names;
    for (const ParameterInfo& p : model.parameters)
      names += (names.empty() ? "" : ", ") + std::string(p.name);
    const std::string what =
        name.empty() ? "expected a parameter, found " + found() : "unknown parameter " + excerpt(name);
    fail_at(start, what, std::string(model.name) + " has " + names);
  }

  Rgb value(const ParameterInfo& p, std::string_view name) {  // of a pair, the name of both
    const std::size_t start = position();
    const float r = number();
    Rgb result{r, r, r};
    if (take('/')) {
      if (p.channels == 1) fail(std::string(name) + " takes one number", "remove the others");
      result.g = number();
      if (!take('/')) fail("expected '/', found " + found(), "give one number, or three: R/G/B");
      result.b = number();
    }
    if (!in_range(p, result)) fail_at(start, std::string(name) + " is out of range", range_text(p, name));
    return result;
  }
  float number() {
    skip_blanks();
    std::string_view before_range = rest_.substr(0, rest_.find(".."));  // 1..2, not 1. and .2
    const std::size_t there = before_range.size();
    const std::optional<float> result = take_number(before_range);
    if (result) rest_.remove_prefix(there - before_range.size());
    if (!result) fail("expected a number, found " + found(), "write it like 0.5 or 1e-3");
    return *result + 0.f;  // -0 becomes 0
  }

  std::string_view text_, rest_;
  const FileExists& exists_;
  std::size_t ranges_ = 0;
  std::vector<std::string> names_;  // of the ranges
};

// The whole text as PATH or PATH#member of an existing file.
std::optional<MaterialTerm> existing_file(const std::string& text, const FileExists& exists) {
  MaterialTerm term;
  if (exists(text)) {
    term.path = text;
    return term;
  }
  const std::size_t hash = text.rfind('#');
  if (hash == std::string::npos || hash == 0 || hash + 1 == text.size()) return std::nullopt;
  term.path = text.substr(0, hash);
  term.member = text.substr(hash + 1);
  return exists(term.path) ? std::optional(term) : std::nullopt;
}

}  // namespace

bool in_range(const ParameterInfo& parameter, Rgb value) {
  const auto inside = [&](float x) { return x >= parameter.lo && x <= parameter.hi; };
  return inside(value.r) && (parameter.channels == 1 || (inside(value.g) && inside(value.b)));
}

std::string range_text(const ParameterInfo& p, std::string_view name) {
  return std::string(name) + " must lie between " + shortest_text(p.lo) + " and " + shortest_text(p.hi) +
         (p.unit.empty() ? "" : " " + std::string(p.unit));
}

Material parse_material(std::string_view text, const FileExists& exists) {
  if (text.size() > max_length) {
    throw Error("is longer than " + std::to_string(max_length) + " bytes", "material " + excerpt(text),
                "shorten it");
  }
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (is_control(text[i])) {
      throw Error("contains a control character",
                  "material " + excerpt(text) + ", column " + std::to_string(i + 1), "remove it");
    }
  }
  if (exists && !text.empty() && !find_model(text)) {
    if (const auto file = existing_file(std::string(text), exists)) return {{*file}};
  }
  return Parser(text, exists).material();
}

}  // namespace reflectree
