// SPDX-License-Identifier: Apache-2.0
// All that is wrong with a scene in one sentence, and the words that change nothing in another.
#include <algorithm>

#include "xml_reader.hpp"

namespace reflectree::render {

namespace {

constexpr std::size_t most_problems = 60, most_places = 12;

// "file:line:column" without the file.
std::string line_and_column(const std::string& place) {
  const std::size_t column = place.rfind(':'),
                    line = column == std::string::npos ? column : place.rfind(':', column - 1);
  return line == std::string::npos ? place : place.substr(line + 1);
}

}  // namespace

// What follows from an element's first fault is none of its own.
void XmlReader::note(const Problem& problem) const {
  const auto same = [&](const Problem& p) { return p.place == problem.place; };
  if (std::none_of(problems_.begin(), problems_.end(), same)) problems_.push_back(problem);
}

void XmlReader::throw_problems() const {
  if (problems_.empty()) return;
  if (problems_.size() == 1) throw ElementError(problems_.front());
  std::vector<Problem> kinds;
  std::vector<std::size_t> times;
  for (const Problem& p : problems_) {
    const auto like = std::find_if(kinds.begin(), kinds.end(),
                                   [&](const Problem& k) { return k.what == p.what && k.how == p.how; });
    if (like == kinds.end()) {
      kinds.push_back(p), times.push_back(1);
      continue;
    }
    const std::size_t n = ++times[std::size_t(like - kinds.begin())];
    if (n <= most_places) like->place += ", " + line_and_column(p.place);
    if (n == most_places + 1) like->place += ", ...";
  }
  std::string rest;
  for (std::size_t i = 1; i < std::min(kinds.size(), most_problems); ++i)
    rest += " | " + kinds[i].place + ": " + kinds[i].what + "; " + kinds[i].how;
  if (kinds.size() > most_problems)
    rest += " | and " + std::to_string(kinds.size() - most_problems) + " more";
  throw Error(kinds[0].what, kinds[0].place, kinds[0].how + rest);
}

void XmlReader::idle(Node n) const {
  if (n) idle_.emplace_back(n.attribute("name").value(), line_and_column(place(n)));
}

std::string XmlReader::idle_words() const {
  std::string all;
  for (const auto& [word, where] : idle_) all += (all.empty() ? "" : ", ") + word + " (" + where + ")";
  return all.empty() ? all : "words that change no pixel: " + all;
}

}  // namespace reflectree::render
