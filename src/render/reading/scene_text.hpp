// SPDX-License-Identifier: Apache-2.0
// A scene's text with its <include>s put in, what each part of it came from, and where the scene's files
// are looked for.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace reflectree::render {

using Defines = std::map<std::string, std::string>;

// Replaces every $name by what it stands for, the longest name that fits, and \$ by $. Returns a name that
// nothing defines, or "". `use(name)` is called for each.
template <class Use>
std::string replace_names(std::string& text, const Defines& defines, const Use& use) {
  for (std::size_t at = text.find('$'); at != std::string::npos; at = text.find('$', at)) {
    if (at > 0 && text[at - 1] == '\\') {
      text.erase(at - 1, 1);
      continue;
    }
    std::size_t end = at + 1;
    while (end < text.size() && (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_'))
      ++end;
    const std::string whole = text.substr(at + 1, end - at - 1);
    auto known = defines.end();
    for (std::size_t n = whole.size(); n > 0 && known == defines.end(); --n)
      known = defines.find(whole.substr(0, n));
    if (known == defines.end()) return whole;
    use(known->first);
    text.replace(at, known->first.size() + 1, known->second);
    at += known->second.size();
  }
  return "";
}

class SceneText {
 public:
  // Throws Error with the place, in whichever file it is.
  SceneText(std::string_view xml, const std::string& path, const Defines& defines);

  const std::string& text() const { return text_; }
  // "file:line:column" of a place in text(); `column_of_name` of "<name".
  std::string place(std::ptrdiff_t offset) const;
  // Whether the place is in a file that says that it is of Mitsuba before 2.0.
  bool is_old(std::ptrdiff_t offset) const;
  // A relative path where it is found first: in folders named by <path>, the last of them first, beside the
  // scene, in the working directory. Beside the scene where it is nowhere.
  std::string find(const std::string& file) const { return find(folders_, file); }

 private:
  struct File {
    std::string path, text;
    bool old = false;
  };
  struct Piece {
    std::size_t begin;  // in text()
    std::size_t file, offset;
  };
  using Folders = std::vector<std::string>;  // first come, first looked into
  struct Walk;
  static std::string find(const Folders& folders, const std::string& file);
  static std::string place_in(const File& file, std::size_t offset);
  void put(std::size_t file, std::size_t begin, std::size_t end);
  void expand(std::string xml, const std::string& path, const std::string& name, Folders& folders, int depth);
  const Piece& piece_of(std::ptrdiff_t offset) const;

  std::string text_;
  std::vector<File> files_;
  std::vector<Piece> pieces_;
  Folders folders_;
  Defines defines_;
};

}  // namespace reflectree::render
