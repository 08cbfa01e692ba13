// SPDX-License-Identifier: Apache-2.0
#include "xml_tree.hpp"

#include <algorithm>

#include "reflectree/error.hpp"

namespace reflectree {
namespace {

constexpr std::size_t max_elements = 20000, max_depth = 32, max_name = 100;
constexpr std::string_view blanks = " \t\r\n";

[[noreturn]] void fail_at(std::size_t line, const std::string& what, const std::string& where) {
  throw Error("line " + std::to_string(line) + ": " + what, where, "mend the line or fetch the file again");
}

std::string quoted(std::string_view word) { return "'" + std::string(word.substr(0, 30)) + "'"; }

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& where) : text_(text), where_(where) {}

  std::vector<XmlElement> read() {
    skip(std::min(text_.find('<'), text_.size()));
    while (!text_.empty()) {
      if (text_[0] != '<') {
        take_text(text_.substr(0, text_.find('<')));
      } else if (text_.rfind("<!--", 0) == 0) {
        take_until("-->", "a comment");
      } else if (text_.rfind("<![CDATA[", 0) == 0) {
        skip(9);
        take_text(text_.substr(0, text_.find("]]>")));
        take_until("]]>", "CDATA");
      } else if (text_.rfind("<?", 0) == 0) {
        take_until("?>", "an instruction");
      } else if (text_.rfind("<!", 0) == 0) {
        fail("a document type or another declaration: not read");
      } else if (text_.rfind("</", 0) == 0) {
        close();
      } else {
        open();
      }
    }
    if (!open_.empty()) fail("the file ends inside " + quoted(elements_[open_.back()].name));
    if (elements_.empty()) fail("no element");
    return std::move(elements_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { fail_at(line_, what, where_); }

  void skip(std::size_t count) {
    line_ += std::size_t(std::count(text_.begin(), text_.begin() + std::ptrdiff_t(count), '\n'));
    text_.remove_prefix(count);
  }
  void take_until(std::string_view end, const char* what) {
    const std::size_t at = text_.find(end);
    if (at == text_.npos) fail(std::string("the file ends inside ") + what);
    skip(at + end.size());
  }
  void take_blanks() { skip(std::min(text_.find_first_not_of(blanks), text_.size())); }
  std::string_view take_name() {
    const auto belongs = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
             c == '-' || c == '.' || c == ':';
    };
    std::size_t n = 0;
    while (n < text_.size() && belongs(text_[n])) ++n;
    if (n == 0 || n > max_name) fail("no name where one should stand");
    const std::string_view name = text_.substr(0, n);
    skip(n);
    return name;
  }

  void take_text(std::string_view piece) {
    const std::string_view said = trimmed(piece);
    if (!said.empty()) {
      if (open_.empty()) fail("text outside of the only element");
      XmlElement& element = elements_[open_.back()];
      if (element.text.empty()) {
        element.text = said;
      } else {
        element.in_pieces = true;
      }
    }
    skip(piece.size());
  }

  void open() {
    const std::size_t line = line_;
    skip(1);
    if (elements_.size() >= max_elements) fail("more elements than are read");
    if (open_.size() >= max_depth) fail("elements nested too deeply");
    if (open_.empty() && !elements_.empty()) fail("a second element beside the first");
    XmlElement element;
    element.name = take_name(), element.line = line;
    for (;;) {
      take_blanks();
      if (text_.empty()) fail("the file ends inside a tag");
      if (text_[0] == '>' || text_[0] == '/') break;
      take_name();
      take_blanks();
      if (text_.rfind("=", 0) != 0) fail("an attribute without a value");
      skip(1);
      take_blanks();
      if (text_.empty() || (text_[0] != '"' && text_[0] != '\'')) fail("a value that is not quoted");
      const std::string_view quote = text_.substr(0, 1);
      skip(1);
      take_until(quote, "a value");
    }
    const bool empty = text_[0] == '/';
    if (empty) skip(1);
    if (text_.rfind(">", 0) != 0) fail("a tag that does not end");
    skip(1);
    const std::size_t index = elements_.size();
    if (!open_.empty()) elements_[open_.back()].children.push_back(index);
    elements_.push_back(std::move(element));
    if (!empty) open_.push_back(index);
  }

  void close() {
    skip(2);
    const std::string_view name = take_name();
    if (open_.empty() || elements_[open_.back()].name != name) {
      fail("</" + std::string(name) + "> closes " +
           (open_.empty() ? std::string("nothing") : quoted(elements_[open_.back()].name)));
    }
    take_blanks();
    if (text_.rfind(">", 0) != 0) fail("a tag that does not end");
    skip(1);
    open_.pop_back();
  }

  std::string_view text_;  // what is left
  std::size_t line_ = 1;
  std::vector<XmlElement> elements_;
  std::vector<std::size_t> open_;
  const std::string& where_;
};

}  // namespace

XmlTree::XmlTree(ByteView bytes, const std::string& where)
    : elements_(Parser({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, where).read()),
      where_(where) {}

std::vector<const XmlElement*> XmlTree::all(const XmlElement& of, std::string_view name) const {
  std::vector<const XmlElement*> found;
  for (const std::size_t i : of.children) {
    if (elements_[i].name == name) found.push_back(&elements_[i]);
  }
  return found;
}

const XmlElement* XmlTree::find(const XmlElement& of, std::string_view name) const {
  const auto found = all(of, name);
  if (found.size() > 1) fail(*found[1], "a second <" + std::string(name) + ">");
  return found.empty() ? nullptr : found[0];
}

const XmlElement& XmlTree::need(const XmlElement& of, std::string_view name) const {
  if (const XmlElement* found = find(of, name)) return *found;
  fail(of, "<" + std::string(of.name) + "> without <" + std::string(name) + ">");
}

void XmlTree::fail(const XmlElement& at, const std::string& what) const { fail_at(at.line, what, where_); }

}  // namespace reflectree
