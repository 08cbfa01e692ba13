// SPDX-License-Identifier: Apache-2.0
// The integral of an enclosed function over the square, at every elevation at once.
#pragma once

#include <vector>

#include "reflectree/math/affine_form.hpp"

namespace reflectree::detail {

// A function of the elevation: between two lines over an interval, which e in [-1, 1] runs over.
struct ElevationLine {
  double lo = 0, hi = 0;  // the middle at e = -1 and 1
  double error = 0;
};

// The mean of a form over its second and third variable. Where its logarithm is the narrower one, the mean of
// the exponential of that: of e^(s e) it is sinh(s) / s, and the logarithm's own error is all that is left.
ElevationLine mean_over_square(const AffineForm& form);

// A sum of such functions, each over the whole interval or over a part that halvings lead to.
class ElevationSum {
 public:
  // Node 0 is the whole interval.
  std::size_t lower_half(std::size_t node);
  std::size_t upper_half(std::size_t node) { return lower_half(node) + 1; }
  void add(std::size_t node, const ElevationLine& line);
  void add(const ElevationSum& other) { add(0, other, 0); }
  // visit(lo, hi, line) from end to end, where the interval goes from lo to hi.
  template <class Visit>
  void visit(double lo, double hi, const Visit& visit) const {
    walk(0, lo, hi, {}, visit);
  }

 private:
  struct Node {
    ElevationLine line;
    std::size_t lower = 0;  // its halves; 0: none
  };
  void add(std::size_t node, const ElevationSum& other, std::size_t its);
  template <class Visit>
  void walk(std::size_t node, double lo, double hi, ElevationLine line, const Visit& visit) const {
    const Node& own = nodes_[node];
    line.lo += own.line.lo, line.hi += own.line.hi, line.error += own.line.error;
    if (own.lower == 0) return visit(lo, hi, line);
    const double middle = 0.5 * (line.lo + line.hi), cut = 0.5 * (lo + hi);
    walk(own.lower, lo, cut, {line.lo, middle, line.error}, visit);
    walk(own.lower + 1, cut, hi, {middle, line.hi, line.error}, visit);
  }
  std::vector<Node> nodes_ = std::vector<Node>(1);
};

}  // namespace reflectree::detail
