// SPDX-License-Identifier: Apache-2.0
// Somebody's own sampler judged: a cosine lobe for a constant passes, for another function it is rejected.
#include <cstdio>
#include <optional>
#include <reflectree/math/square_maps.hpp>
#include <reflectree/verify/chi_square.hpp>

using namespace reflectree;

struct Cosine {
  using Value = float;
  std::optional<DirectionSample<float>> sample(Direction, Pcg32& u) const {
    const float r2 = to_unit_float(u()), phi = 2 * pi * to_unit_float(u()), r = sqrt(r2);
    const Direction wi{r * cos(phi), r * sin(phi), sqrt(1 - r2)};
    return DirectionSample<float>{wi, wi.z / pi, 1.f};
  }
  float pdf(Direction, Direction wi) const { return wi.z > 0 ? wi.z / pi : 0; }
};

int main() {
  const auto verdict = [](const AnyBrdf& f) {
    const Cosine cosine;
    const Bins bins = equal_mass_bins(target_function(f), Direction{0.6f, 0, 0.8f});
    const CheckResult result = check_counts(tally_of(erase(cosine), bins), bins);
    std::puts(to_line(result).c_str());
    return result.passed;
  };
  const bool constant = verdict([](Direction, Direction) { return 1 / pi; });
  const bool bent = verdict([](Direction, Direction wi) { return (1 + 0.05f * wi.x) / pi; });
  return constant && !bent ? 0 : 1;
}
