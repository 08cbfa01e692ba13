// SPDX-License-Identifier: Apache-2.0
// The words of Mitsuba's XML: properties with $names, numbers, transforms, colours. Errors name line and
// column. A property of another kind than is asked for is an error, never the default. What is wrong is
// noted, so that all of a scene's errors are told in one.
#pragma once

#include <initializer_list>
#include <pugixml.hpp>
#include <set>

#include "reflectree/error.hpp"
#include "scene_colour.hpp"
#include "scene_text.hpp"
#include "transform.hpp"

namespace reflectree::render {

// Of a place or a transform: Embree takes no ray from farther than 1.8e18, and floats hold no larger areas.
inline constexpr double largest_coordinate = 1e15;
inline bool within_reach(Vec3<double> p) {
  return std::abs(p.x) <= largest_coordinate && std::abs(p.y) <= largest_coordinate &&
         std::abs(p.z) <= largest_coordinate;
}

using Node = pugi::xml_node;
using Names = std::initializer_list<std::string_view>;

// What is wrong with an element.
struct Problem {
  std::string what, place, how;
};
class ElementError : public Error {
 public:
  explicit ElementError(Problem p) : Error(p.what, p.place, p.how), problem(std::move(p)) {}
  Problem problem;
};

class XmlReader {
 public:
  XmlReader(std::string_view xml, const std::string& path, const SceneOptions& options);

  Node root() const { return root_; }
  const SceneOptions& options() const { return options_; }
  // A file that the scene names; its contents belong to the scene's identity.
  std::string beside(const std::string& file) const;
  // The one that `n` names as "filename".
  std::string file(Node n) const;
  // What `read` returns; an error is noted and `otherwise` stands in for it: nothing is rendered then.
  template <class Read, class T>
  T attempt(const Read& read, T otherwise) const {
    try {
      return read();
    } catch (const ElementError& e) {
      note(e.problem);
      return otherwise;
    }
  }
  bool sound() const { return problems_.empty(); }
  // Throws what was noted, in one Error.
  void throw_problems() const;
  // A word that is understood, and changes no pixel of ours.
  void idle(Node n) const;
  // A sentence about all of those, or "".
  std::string idle_words() const;

  // What `read` returns; its errors get the element's place.
  template <class Read>
  auto placed(Node n, const Read& read) const {
    try {
      return read();
    } catch (const ElementError&) {
      throw;
    } catch (const Error& e) {
      rethrow(n, e);
    }
  }
  std::uint64_t fingerprint() const;

  [[noreturn]] void fail(Node n, const std::string& what, const std::string& how) const;
  [[noreturn]] void unknown(Node n) const;
  // Everything inside `n` must be one of these, by name or, where it has none, by tag.
  void only(Node n, Names known) const;
  // The element itself or what a <ref> names.
  Node resolve(Node n) const;

  static std::string type(Node n) { return n.attribute("type").value(); }
  static Node named(Node n, const char* name) { return n.find_child_by_attribute("name", name); }
  static std::string text(Node n, const char* attribute) { return n.attribute(attribute).value(); }
  // The only child of this tag, or none.
  Node child(Node n, const char* tag) const;
  // The same, where a <ref> may stand in its place.
  Node part(Node n, const char* tag) const;
  // Throws where a <ref> in `n` leads to anything else.
  void refer_to(Node n, Names tags) const;
  std::vector<double> numbers(Node n, const std::string& words) const;
  double number(Node n, const char* attribute, double otherwise) const;
  Vec3<double> triple(Node n, const char* attribute) const;
  // Properties of `n`, by name.
  double property(Node n, const char* name, double otherwise) const;
  int integer(Node n, const char* name, int otherwise) const;
  bool flag(Node n, const char* name, bool otherwise) const;
  std::string word(Node n, const char* name, const std::string& otherwise) const;
  Vec3<double> point(Node n, const char* name, Vec3<double> otherwise) const;
  Rgb colour(Node n, const char* name, Rgb otherwise, ColourOf of) const;
  Matrix transform(Node n) const;
  // Where the property's transform turns the axes to. Throws Error where it scales them.
  LocalFrame<float> rotation(Node n, const char* name) const;

 private:
  std::string place(Node n) const { return text_.place(n.offset_debug()); }
  void note(const Problem& problem) const;
  void note(Node n, const std::string& what, const std::string& how) const { note({what, place(n), how}); }
  void find_defaults(Node n, int depth);
  void upgrade(Node n);
  [[noreturn]] void rethrow(Node n, const Error& e) const;
  void replace_names(Node n, int depth);
  void check(Node n) const;  // attributes, names and ids of all that is in it
  void check_attributes(Node n) const;
  void need(Node property, Names tags, const std::string& what) const;
  SampledSpectrum sampled(Node n) const;
  Matrix operation(Node op) const;
  std::uint64_t hash(Node n, std::uint64_t h) const;

  const SceneOptions& options_;
  SceneText text_;
  Defines defines_;
  std::set<std::string> used_;               // names of `defines_`
  mutable std::map<std::string, Node> ids_;  // elements by their id
  pugi::xml_document document_;
  Node root_;
  mutable std::vector<std::string> files_;
  mutable std::vector<Problem> problems_;
  mutable std::vector<std::pair<std::string, std::string>> idle_;  // words and places
};

}  // namespace reflectree::render
