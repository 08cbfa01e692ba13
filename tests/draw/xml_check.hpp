// SPDX-License-Identifier: Apache-2.0
// A judge of well-formed XML that shares nothing with the writer: tags nest, attributes are quoted and
// differ, references are known, text is clean. Returns what is wrong, or nothing.
#pragma once

#include <cctype>
#include <set>
#include <string>
#include <string_view>
#include <vector>

inline std::string text_fault(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c < 0x20 && c != '\n' && c != '\t' && c != '\r') return "control character";
    if (c == '<') return "bare <";
    if (c != '&') continue;
    const std::size_t end = text.find(';', i);
    const std::string_view name = end == text.npos ? "" : text.substr(i + 1, end - i - 1);
    const std::set<std::string_view> known{"amp", "lt", "gt", "quot", "apos", "#39"};
    if (!known.contains(name)) return "unknown reference after &";
  }
  return "";
}

inline std::string xml_fault(std::string_view xml) {
  std::vector<std::string> open;
  bool seen_root = false;
  const auto is_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == ':' || c == '_';
  };
  std::size_t i = xml.starts_with("<!DOCTYPE html>\n") ? 16 : 0;
  while (i < xml.size()) {
    const std::size_t tag = xml.find('<', i);
    const std::string_view text = xml.substr(i, tag == xml.npos ? xml.npos : tag - i);
    if (const std::string fault = text_fault(text); !fault.empty()) return fault;
    if (open.empty() && text.find_first_not_of(" \n\t\r") != text.npos) return "text outside the root";
    if (tag == xml.npos) break;
    i = tag + 1;
    const bool closing = i < xml.size() && xml[i] == '/';
    i += closing ? 1 : 0;
    const std::size_t name_from = i;
    while (i < xml.size() && is_name(xml[i])) ++i;
    const std::string name(xml.substr(name_from, i - name_from));
    if (name.empty()) return "a tag without a name";
    if (closing) {
      if (open.empty() || open.back() != name) return "</" + name + "> closes nothing";
      if (i >= xml.size() || xml[i] != '>') return "a closing tag with more than a name";
      open.pop_back();
      ++i;
      continue;
    }
    if (open.empty() && seen_root) return "two roots";
    seen_root = true;
    std::set<std::string> attributes;
    for (;;) {
      while (i < xml.size() && std::isspace(static_cast<unsigned char>(xml[i]))) ++i;
      if (i >= xml.size()) return "an unfinished tag";
      if (xml[i] == '>') {
        open.push_back(name);
        ++i;
        break;
      }
      if (xml.substr(i, 2) == "/>") {
        i += 2;
        break;
      }
      const std::size_t key_from = i;
      while (i < xml.size() && is_name(xml[i])) ++i;
      const std::string key(xml.substr(key_from, i - key_from));
      if (key.empty() || !attributes.insert(key).second)
        return "a nameless or repeated attribute in <" + name;
      if (xml.substr(i, 2) != "=\"") return "an unquoted attribute " + key;
      const std::size_t end = xml.find('"', i + 2);
      if (end == xml.npos) return "an unfinished attribute " + key;
      if (const std::string fault = text_fault(xml.substr(i + 2, end - i - 2)); !fault.empty()) return fault;
      i = end + 1;
    }
  }
  if (!open.empty()) return "<" + open.back() + "> is never closed";
  return seen_root ? "" : "nothing there";
}
