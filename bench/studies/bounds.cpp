// SPDX-License-Identifier: Apache-2.0
// Searches for values above certified bounds, and above the estimated ones that they replace. Prints a Markdown
// table; exit code 1 if a certified bound is exceeded, or a material is not certified.
#include <cstdio>

#include "bound_search.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/brdf/material/registry.hpp"
#include "reflectree/math/random.hpp"
#include "reflectree/sampler/build.hpp"
#include "reflectree/sampler/certify.hpp"
#include "study_program.hpp"
#include "threads.hpp"

namespace {

using namespace reflectree;
using namespace reflectree::study;

// Puts the bound of one leaf below the largest value that a search of it finds, by a share of that. Leaves at the
// floor are not asked.
template <class F>
void plant(const SamplerData& data, PackedSampler& packed, const F& f, double share, std::uint64_t seed,
           const Host& host) {
  PackedSampler one = packed;
  Pcg32 u(seed, 61);
  for (int tries = 0; tries < 1000; ++tries) {
    const std::uint32_t s = u() % std::uint32_t(packed.exact.slabs.size());
    const std::uint32_t k = u() % packed.exact.slabs[s].count;
    const std::uint32_t leaf = packed.exact.slabs[s].first + k;
    // Only this leaf has a bound that can be reached.
    for (PackedLeaf& other : one.exact.leaves) other.height = 1e30f;
    one.exact.leaves[leaf].height = packed.exact.leaves[leaf].height;
    const BoundFindings seen = search_bounds(data, one, f, {20000 * one.exact.leaves.size(), seed + 1}, host);
    if (seen.worst < 0.5) continue;
    PackedLeaf& cut = packed.exact.leaves[leaf];
    cut.height = float(double(cut.height) * seen.worst * (1 - share));
    std::fprintf(stderr, "leaf %u: bound at %.4f of the largest value seen\n", leaf, 1 - share);
    return;
  }
  throw Error("no leaf to cut", "planted fault", "take another seed");
}

std::string cell(const BoundFindings& found) {
  char text[120];
  std::snprintf(text, sizeof text, "%.4f at %.4f°, %llu in %llu leaves", found.worst,
                found.theta_o * 180 / pi_v<double>, static_cast<unsigned long long>(found.above),
                static_cast<unsigned long long>(found.leaves));
  return text;
}

// f: a function or a family.
template <class F>
bool search(const std::string& name, const F& f, const BoundSearch& options, double planted,
            const Host& threads) {
  SamplerData data = build(f, {}, threads);
  const PackedSampler estimated = pack(data);
  const Certification c = certify(data, f, {}, threads);
  PackedSampler certified = pack(data);
  if (planted > 0) plant(data, certified, f, planted, options.seed, threads);
  const auto look = [&](const PackedSampler& packed, const char* status) {
    Host host = threads;
    int shown = -1;
    host.progress = [&](float share) {
      if (int(10 * share) > shown)
        std::fprintf(stderr, "%s, %s: %d %%\n", name.c_str(), status, 10 * (shown = int(10 * share)));
    };
    return search_bounds(data, packed, f, options, host);
  };
  const BoundFindings before = planted > 0 ? BoundFindings() : look(estimated, "estimated");
  const BoundFindings after = look(certified, "certified");
  const bool whole = c.certified_slabs == c.slabs, holds = whole && after.above == 0;
  std::printf("| `%s` | %zu | %s | %s%s |\n", name.c_str(), c.leaves, cell(before).c_str(),
              cell(after).c_str(),
              !whole   ? ", NOT ALL CERTIFIED"
              : !holds ? ", A BOUND IS EXCEEDED"
                       : "");
  std::fflush(stdout);
  return holds;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Searches for values above certified and estimated bounds"};
  std::vector<std::string> materials;
  BoundSearch options;
  double evaluations = 1e9, planted = 0;
  int threads = 2;
  app.add_option("MATERIALS", materials, "Models and families of models, each searched twice")->required();
  app.add_option("--evaluations", evaluations, "Of each search")->check(CLI::Range(1e3, 1e13));
  app.add_option("--seed", options.seed, "Of the starts");
  app.add_option("--threads", threads, "Threads")->check(CLI::Range(1, 256));
  app.add_option("--plant", planted, "Put one bound below the largest value of its leaf, by this share");
  return run_program(app, argc, argv, [&] {
    options.evaluations = std::uint64_t(evaluations);
    std::printf("| material | leaves | estimated: largest T / (â M q), values above 1 | certified |\n");
    std::printf("|---|---|---|---|\n");
    bool holds = true;
    const Host host = host_with_threads(threads);
    for (const std::string& name : materials) {
      const Material material = parse_material(name);
      const bool held = is_family(material) ? search(name, make_family(material), options, planted, host)
                                            : search(name, make_brdf(material), options, planted, host);
      holds = held && holds;
    }
    return holds ? 0 : 1;
  });
}
