// SPDX-License-Identifier: Apache-2.0
#include "reflectree/draw/figure.hpp"

#include <algorithm>

#include "reflectree/draw/svg.hpp"

namespace reflectree::draw {

// Blue and orange are told apart by every common kind of colour blindness (Okabe and Ito 2008).
std::string figure_style() {
  return R"(.rt{--ink:#1c2333;--soft:#5a6478;--rule:#d5dae3;--paper:#ffffff;--plane:#f3f5f9;--curve:#0b62b0;--bars:#e08214;--accept:#0b62b0;--reject:#d1620b;--night:#09122a;
color:var(--ink);font-family:"Inter","Segoe UI","Helvetica Neue",Helvetica,Arial,"Liberation Sans",sans-serif;font-size:12px}
@media (prefers-color-scheme:dark){.rt{--ink:#e9ecf3;--soft:#a0aabd;--rule:#3a4254;--paper:#12151d;--plane:#1b202b;--curve:#6cb4f5;--bars:#f0a04b;--accept:#6cb4f5;--reject:#f2a15a;--night:#05080f}}
.rt text{fill:var(--ink);font-variant-numeric:tabular-nums}
.rt .math{font-family:"STIX Two Text","Cambria",Georgia,"Liberation Serif","DejaVu Serif",serif;font-style:italic;font-size:108%}
.rt .head{font-size:14px;font-weight:600}
.rt .aside{font-size:13px;fill:var(--soft)}
.rt .label{font-size:11.5px}
.rt .tick{font-size:10.5px;fill:var(--soft)}
.rt .note{font-size:11px;fill:var(--soft)}
.rt .over{font-size:10.5px;fill:#fff;stroke:#09122a;stroke-width:2.4px;stroke-opacity:.65;paint-order:stroke;stroke-linejoin:round}
.rt .on-pale{font-size:10.5px;fill:#2a1636}.rt .on-dark{font-size:10.5px;fill:#fff}
.rt .paper{fill:var(--paper)}.rt .plane{fill:var(--plane)}.rt .night{fill:var(--night)}
.rt path,.rt line,.rt circle,.rt polyline{fill:none;stroke-linecap:round;stroke-linejoin:round}
.rt .axis{stroke:var(--soft);stroke-width:1}
.rt .grid{stroke:var(--rule);stroke-width:1}
.rt .rim{stroke:var(--soft);stroke-width:1.4}
.rt .ring{stroke:#fff;stroke-width:.7;stroke-opacity:.42;stroke-dasharray:1.5 3.5}
.rt .cells{stroke:var(--ink);stroke-width:.6}
.rt .cells-light,.rt .cells-dark{fill:none;stroke-linejoin:round}
.rt .cells-light{stroke:#fff;stroke-width:.55;stroke-opacity:.62}
.rt .cells-dark{stroke:#1a1030;stroke-width:.55;stroke-opacity:.62}
.rt .pale{opacity:.36}
.rt .dots{stroke:var(--ink);stroke-width:1.7;stroke-opacity:.8}
.rt .mark{stroke:#fff;stroke-width:1.8}.rt .mark-edge{stroke:#09122a;stroke-width:3.8;stroke-opacity:.7}
.rt .ink-mark{stroke:var(--bars);stroke-width:2.2}.rt .paper-edge{stroke:var(--paper);stroke-width:4.4;stroke-opacity:.85}
.rt .over-ink{font-size:10.5px;stroke:var(--paper);stroke-width:2.4px;stroke-opacity:.8;paint-order:stroke;stroke-linejoin:round}
.rt .curve{stroke:var(--curve);stroke-width:2}
.rt .curve-thin{stroke:var(--curve);stroke-width:1}
.rt .arrow{stroke:var(--ink);stroke-width:1.3}
.rt .curve-2{stroke:var(--bars);stroke-width:2}
.rt .curve-3{stroke:var(--ink);stroke-width:2;stroke-dasharray:5 4}
.rt .curve-4{stroke:var(--soft);stroke-width:2;stroke-dasharray:1 4}
.rt .ours{stroke:var(--curve);stroke-width:2.8}
.rt .hue-0{stroke:#d55e00}.rt .hue-1{stroke:#009e73}.rt .hue-2{stroke:#cc79a7}.rt .hue-3{stroke:#a8801c}.rt .hue-4{stroke:#8067d8}.rt .hue-5{stroke:#7d8896}
.rt .dash-0,.rt .dash-1,.rt .dash-2{stroke-width:1.7}
.rt .dash-1{stroke-dasharray:7 4}.rt .dash-2{stroke-dasharray:1.5 4}
.rt .ours.dash-0,.rt .ours.dash-1,.rt .ours.dash-2{stroke-width:2.8}
.rt .bar{fill:var(--bars);fill-opacity:.5;stroke:none}
.rt .bar-edge{fill:none;stroke:var(--rule);stroke-width:1}
.rt .bar-line{stroke:var(--bars);stroke-width:1}
.rt .fill-target{fill:var(--soft);fill-opacity:.24;stroke:none}
.rt a text{fill:var(--curve)}.rt a:hover text{text-decoration:underline}
.rt .fill-1{fill:var(--curve);fill-opacity:.22;stroke:none}
.rt .fill-2{fill:var(--bars);fill-opacity:.28;stroke:none}
.rt .box{fill:none;stroke:var(--soft);stroke-width:1}
.rt .chosen{fill:var(--bars);fill-opacity:.34;stroke:var(--bars);stroke-width:1.6}
.rt .interval{fill:var(--plane);stroke:var(--soft);stroke-width:.7}
.rt .box-dashed{fill:none;stroke:var(--rule);stroke-width:1.2;stroke-dasharray:4 4}
.rt .fit{fill:none;stroke:var(--bars);stroke-width:2.2}
.rt .corner-in{fill:var(--curve);stroke:var(--curve)}.rt .corner-out{fill:var(--paper);stroke:var(--soft);stroke-width:1.4}
.rt .cell-night,.rt .cell-bright{fill:none}
.rt .cell-night{stroke:#fff;stroke-width:.5;stroke-opacity:.6}.rt .cell-bright{stroke:#1a1030;stroke-width:.5;stroke-opacity:.6}
.rt .stairs{stroke:var(--ink);stroke-width:1.4}
.rt .fill-strong{fill:var(--curve);fill-opacity:.75;stroke:none}
.rt .nested{fill:var(--bars);fill-opacity:.14;stroke:var(--bars);stroke-width:1.5}
.rt .ring-mark{fill:#3fc1c9;fill-opacity:.62;fill-rule:evenodd;stroke:none}.rt .wedge-mark{fill:#f5a13a;fill-opacity:.72;stroke:none}
.rt .pole{stroke:var(--curve);stroke-width:2.4}
.rt .guide{stroke:var(--soft);stroke-width:1;stroke-dasharray:3 3}
.rt .whisker{stroke:var(--bars);stroke-width:1;stroke-opacity:.85}
.rt .accepted{stroke:var(--accept);stroke-width:3.2}
.rt .rejected{stroke:var(--reject);stroke-width:1.1})";
}

std::string inline_svg(const Figure& figure) {
  const std::string box = "0 0 " + number(figure.width) + " " + number(figure.height);
  const std::string words = figure.title + ". " + figure.description;
  return element("svg", {{"class", "rt"}, {"viewBox", box}, {"role", "img"}, {"aria-label", words}},
                 "\n" + figure.body);
}

std::string to_svg(const Figure& figure) {
  const std::string box = "0 0 " + number(figure.width) + " " + number(figure.height);
  const std::string content = "\n" + element("title", {}, escape(figure.title)) + "\n" +
                              element("desc", {}, escape(figure.description)) + "\n" +
                              element("style", {}, figure_style()) + "\n" +
                              element("rect", {{"class", "paper"},
                                               {"width", number(figure.width)},
                                               {"height", number(figure.height)},
                                               {"rx", "10"}}) +
                              "\n" + figure.body;
  return element("svg",
                 {{"xmlns", "http://www.w3.org/2000/svg"},
                  {"class", "rt"},
                  {"viewBox", box},
                  {"width", number(figure.width)},
                  {"height", number(figure.height)},
                  {"role", "img"}},
                 content) +
         "\n";
}

Figure side_by_side(const std::string& title, const std::string& description,
                    const std::vector<Figure>& figures, int columns, double gap) {
  Figure all{0, 0, title, description, {}};
  double x = 0, y = 0, row_height = 0;
  int column = 0;
  for (const Figure& f : figures) {
    if (column == columns) {
      y += row_height + gap;
      x = row_height = 0;
      column = 0;
    }
    const std::string shift = "translate(" + number(x) + " " + number(y) + ")";
    all.body += element("g", {{"transform", shift}}, f.body) + "\n";
    x += f.width;
    all.width = std::max(all.width, x);
    x += gap;
    row_height = std::max(row_height, f.height);
    ++column;
  }
  all.height = y + row_height;
  return all;
}

}  // namespace reflectree::draw
