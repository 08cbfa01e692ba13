// SPDX-License-Identifier: Apache-2.0
// As much of XML as BSDF files need, and no more: elements, attributes (read over), text, comments, CDATA.
// Bounded in elements and in depth; nothing is expanded, and a document type, where entities would be
// defined, is an error. Everything points into the bytes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "reflectree/formats/bytes.hpp"

namespace reflectree {

struct XmlElement {
  std::string_view name;
  // What is written in it, without blanks at its ends: the first piece if there are more.
  std::string_view text;
  bool in_pieces = false;             // elements or comments stand between pieces of text
  std::size_t line = 0;               // of its opening tag, from 1
  std::vector<std::size_t> children;  // indices of elements, in order
};

class XmlTree {
 public:
  // What precedes the first '<' is skipped: tools leave a line of their own there. Throws Error with the line.
  XmlTree(ByteView bytes, const std::string& where);

  const XmlElement& root() const { return elements_.front(); }
  const XmlElement& operator[](std::size_t i) const { return elements_[i]; }

  // The children of that name.
  std::vector<const XmlElement*> all(const XmlElement& of, std::string_view name) const;
  // The only one; nullptr where there is none, an error where there are more.
  const XmlElement* find(const XmlElement& of, std::string_view name) const;
  // The same, and an error where there is none.
  const XmlElement& need(const XmlElement& of, std::string_view name) const;

  // Throws Error, naming the element's line.
  [[noreturn]] void fail(const XmlElement& at, const std::string& what) const;

 private:
  std::vector<XmlElement> elements_;
  std::string where_;
};

}  // namespace reflectree
