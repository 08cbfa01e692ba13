// SPDX-License-Identifier: Apache-2.0
// Includes are put together as text, so that one document is read in the end and every element keeps its
// place. As in Mitsuba, an included <scene> gives its contents, anything else itself; <path> counts for what
// comes later, and where it stands in an included file for that file's own includes alone.
#include "scene_text.hpp"

#include <algorithm>
#include <filesystem>
#include <pugixml.hpp>

#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"

namespace reflectree::render {

namespace {

constexpr int deepest = 15;  // Mitsuba's limit of includes in includes
constexpr std::size_t largest = std::size_t(1) << 26U;

// Behind the element's start tag, which begins at `offset`; quotes may hold a '>'.
std::size_t end_of_tag(std::string_view text, std::size_t offset) {
  char quote = 0;
  for (std::size_t i = offset; i < text.size(); ++i) {
    const char c = text[i];
    if (quote) {
      quote = c == quote ? '\0' : quote;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return i + 1;
    }
  }
  return text.size();
}

// Behind an element without children.
std::size_t end_of(std::string_view text, pugi::xml_node n) {
  const std::size_t tag = end_of_tag(text, std::size_t(n.offset_debug()));
  if (tag >= 2 && text[tag - 2] == '/') return tag;
  const std::size_t closing = text.find('>', std::min(text.find("</", tag), text.size()));
  return closing == std::string_view::npos ? text.size() : closing + 1;
}

bool exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

std::string joined(const std::string& folder, const std::string& file) {
  return (std::filesystem::path(folder) / file).string();
}
std::string folder_of(const std::string& path) { return std::filesystem::path(path).parent_path().string(); }

}  // namespace

std::string SceneText::find(const Folders& folders, const std::string& file) {
  if (std::filesystem::path(file).is_absolute()) return file;
  for (const std::string& folder : folders) {
    if (exists(joined(folder, file))) return joined(folder, file);
  }
  return exists(file) ? file : joined(folders.back(), file);
}

std::string SceneText::place_in(const File& file, std::size_t offset) {
  const std::string_view before = std::string_view(file.text).substr(0, offset);
  const std::size_t newline = before.rfind('\n');
  return file.path + ":" + std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ":" +
         std::to_string(before.size() - (newline == std::string_view::npos ? 0 : newline + 1));
}

const SceneText::Piece& SceneText::piece_of(std::ptrdiff_t offset) const {
  const auto at = std::size_t(std::max<std::ptrdiff_t>(offset, 0));
  return *(std::upper_bound(pieces_.begin(), pieces_.end(), at,
                            [](std::size_t o, const Piece& p) { return o < p.begin; }) -
           1);
}

std::string SceneText::place(std::ptrdiff_t offset) const {
  const Piece& p = piece_of(offset);
  return place_in(files_[p.file], std::size_t(std::max<std::ptrdiff_t>(offset, 0)) - p.begin + p.offset);
}

bool SceneText::is_old(std::ptrdiff_t offset) const { return files_[piece_of(offset).file].old; }

void SceneText::put(std::size_t file, std::size_t begin, std::size_t end) {
  pieces_.push_back({text_.size(), file, begin});
  text_.append(files_[file].text, begin, end - begin);
  if (text_.size() > largest)
    throw Error("more than 64 MiB with its includes", files_.front().path, "break the circle of includes");
}

SceneText::SceneText(std::string_view xml, const std::string& path, const Defines& defines)
    : folders_{folder_of(path)}, defines_(defines) {
  expand(std::string(xml), path, "", folders_, 0);
}

// Elements of one file, in the file's order: what is defined, where files are, and what is put in place of an
// element, from `begin` to `end` of its text.
struct SceneText::Walk {
  SceneText& all;
  std::size_t file;
  Folders& folders;
  int depth;
  std::size_t done = 0;  // of the file's text

  [[noreturn]] void fail(pugi::xml_node n, const std::string& what, const std::string& how) const {
    throw Error(what, place_in(all.files_[file], std::size_t(n.offset_debug())), how);
  }
  std::string attribute(pugi::xml_node n, const char* name) const {
    std::string value = n.attribute(name).value();
    if (value.empty())
      fail(n, "<" + std::string(n.name()) + "> without '" + name + "'",
           "add " + std::string(name) + "=\"...\"");
    const std::string missing = replace_names(value, all.defines_, [](const std::string&) {});
    if (!missing.empty()) fail(n, "nothing defines $" + missing, "give -D " + missing + "=VALUE");
    return value;
  }
  void leave_out(pugi::xml_node n) {
    if (n.first_child()) fail(n, "something inside <" + std::string(n.name()) + ">", "close it before");
    all.put(file, done, std::size_t(n.offset_debug()) - 1);
    done = end_of(all.files_[file].text, n);
  }
  void visit(pugi::xml_node n, int nested) {
    if (nested > 64) fail(n, "elements are nested deeper than 64", "close those that have ended");
    const std::string_view tag = n.name();
    if (tag == "default") {
      std::string value = n.attribute("value").value();
      replace_names(value, all.defines_, [](const std::string&) {});
      all.defines_.try_emplace(n.attribute("name").value(), value);
    } else if (tag == "path" && nested == 1) {
      const std::string named = attribute(n, "value"),
                        beside = joined(folder_of(all.files_[file].path), named),
                        found = exists(beside) ? beside : find(folders, named);
      if (!exists(found)) fail(n, "no folder '" + named + "'", "check its name");
      folders.insert(folders.begin(), found);
      leave_out(n);
    } else if (tag == "include") {
      const std::string named = attribute(n, "filename");
      if (depth == deepest) fail(n, "includes nested deeper than 15", "break the circle of includes");
      Folders inside = folders;
      inside.insert(inside.begin(), folder_of(all.files_[file].path));
      const std::string path = find(inside, named);
      if (!exists(path)) fail(n, "no file '" + named + "' to include", "check its name");
      leave_out(n);
      const Bytes bytes = read_file(path, largest);
      all.expand(std::string(bytes.begin(), bytes.end()), path, n.attribute("name").value(), inside,
                 depth + 1);
    } else {
      for (const pugi::xml_node c : n.children()) {
        if (c.type() == pugi::node_element) visit(c, nested + 1);
      }
    }
  }
};

// Appends a file; `name` is given to what it holds, if that is no scene.
void SceneText::expand(std::string xml, const std::string& path, const std::string& name, Folders& folders,
                       int depth) {
  if (xml.rfind("\xef\xbb\xbf", 0) == 0) xml.erase(0, 3);  // pugixml leaves the mark out, too
  files_.push_back({path, std::move(xml), false});
  const std::size_t file = files_.size() - 1;
  const std::string text = files_[file].text;  // files_ grows
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw Error(parsed.description(),
                place_in(files_[file], std::size_t(std::max<std::ptrdiff_t>(parsed.offset, 0))),
                "mend the XML");
  const pugi::xml_node root = document.document_element();
  const bool is_scene = root.name() == std::string_view("scene");
  if (!root || (depth == 0 && !is_scene)) throw Error("no <scene>", path, "name a Mitsuba 3 scene");
  const pugi::xml_attribute version = root.attribute("version");
  files_[file].old = version && version.as_int(3) < 2;

  Walk walk{*this, file, folders, depth};
  std::size_t end = text.size();
  if (depth > 0) {
    const auto start = std::size_t(root.offset_debug());
    const std::size_t body = end_of_tag(text, start);
    if (is_scene) {
      walk.done = body, end = std::max(body, std::min(text.rfind("</"), text.size()));
      if (text[body - 2] == '/') return;
    } else {  // <bsdf version="3.0.0" ...>, without the version, with the name
      const std::size_t after = start + std::string_view(root.name()).size();
      put(file, start - 1, after);
      if (!name.empty()) text_ += " name=\"" + name + "\"";
      pieces_.push_back({text_.size(), file, after});
      std::string tag = text.substr(after, body - after);
      const auto blank = [&](std::string_view word) {
        for (std::size_t at = tag.find(word); at != std::string::npos; at = tag.find(word, at + 1)) {
          const std::size_t equals = tag.find_first_not_of(" \t\r\n", at + word.size());
          if (equals == std::string::npos || tag[equals] != '=' ||
              !std::isspace(static_cast<unsigned char>(tag[at - 1])))
            continue;
          const std::size_t open = tag.find_first_of("\"'", equals);
          const std::size_t close = open == std::string::npos ? open : tag.find(tag[open], open + 1);
          if (close == std::string::npos) return;
          std::fill(tag.begin() + std::ptrdiff_t(at), tag.begin() + std::ptrdiff_t(close) + 1, ' ');
          return;
        }
      };
      blank("version");
      if (!name.empty()) blank("name");
      text_ += tag;
      walk.done = body;
      const std::size_t closing = text.rfind('>');
      end = std::max(body, closing == std::string::npos ? body : closing + 1);
    }
  }
  walk.visit(root, 0);
  put(file, walk.done, end);
}

}  // namespace reflectree::render
