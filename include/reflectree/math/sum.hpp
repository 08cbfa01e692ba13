// SPDX-License-Identifier: Apache-2.0
// Compensated summation. Neumaier 1974 ("improved Kahan-Babuska"): the error of the result is a few
// ulp of the sum plus O(n eps^2) of the sum of absolute values, also when terms exceed the sum so far.
#pragma once

#include "reflectree/math/scalar.hpp"

namespace reflectree {

class CompensatedSum {
 public:
  constexpr CompensatedSum& operator+=(double x) {
    const double t = total_ + x;
    // The low digits lost in t belong to the smaller of the two terms.
    const double a = total_ < 0 ? -total_ : total_, b = x < 0 ? -x : x;
    lost_ += a >= b ? (total_ - t) + x : (x - t) + total_;
    total_ = t;
    return *this;
  }
  constexpr CompensatedSum& operator-=(double x) { return *this += -x; }
  constexpr double value() const { return total_ + lost_; }

 private:
  double total_ = 0, lost_ = 0;
};

}  // namespace reflectree
