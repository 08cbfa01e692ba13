// SPDX-License-Identifier: Apache-2.0
// The facts of a sampler as lines and as a JSON object, with the words of `reflectree info`.
#include <algorithm>
#include <variant>
#include <vector>

#include "handles.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree::c {

namespace {

using Fact = std::variant<std::string, double, std::uint64_t, bool, std::vector<std::string>>;

// Whether all of it is UTF-8, by the lengths of its characters.
bool is_utf8(const std::string& text) {
  int more = 0;
  for (const char c : text) {
    const auto byte = std::uint8_t(c);
    if (more > 0 ? (byte & 0xc0U) != 0x80U : (byte & 0xc0U) == 0x80U || byte >= 0xf8U) return false;
    more = more > 0 ? more - 1 : byte >= 0xf0U ? 3 : byte >= 0xe0U ? 2 : byte >= 0xc0U ? 1 : 0;
  }
  return more == 0;
}

// A name may be any bytes: what is no UTF-8 shows as '?'.
std::string readable(std::string text) {
  if (is_utf8(text)) return text;
  for (char& c : text) {
    if (std::uint8_t(c) >= 0x80) c = '?';
  }
  return text;
}

std::string quoted(const std::string& text) {
  constexpr const char* hex = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = std::uint8_t(c);
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7f) {
      out += std::string("\\u00") + hex[byte >> 4U] + hex[byte & 15U];
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string joined(const std::vector<std::string>& items, const char* between, bool json) {
  std::string out;
  for (const std::string& item : items) out += (out.empty() ? "" : between) + (json ? quoted(item) : item);
  return out;
}

std::string text_of(const Fact& fact, bool json) {
  if (const auto* words = std::get_if<std::string>(&fact)) return json ? quoted(*words) : *words;
  if (const auto* number = std::get_if<double>(&fact)) return shortest_text(float(*number));
  if (const auto* count = std::get_if<std::uint64_t>(&fact)) return std::to_string(*count);
  if (const auto* truth = std::get_if<bool>(&fact))
    return json ? (*truth ? "true" : "false") : (*truth ? "yes" : "no");
  const auto& list = std::get<std::vector<std::string>>(fact);
  return json ? "[" + joined(list, ", ", true) + "]" : list.empty() ? "none" : joined(list, "; ", false);
}

template <class Trees>
std::uint64_t leaves_of(const Trees& trees) {
  std::uint64_t leaves = 0;
  for (const CanonicalTree& tree : trees) leaves += tree.mass.size();
  return leaves;
}

std::string target_text(const Target& target) {
  constexpr const char* names[] = {"norm", "luminance", "maximum", "channel"};
  std::string text = names[std::size_t(target.kind)];
  if (target.kind == TargetKind::channel) text += ":" + std::to_string(target.index);
  return text;
}

}  // namespace

void describe(reflectree_sampler& s) {
  const SamplerData& d = s.data;
  const auto [low, high] = std::minmax_element(d.albedo.albedo.begin(), d.albedo.albedo.end());
  const std::vector<std::pair<const char*, Fact>> facts{
      {"material", readable(d.material)},
      {"channels", std::uint64_t(s.sampler.exact.brdf().channels())},
      {"target", target_text(d.target)},
      {"domain", std::string(name_of(d.domain.kind))},
      {"half_square", d.domain.half()},
      {"symmetry", std::string(name_of(d.frame.symmetry))},
      {"exact_slabs", std::uint64_t(d.exact.size())},
      {"exact_leaves", leaves_of(d.exact)},
      {"one_shot_slabs", std::uint64_t(d.one_shot.size())},
      {"one_shot_leaves", leaves_of(d.one_shot)},
      {"bytes_in_memory", std::uint64_t(bytes_of(s.sampler.exact.packed()))},
      {"albedo_minimum", double(*low / d.target.scale)},
      {"albedo_maximum", double(*high / d.target.scale)},
      {"albedo_relative_error", double(d.albedo.relative_error)},
      {"expected_trials", double(d.report.expected_trials)},
      {"overshoot_mass", double(d.report.overshoot_mass)},
      {"one_shot_variance", double(d.report.one_shot_variance)},
      {"asymmetry", double(d.report.asymmetry)},
      {"evaluations", d.report.evaluations},
      {"notes", d.report.notes}};
  for (const auto& [name, fact] : facts) {
    s.info_text +=
        std::string(name) + std::string(24 - std::string(name).size(), ' ') + text_of(fact, false) + "\n";
    s.info_json += (s.info_json.empty() ? "{" : ", ") + quoted(name) + ": " + text_of(fact, true);
  }
  s.info_json += "}";
}

}  // namespace reflectree::c

namespace {
bool is_sampler(const reflectree_sampler* s) { return s && s->kind == reflectree_sampler::own_kind; }
}  // namespace

extern "C" {
const char* reflectree_info_text(const reflectree_sampler* s) {
  return is_sampler(s) ? s->info_text.c_str() : nullptr;
}
const char* reflectree_info_json(const reflectree_sampler* s) {
  return is_sampler(s) ? s->info_json.c_str() : nullptr;
}
}
