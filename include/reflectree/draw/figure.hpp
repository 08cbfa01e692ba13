// SPDX-License-Identifier: Apache-2.0
// A drawing with its words. It is written as a file of its own, or placed inside a page; both follow the
// reader's light or dark setting and ask for nothing from elsewhere.
#pragma once

#include <string>
#include <vector>

namespace reflectree::draw {

struct Figure {
  double width = 0, height = 0;
  std::string title;        // a few words
  std::string description;  // what a reader who cannot see it should know
  std::string body;         // SVG markup inside (0, 0)-(width, height)
};

// A whole SVG file.
std::string to_svg(const Figure& figure);
// An <svg> element for a page that carries figure_style().
std::string inline_svg(const Figure& figure);
// The style sheet that both need: colours as variables, light and dark, and the classes of the marks.
std::string figure_style();

// Figures beside each other in rows of `columns`, under one title.
Figure side_by_side(const std::string& title, const std::string& description,
                    const std::vector<Figure>& figures, int columns, double gap = 20);

}  // namespace reflectree::draw
