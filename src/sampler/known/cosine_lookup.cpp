// SPDX-License-Identifier: Apache-2.0
#include "reflectree/sampler/known/cosine_lookup.hpp"

namespace reflectree {

CosineLookup::CosineLookup(std::vector<float> borders) : borders_(std::move(borders)) {
  borders_.back() = 2;  // so that every search ends
  // Refine the guide until no entry spans two borders, up to 256 entries per octave.
  for (shift_ = 19; shift_ > 15;) {
    --shift_;
    guide_.clear();
    std::size_t i = 0, crowded = 0;
    for (std::uint32_t entry = 0; entry <= (std::bit_cast<std::uint32_t>(1.f) - base_) >> shift_; ++entry) {
      const float c = std::bit_cast<float>(base_ + (entry << shift_));
      const std::size_t before = i;
      while (borders_[i + 1] <= c) ++i;
      crowded += i > before + 1;
      guide_.push_back(std::uint16_t(i));
    }
    if (crowded == 0) break;
  }
}

}  // namespace reflectree
