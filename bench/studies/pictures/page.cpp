// SPDX-License-Identifier: Apache-2.0
#include "page.hpp"

#include <filesystem>

#include "reflectree/draw/report.hpp"
#include "reflectree/draw/svg.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/text/base64.hpp"

namespace reflectree::pictures {

using namespace draw;

namespace {

constexpr std::uint64_t largest_picture = 16U << 20U;

std::string row(const std::vector<std::string>& cells) {
  std::string out = "|";
  for (const std::string& c : cells) out += " " + c + " |";
  return out + "\n";
}

std::string markdown(const Block& b) {
  std::string out;
  switch (b.kind) {
    case Block::Kind::section:
      return "## " + b.text + "\n\n";
    case Block::Kind::part:
      return "### " + b.text + "\n\n";
    case Block::Kind::words:
      return b.text + "\n\n";
    case Block::Kind::command:
      return "    " + b.text + "\n\n";
    case Block::Kind::table:
      out = row(b.table.head) + "|";
      for (std::size_t i = 0; i < b.table.head.size(); ++i) out += "---|";
      out += "\n";
      for (const auto& r : b.table.rows) out += row(r);
      return out + "\n";
    case Block::Kind::pictures:
      for (const Picture& p : b.pictures) out += "![" + p.words + "](" + p.file + ") ";
      out.back() = '\n';
      return out + "\n";
    case Block::Kind::figure:
      break;
  }
  return "";
}

// Backquotes to <code>.
std::string prose(const std::string& text) {
  std::string out, piece;
  bool code = false;
  for (const char c : text + "`") {
    if (c != '`') {
      piece += c;
      continue;
    }
    out += code ? element("code", {}, escape(piece)) : escape(piece);
    piece.clear(), code = !code;
  }
  return out;
}

std::string table_html(const Table& t) {
  std::string head, rows;
  for (const std::string& h : t.head) head += element("th", {{"scope", "col"}}, prose(h));
  for (const auto& r : t.rows) {
    std::string cells;
    for (std::size_t i = 0; i < r.size(); ++i)
      cells += i == 0 ? element("th", {{"scope", "row"}}, prose(r[i])) : element("td", {}, prose(r[i]));
    rows += element("tr", {}, cells) + "\n";
  }
  return "<div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead><tbody>" + rows +
         "</tbody></table></div>\n";
}

std::string pictures_html(const std::vector<Picture>& pictures, const std::string& folder) {
  std::string out;
  for (const Picture& p : pictures) {
    const std::string path = folder + "/" + p.file;
    if (!std::filesystem::exists(path)) continue;
    const std::string source = "data:image/png;base64," + base64(read_file(path, largest_picture));
    out += "<figure>" +
           element("img",
                   {{"src", source}, {"alt", p.words}, {"style", "width:100%;image-rendering:pixelated"}}) +
           element("figcaption", {}, prose(p.words)) + "</figure>\n";
  }
  return out.empty() ? "" : "<div class=\"pictures wide\">" + out + "</div>\n";
}

std::string html_of(const Block& b, const std::string& folder) {
  switch (b.kind) {
    case Block::Kind::section:
      return "</section>\n<section class=\"card\">" + element("h2", {}, prose(b.text)) + "\n";
    case Block::Kind::part:
      return element("h3", {}, prose(b.text)) + "\n";
    case Block::Kind::words:
      return element("p", {}, prose(b.text)) + "\n";
    case Block::Kind::command:
      return element("p", {}, element("code", {}, escape(b.text))) + "\n";
    case Block::Kind::table:
      return table_html(b.table);
    case Block::Kind::pictures:
      return pictures_html(b.pictures, folder);
    case Block::Kind::figure:
      break;
  }
  return "<div class=\"pictures wide\"><figure>" + inline_svg(b.figure) + "</figure></div>\n";
}

}  // namespace

std::string markdown(const Page& page) {
  std::string out = "# " + page.title + "\n\n" + page.lead + "\n\n";
  for (const Block& b : page.blocks) out += markdown(b);
  while (out.ends_with("\n\n")) out.pop_back();
  return out;
}

std::string html(const Page& page, const std::string& folder) {
  std::string body = "<section class=\"card\">";
  for (const Block& b : page.blocks) body += html_of(b, folder);
  return page_html(page.title, prose(page.lead), body + "</section>\n", escape(page.made));
}

}  // namespace reflectree::pictures
