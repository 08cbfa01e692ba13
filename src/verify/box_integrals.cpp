// SPDX-License-Identifier: Apache-2.0
#include "box_integrals.hpp"

#include <algorithm>
#include <cmath>

#include "parallel.hpp"

namespace reflectree::detail {
namespace {

int cells_across(double width, double of, int grid) { return std::max(2, int(std::ceil(width / of * grid))); }

// Where an interval of the chart is cut: where its grading turns, so that no region straddles a kink, and closer
// and closer to its ends.
std::vector<double> cuts_of(double begin, double end, bool slivers) {
  std::vector<double> cuts{begin};
  for (double next = std::floor(begin) + 1; next < end; next += 1) cuts.push_back(next);
  cuts.push_back(end);
  for (int k = 4; slivers && k <= 256; k *= 4)
    cuts.push_back(begin + (end - begin) / k), cuts.push_back(end - (end - begin) / k);
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

CubatureResult integrate(const Integrand& f, const CubatureBox& box, BoxRule rule) {
  CubatureResult total;
  total.converged = true;
  const std::vector<double> x = cuts_of(box.x0, box.x1, rule.slivers),
                            y = cuts_of(box.y0, box.y1, rule.slivers);
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    for (std::size_t j = 0; j + 1 < y.size(); ++j) {
      rule.cells_x = cells_across(x[i + 1] - x[i], 4, grid_x);
      rule.cells_y = cells_across(y[j + 1] - y[j], 2, grid_y);
      const CubatureResult r = cubature(f, {x[i], x[i + 1], y[j], y[j + 1]}, rule);
      total.value += r.value;
      total.error += r.error;
      total.evaluations += r.evaluations;
      total.converged = total.converged && r.converged;
    }
  }
  return total;
}

// Every box. A function that is called from one thread may be a program on a pipe or one of Python, to which
// each call is dear: the cubatures of many boxes go on together, and what they ask next is asked at once. A
// cubature is begun anew each time, with the answers that it has had, and ends where it asks for more.
struct Unanswered {};

struct Replay {
  std::vector<std::vector<double>> answers;  // to its calls, in order
  std::vector<Vec2<double>> asked;           // by the call after them; empty: it is done
  CubatureResult result;

  void go_on(const CubatureBox& box, const BoxRule& rule) {
    std::size_t next = 0;
    asked.clear();
    const Integrand remembered = [&](std::span<const Vec2<double>> p, std::span<double> out) {
      if (next < answers.size()) {
        std::copy(answers[next].begin(), answers[next].end(), out.begin());
        ++next;
        return;
      }
      asked.assign(p.begin(), p.end());
      throw Unanswered{};
    };
    try {
      result = integrate(remembered, box, rule);
      answers.clear();
    } catch (const Unanswered&) {
    }
  }
};

void integrate_together(const Integrand& f, std::span<const CubatureBox> boxes, const BoxRule& rule,
                        std::span<CubatureResult> results, const Host& host) {
  std::vector<Replay> replays(boxes.size());
  std::vector<Vec2<double>> all;
  std::vector<double> values;
  do {
    if (host.cancelled()) throw Cancelled();
    std::size_t from = 0;
    all.clear();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      Replay& r = replays[i];
      if (!values.empty() && r.asked.empty()) continue;
      if (!r.asked.empty()) {
        const auto begin = values.begin() + std::ptrdiff_t(from);
        from += r.asked.size();
        r.answers.emplace_back(begin, values.begin() + std::ptrdiff_t(from));
      }
      r.go_on(boxes[i], rule);
      all.insert(all.end(), r.asked.begin(), r.asked.end());
    }
    values.resize(all.size());
    if (!all.empty()) f(all, values);
  } while (!all.empty());
  for (std::size_t i = 0; i < boxes.size(); ++i) results[i] = replays[i].result;
}

}  // namespace

std::vector<CubatureResult> integrate_all(const Integrand& f, bool concurrent,
                                          const std::vector<CubatureBox>& boxes, const BoxRule& rule,
                                          const Host& host) {
  std::vector<CubatureResult> results(boxes.size());
  if (concurrent) {
    for_each_index(host, true, boxes.size(),
                   [&](std::size_t i) { results[i] = integrate(f, boxes[i], rule); });
    return results;
  }
  constexpr std::size_t together = 256;  // what they remember is a few hundred MB at most
  for (std::size_t first = 0; first < boxes.size(); first += together) {
    const std::size_t n = std::min(together, boxes.size() - first);
    integrate_together(f, std::span(boxes).subspan(first, n), rule, std::span(results).subspan(first, n),
                       host);
  }
  return results;
}

}  // namespace reflectree::detail
