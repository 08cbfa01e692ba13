// SPDX-License-Identifier: Apache-2.0
#include "eval_pairs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <iterator>
#include <optional>

#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/file_kind.hpp"
#include "reflectree/text/number_text.hpp"

namespace reflectree::cli {

namespace {

constexpr std::uint64_t max_table_bytes = std::uint64_t(1) << 30U;
constexpr double degree = pi_v<double> / 180;
constexpr double slack = 1e-3, exact_enough = 1e-6;  // of a vector's length

// A piece of text and where it stands, as an error names it.
struct Field {
  std::string_view text;
  std::string where;
};

[[noreturn]] void fail(const std::string& what, const std::string& where, const std::string& how) {
  throw Error(what, where, how);
}

double number(const Field& field) {
  std::string_view rest = field.text;
  const auto read = take_number(rest);
  if (!read || !rest.empty() || !std::isfinite(*read)) {
    fail(fmt::format("'{}' is no number", field.text.substr(0, 30)), field.where,
         "write it like 0.5 or 1e-3");
  }
  return std::strtod(std::string(field.text).c_str(), nullptr);  // a float is not enough for angles
}

// `where` is that of the vector's first component, `where_z` that of its last.
Direction direction(const std::string& name, Vec3<double> w, const std::string& where,
                    const std::string& where_z) {
  const double size = length(w);
  if (!(std::abs(size - 1) <= slack)) {
    fail(fmt::format("{} is {:.6g} long", name, size), where, "give a unit vector, right to 0.001");
  }
  if (std::abs(size - 1) > exact_enough) w = normalize(w);
  const Direction rounded{float(w.x), float(w.y), float(w.z)};
  if (!(rounded.z > 0)) {
    fail(fmt::format("{} is not above the surface: its z is {:.6g}", name, w.z), where_z,
         "give directions with z above 0; z is the normal");
  }
  return rounded;
}

Direction from_angles(const std::string& name, double theta_deg, double phi_deg, const std::string& where) {
  if (!(theta_deg >= 0 && theta_deg < 90)) {
    fail(fmt::format("{} of {:g} degrees is not above the surface", name, theta_deg), where,
         "give degrees from 0 to below 90");
  }
  const Vec3<double> w = direction_from_angles(theta_deg * degree, phi_deg * degree);
  return {float(w.x), float(w.y), float(w.z)};
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

// What stands between commas; place(column) names each.
template <class Place>
std::vector<Field> split(std::string_view line, const Place& place) {
  std::vector<Field> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    const std::string_view text = trimmed(line.substr(begin, end - begin));
    const std::size_t column = text.empty() ? begin : std::size_t(text.data() - line.data());
    fields.push_back({text, place(fields.size(), column + 1)});
    begin = end + 1;
  }
  return fields;
}

// --- arguments ---

std::vector<Direction> vectors(const std::string& option, const std::vector<std::string>& texts) {
  std::vector<Direction> result;
  for (const std::string& text : texts) {
    const auto here = [&](std::size_t, std::size_t column) {
      return texts.size() == 1
                 ? fmt::format("{} {}, column {}", option, text, column)
                 : fmt::format("{} {} (number {}), column {}", option, text, result.size() + 1, column);
    };
    const std::vector<Field> f = split(text, here);
    if (f.size() != 3) {
      fail(fmt::format("{} numbers in place of 3", f.size()), f[0].where, "write X,Y,Z");
    }
    result.push_back(
        direction(option.substr(2), {number(f[0]), number(f[1]), number(f[2])}, f[0].where, f[2].where));
  }
  return result;
}

struct Angle {
  double deg;
  std::string where;
};
std::vector<Angle> angles(const std::string& option, const std::string& text) {
  std::vector<Angle> result;
  const auto here = [&](std::size_t, std::size_t column) {
    return fmt::format("{} {}, column {}", option, text, column);
  };
  for (const Field& field : split(text, here)) result.push_back({number(field), field.where});
  return result;
}

// The common length of lists, each of which may have one entry for all.
std::size_t common_length(std::initializer_list<std::size_t> sizes, const std::string& where) {
  const std::size_t longest = std::max(sizes);
  for (const std::size_t size : sizes) {
    if (size != longest && size != 1) {
      fail(fmt::format("lists of {} and {} entries", size, longest), where,
           "give as many of each, or a single one of some");
    }
  }
  return longest;
}

template <class T>
const T& at(const std::vector<T>& list, std::size_t i) {
  return list[list.size() == 1 ? 0 : i];
}

DirectionPairs from_vectors(const PairWords& words) {
  if (words.wo.empty() || words.wi.empty()) {
    fail(words.wo.empty() ? "missing" : "alone", "--wo", "give both --wo X,Y,Z and --wi X,Y,Z");
  }
  const std::vector<Direction> wo = vectors("--wo", words.wo), wi = vectors("--wi", words.wi);
  DirectionPairs pairs;
  for (std::size_t i = 0, n = common_length({wo.size(), wi.size()}, "--wo and --wi"); i < n; ++i) {
    pairs.wo.push_back(at(wo, i)), pairs.wi.push_back(at(wi, i));
  }
  return pairs;
}

DirectionPairs from_angle_lists(const PairWords& words) {
  const std::string all = "--theta-o-deg, --theta-i-deg, --phi-deg";
  if (words.theta_o_deg.empty() || words.theta_i_deg.empty() || words.phi_deg.empty()) {
    fail("one of the three is missing", all, "give all three");
  }
  const std::vector<Angle> o = angles("--theta-o-deg", words.theta_o_deg),
                           i = angles("--theta-i-deg", words.theta_i_deg),
                           p = angles("--phi-deg", words.phi_deg);
  DirectionPairs pairs;
  for (std::size_t k = 0, n = common_length({o.size(), i.size(), p.size()}, all); k < n; ++k) {
    pairs.wo.push_back(from_angles("theta_o", at(o, k).deg, 0, at(o, k).where));
    pairs.wi.push_back(from_angles("theta_i", at(i, k).deg, at(p, k).deg, at(i, k).where));
  }
  return pairs;
}

// --- tables ---

constexpr std::array<std::string_view, 6> vector_columns{"wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"};
constexpr std::array<std::string_view, 3> angle_columns{"theta_o_deg", "theta_i_deg", "phi_deg"};

// Where a line's numbers stand; `width` fields per line.
struct Layout {
  std::vector<std::size_t> columns;
  std::size_t width = 0;
};

template <std::size_t N>
std::optional<Layout> find_columns(const std::vector<Field>& head,
                                   const std::array<std::string_view, N>& names) {
  Layout layout{{}, head.size()};
  for (const std::string_view name : names) {
    const auto is_it = [&](const Field& f) { return f.text == name; };
    const auto found = std::find_if(head.begin(), head.end(), is_it);
    if (found == head.end()) return std::nullopt;
    const auto again = std::find_if(found + 1, head.end(), is_it);
    if (again != head.end())
      fail(fmt::format("column '{}' stands twice", name), again->where, "keep one of them");
    layout.columns.push_back(std::size_t(found - head.begin()));
  }
  return layout;
}

Layout layout_of(const std::vector<Field>& head) {
  if (const auto layout = find_columns(head, vector_columns)) return *layout;
  if (const auto layout = find_columns(head, angle_columns)) return *layout;
  fail("a header without the columns of a pair", head[0].where,
       "name wo_x,wo_y,wo_z,wi_x,wi_y,wi_z or theta_o_deg,theta_i_deg,phi_deg");
}

bool is_number(std::string_view text) { return take_number(text) && text.empty(); }

std::string read_text(const std::string& table) {
  Bytes bytes;
  if (table == "-") {
    bytes.assign(std::istreambuf_iterator<char>(std::cin), {});
  } else {
    bytes = read_file(table, max_table_bytes);
  }
  refuse_recognised(bytes, table == "-" ? "stdin" : table, "name a CSV file of pairs");
  return {bytes.begin(), bytes.end()};
}

DirectionPairs from_table(const std::string& table) {
  const std::string name = table == "-" ? "stdin" : table, text = read_text(table);
  std::string_view rest = text;
  if (rest.rfind("\xef\xbb\xbf", 0) == 0) rest.remove_prefix(3);
  std::optional<Layout> layout;
  DirectionPairs pairs;
  for (std::size_t line_number = 1; !rest.empty(); ++line_number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (trimmed(line).empty()) continue;
    const auto here = [&](std::size_t, std::size_t column) {
      return fmt::format("{}:{}:{}", name, line_number, column);
    };
    const std::vector<Field> fields = split(line, here);
    if (!layout && !is_number(fields[0].text) &&
        std::none_of(fields.begin(), fields.end(), [](const Field& f) { return is_number(f.text); })) {
      layout = layout_of(fields);
      continue;
    }
    if (!layout) layout = Layout{{0, 1, 2, 3, 4, 5}, 6};
    if (fields.size() != layout->width) {
      fail(fmt::format("{} numbers in place of {}", fields.size(), layout->width), fields[0].where,
           "mend the line; a pair is wo_x,wo_y,wo_z,wi_x,wi_y,wi_z unless a header says otherwise");
    }
    const auto field = [&](std::size_t i) -> const Field& { return fields[layout->columns[i]]; };
    if (layout->columns.size() == 3) {
      pairs.wo.push_back(from_angles("theta_o", number(field(0)), 0, field(0).where));
      pairs.wi.push_back(from_angles("theta_i", number(field(1)), number(field(2)), field(1).where));
      continue;
    }
    const auto vector = [&](const char* which, std::size_t first) {
      return direction(which, {number(field(first)), number(field(first + 1)), number(field(first + 2))},
                       field(first).where, field(first + 2).where);
    };
    pairs.wo.push_back(vector("wo", 0)), pairs.wi.push_back(vector("wi", 3));
  }
  if (pairs.wo.empty()) fail("no pairs", name, "give a line for each pair");
  return pairs;
}

}  // namespace

DirectionPairs read_pairs(const PairWords& words) {
  const bool vectors = !words.wo.empty() || !words.wi.empty();
  const bool angles = !words.theta_o_deg.empty() || !words.theta_i_deg.empty() || !words.phi_deg.empty();
  const int ways = int(vectors) + int(angles) + int(!words.table.empty());
  if (ways != 1) {
    fail(ways == 0 ? "no pairs of directions" : "pairs given in two ways", "reflectree eval",
         "give --wo and --wi, or --theta-o-deg, --theta-i-deg and --phi-deg, or --pairs FILE");
  }
  if (vectors) return from_vectors(words);
  return angles ? from_angle_lists(words) : from_table(words.table);
}

}  // namespace reflectree::cli
