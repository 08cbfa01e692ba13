// SPDX-License-Identifier: Apache-2.0
// A page as blocks, written as Markdown or as one offline HTML file.
#pragma once

#include <string>
#include <vector>

#include "reflectree/draw/figure.hpp"

namespace reflectree::pictures {

struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};
struct Picture {
  std::string words, file;  // beside the page
};

struct Block {
  enum class Kind { section, part, words, command, table, pictures, figure } kind;
  std::string text;  // `code` between backquotes, else plain
  Table table;
  std::vector<Picture> pictures;
  draw::Figure figure;  // in HTML alone
};

struct Page {
  std::string title, lead, made;
  std::vector<Block> blocks;
  void section(const std::string& text) { blocks.push_back({Block::Kind::section, text, {}, {}, {}}); }
  void part(const std::string& text) { blocks.push_back({Block::Kind::part, text, {}, {}, {}}); }
  void words(const std::string& text) { blocks.push_back({Block::Kind::words, text, {}, {}, {}}); }
  void command(const std::string& text) { blocks.push_back({Block::Kind::command, text, {}, {}, {}}); }
  void table(Table t) { blocks.push_back({Block::Kind::table, {}, std::move(t), {}, {}}); }
  void pictures(std::vector<Picture> p) {
    blocks.push_back({Block::Kind::pictures, {}, {}, std::move(p), {}});
  }
  void figure(draw::Figure f) { blocks.push_back({Block::Kind::figure, {}, {}, {}, std::move(f)}); }
};

std::string markdown(const Page& page);
// Pictures that are not in the folder are left out.
std::string html(const Page& page, const std::string& folder);

}  // namespace reflectree::pictures
