// SPDX-License-Identifier: Apache-2.0
#include "directions.hpp"

namespace reflectree::c {

void eval_pairs(const AnyBrdf& f, std::size_t n, const float* wo, const float* wi, float* values,
                const char* where) {
  const auto channels = std::size_t(f.channels());
  check_count(n, std::max<std::size_t>(3, channels), where);
  needed_for(n, wo, where, "wo"), needed_for(n, wi, where, "wi"), needed_for(n, values, where, "values");
  in_blocks(n, [&](std::size_t first, std::size_t count) {
    constexpr Direction below{0, 0, -1};
    std::array<Direction, block_size> o, i;
    for (std::size_t k = 0; k < count; ++k) {
      o[k] = direction_at(wo, first + k), i[k] = direction_at(wi, first + k);
      if (!is_above(o[k]) || !is_above(i[k])) o[k] = i[k] = below;
    }
    f.eval({o.data(), count}, {i.data(), count}, {values + first * channels, count * channels});
  });
}

}  // namespace reflectree::c
