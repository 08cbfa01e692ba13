// SPDX-License-Identifier: Apache-2.0
#include "klems.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "reflectree/brdf/material/material.hpp"
#include "reflectree/brdf/tables/klems_table.hpp"
#include "reflectree/error.hpp"
#include "reflectree/text/number_text.hpp"
#include "xml_tree.hpp"

namespace reflectree {
namespace {

constexpr std::size_t looked_at = std::size_t(64) << 10U, max_rings = 64, max_patches = 1024;
constexpr double degree = pi_v<double> / 180;
constexpr float largest = 1e9f;

// As the file defines it: degrees, and patches of each ring.
struct Rings {
  std::string name;
  std::vector<double> theta;
  std::vector<int> patches;

  int size() const {
    int sum = 0;
    for (const int n : patches) sum += n;
    return sum;
  }
};

// For files that name a basis without defining it. Two of them were once cut otherwise:
// the number of patches tells.
const std::vector<Rings>& known_bases() {
  static const std::vector<Rings> all = {
      {"LBNL/Klems Full", {0, 5, 15, 25, 35, 45, 55, 65, 75, 90}, {1, 8, 16, 20, 24, 24, 24, 16, 12}},
      {"LBNL/Klems Half", {0, 6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90}, {1, 8, 12, 16, 20, 12, 8}},
      {"LBNL/Klems Half", {0, 6.5, 19.5, 32.5, 46.5, 61.5, 76.5, 90}, {1, 8, 12, 16, 20, 12, 4}},
      {"LBNL/Klems Quarter", {0, 9, 27, 45, 63, 90}, {1, 8, 12, 12, 8}},
  };
  return all;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? char(c + ('a' - 'A')) : c;
  return out;
}

// "CIE-X" -> "cie-x", "0.55 micron" -> "0.55-micron": a word that needs no quotes.
std::string as_word(std::string_view text) {
  std::string out;
  for (const char c : lower(text)) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '-';
    if (plain) {
      out += c;
    } else if (!out.empty() && out.back() != '-') {
      out += '-';
    }
  }
  return out.empty() ? "unnamed" : out;
}

// One reflection of the file.
struct Block {
  std::string member, wavelength;
  bool front = false;
  const XmlElement* element = nullptr;
};

class WindowFile {
 public:
  WindowFile(ByteView bytes, const std::string& path) : tree_(bytes, path), path_(path) {
    if (tree_.root().name != "WindowElement") tree_.fail(tree_.root(), "not a <WindowElement>");
    layer_ = &tree_.need(tree_.need(tree_.root(), "Optical"), "Layer");
    const XmlElement& definition = tree_.need(*layer_, "DataDefinition");
    const XmlElement& structure = tree_.need(definition, "IncidentDataStructure");
    const std::string order = lower(structure.text);
    if (order.rfind("tensortree", 0) == 0) {
      throw Error("a tensor tree: only Klems matrices are read", path_, "name a file of matrices");
    }
    rows_ = order == "rows";
    if (!rows_ && order != "columns") tree_.fail(structure, "neither Columns nor Rows");
    for (const XmlElement* basis : tree_.all(definition, "AngleBasis")) read_basis(*basis);
    list_blocks();
  }

  WindowFile(const WindowFile&) = delete;  // points into itself
  WindowFile& operator=(const WindowFile&) = delete;

  const std::vector<Block>& blocks() const { return blocks_; }
  const Block& block(const std::string& member) const;
  KlemsTable table(const Block& block, std::uint64_t& negative) const;

 private:
  double number(const XmlElement& e) const {
    const std::optional<double> value = parse_number(e.text);
    if (!value) tree_.fail(e, "<" + std::string(e.name) + "> is not a finite number");
    return *value;
  }
  void read_basis(const XmlElement& element);
  void list_blocks();
  const Rings& basis(const XmlElement& block, const char* which, std::size_t entries, int other) const;
  std::vector<float> numbers(const XmlElement& data, std::uint64_t& negative) const;

  XmlTree tree_;
  std::string path_;
  const XmlElement* layer_ = nullptr;
  bool rows_ = false;
  std::vector<Rings> bases_;
  std::vector<Block> blocks_;
};

void WindowFile::read_basis(const XmlElement& element) {
  Rings rings;
  rings.name = tree_.need(element, "AngleBasisName").text;
  for (const XmlElement* ring : tree_.all(element, "AngleBasisBlock")) {
    const XmlElement& bounds = tree_.need(*ring, "ThetaBounds");
    const XmlElement &lower_bound = tree_.need(bounds, "LowerTheta"),
                     &upper = tree_.need(bounds, "UpperTheta");
    const double from = number(lower_bound), to = number(upper);
    if (rings.theta.empty()) rings.theta.push_back(0);
    if (std::abs(from - rings.theta.back()) > 1e-4) {
      tree_.fail(lower_bound, "a ring that does not begin where the last one ends");
    }
    if (!(to > from && to <= 90 + 1e-4))
      tree_.fail(upper, "a ring that does not end above its beginning, by 90");
    const XmlElement& phis = tree_.need(*ring, "nPhis");
    const double count = number(phis);
    if (!(count >= 1 && count <= double(max_patches)) || count != std::floor(count))
      tree_.fail(phis, "not a count of patches");
    rings.theta.push_back(std::min(to, 90.0));
    rings.patches.push_back(int(count));
    if (rings.patches.size() > max_rings) tree_.fail(*ring, "more rings than are read");
  }
  if (rings.patches.empty()) tree_.fail(element, "a basis without rings");
  if (rings.size() > int(max_patches)) tree_.fail(element, "more patches than are read");
  bases_.push_back(std::move(rings));
}

void WindowFile::list_blocks() {
  for (const XmlElement* data : tree_.all(*layer_, "WavelengthData")) {
    const std::string wavelength(tree_.need(*data, "Wavelength").text);
    for (const XmlElement* block : tree_.all(*data, "WavelengthDataBlock")) {
      const std::string direction = lower(tree_.need(*block, "WavelengthDataDirection").text);
      if (direction != "reflection front" && direction != "reflection back") continue;
      blocks_.push_back({"", wavelength, direction == "reflection front", block});
    }
  }
  if (blocks_.empty()) {
    throw Error("no reflection in the file", path_, "name a file with a block Reflection Front or Back");
  }
  const auto is_visible = [](const Block& b) { return lower(b.wavelength) == "visible"; };
  const auto visible = std::find_if(blocks_.begin(), blocks_.end(), is_visible);
  const std::string first = (visible == blocks_.end() ? blocks_.front() : *visible).wavelength;
  std::stable_sort(blocks_.begin(), blocks_.end(), [&](const Block& a, const Block& b) {
    const bool a_first = a.wavelength == first, b_first = b.wavelength == first;
    if (a_first != b_first) return a_first;
    return a.wavelength == b.wavelength && a.front && !b.front;
  });
  for (Block& block : blocks_) {
    block.member = std::string(block.wavelength == first ? "" : as_word(block.wavelength) + "-") +
                   (block.front ? "front" : "back");
    for (const Block& other : blocks_) {
      if (&other != &block && other.member == block.member) {
        tree_.fail(*block.element, "a second block that is called " + block.member);
      }
    }
  }
}

const Block& WindowFile::block(const std::string& member) const {
  if (member.empty()) return blocks_.front();
  std::string names;
  for (const Block& block : blocks_) {
    if (block.member == member) return block;
    names += (names.empty() ? "#" : ", #") + block.member;
  }
  throw Error("no member '" + member + "'", path_, "its members: " + names);
}

const Rings& WindowFile::basis(const XmlElement& block, const char* which, std::size_t entries,
                               int other) const {
  const XmlElement& name = tree_.need(block, which);
  for (const Rings& rings : bases_) {
    if (lower(rings.name) == lower(name.text)) return rings;
  }
  const Rings* named = nullptr;
  for (const Rings& rings : known_bases()) {
    if (lower(rings.name) != lower(name.text)) continue;
    const auto size = std::size_t(rings.size());
    if (!named || size * (other > 0 ? std::size_t(other) : size) == entries) named = &rings;
  }
  if (!named) tree_.fail(name, "the basis is neither defined in the file nor known");
  return *named;
}

// Apart by blanks, or by a comma among them.
std::vector<float> WindowFile::numbers(const XmlElement& data, std::uint64_t& negative) const {
  if (data.in_pieces) tree_.fail(data, "<ScatteringData> in pieces");
  constexpr std::string_view blanks = " \t\r\n";
  std::vector<float> values;
  std::string_view rest = data.text;
  while (!rest.empty()) {
    const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n,"));
    const std::optional<double> value = parse_number(word);
    if (!value || !(std::abs(*value) <= double(largest))) {
      const auto line = data.line + std::size_t(std::count(data.text.data(), rest.data(), '\n'));
      throw Error("line " + std::to_string(line) + " or after: '" + std::string(word.substr(0, 30)) +
                      "' is not a plausible number",
                  path_, "mend the line or fetch the file again");
    }
    if (*value < 0) ++negative;
    values.push_back(std::max(float(*value), 0.f));
    rest.remove_prefix(word.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
    if (!rest.empty() && rest[0] == ',') rest.remove_prefix(1);
    rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
  }
  return values;
}

KlemsTable WindowFile::table(const Block& block, std::uint64_t& negative) const {
  const XmlElement& data = tree_.need(*block.element, "ScatteringData");
  const std::vector<float> values = numbers(data, negative);
  const Rings& columns = basis(*block.element, "ColumnAngleBasis", values.size(), 0);
  const Rings& rows = basis(*block.element, "RowAngleBasis", values.size(), columns.size());
  const auto n_columns = std::size_t(columns.size()), n_rows = std::size_t(rows.size());
  if (values.size() != n_columns * n_rows) {
    tree_.fail(data, std::to_string(values.size()) + " numbers for " + std::to_string(n_rows) + " x " +
                         std::to_string(n_columns) + " patches");
  }
  const auto as_basis = [](const Rings& rings) {
    std::vector<double> theta;
    for (const double t : rings.theta) theta.push_back(t * degree);
    return KlemsBasis(theta, rings.patches);
  };
  KlemsTable table;
  table.name = file_text(path_, "");
  table.seen_through = block.front;
  table.incident = as_basis(rows_ ? rows : columns), table.exiting = as_basis(rows_ ? columns : rows);
  if (rows_) {
    table.values = values;
    return table;
  }
  table.values.reserve(values.size());
  for (std::size_t in = 0; in < n_columns; ++in) {
    for (std::size_t out = 0; out < n_rows; ++out) table.values.push_back(values[out * n_columns + in]);
  }
  return table;
}

// The largest share of the light of one incident patch that leaves again.
double largest_albedo(const KlemsTable& table) {
  double largest_sum = 0;
  for (int in = 0; in < table.incident.size(); ++in) {
    double sum = 0;
    for (int out = 0; out < table.exiting.size(); ++out) {
      sum += table.exiting.projected_solid_angle(out) * double(table.value(in, out));
    }
    largest_sum = std::max(largest_sum, sum);
  }
  return largest_sum;
}

}  // namespace

bool is_window_xml(ByteView bytes) {
  const std::string_view start(reinterpret_cast<const char*>(bytes.data()),
                               std::min(bytes.size(), looked_at));
  return start.find("<WindowElement") != start.npos;
}

std::vector<std::string> klems_members(ByteView bytes, const std::string& path) {
  std::vector<std::string> names;
  const WindowFile file(bytes, path);
  for (const Block& block : file.blocks()) names.push_back(block.member);
  return names;
}

AnyBrdf read_klems(ByteView bytes, const std::string& path, const std::string& member) {
  const WindowFile file(bytes, path);
  std::uint64_t negative = 0;
  KlemsTable table = file.table(file.block(member), negative);
  table.name = file_text(path, member);
  return table;
}

MeasuredFacts klems_facts(ByteView bytes, const std::string& path, const std::string& member) {
  const WindowFile file(bytes, path);
  const Block& block = file.block(member);
  MeasuredFacts facts;
  const KlemsTable table = file.table(block, facts.negative);
  facts.kind = "Klems matrix of " + std::to_string(table.incident.size()) + " incident and " +
               std::to_string(table.exiting.size()) + " exiting patches, " + block.wavelength +
               ", reflection " + (block.front ? "front" : "back");
  facts.entries = table.values.size();
  facts.channels = 1;
  facts.notes.push_back("wo is the file's incident direction; f is constant over pairs of patches");
  if (block.front)
    facts.notes.push_back("front is WINDOW's, which Radiance calls back: x points the other way");
  char text[64];
  std::snprintf(text, sizeof text, "reflects at most %.4g of the light of a patch", largest_albedo(table));
  facts.notes.push_back(text);
  for (const KlemsBasis* basis : {&table.incident, &table.exiting}) {
    if (basis->ring_borders().back() < 1.5707f)
      facts.notes.push_back("f is 0 beyond the last ring of patches");
  }
  return facts;
}

}  // namespace reflectree
