// SPDX-License-Identifier: Apache-2.0
#include "suspects.hpp"

#include <algorithm>

#include "reflectree/verify/faults.hpp"

namespace reflectree::cli {

namespace {

// The heaviest leaf of every slab loses half of its bound; the other bounds stay.
SamplerData with_halved_bounds(SamplerData data) {
  for (MajorantTree& tree : data.exact) {
    const auto heaviest = std::max_element(tree.mass.begin(), tree.mass.end());
    double sum = 0;
    for (const std::uint32_t m : tree.mass) sum += m;
    const std::uint32_t lost = *heaviest / 2;
    *heaviest -= lost;
    tree.volume = float(double(tree.volume) * (sum - lost) / sum);
  }
  return data;
}

ErasedSampler spoiled(ErasedSampler sampler, const std::string& fault, Direction wo) {
  const Direction mirror{-wo.x, -wo.y, wo.z};
  if (fault == "bent") return bent(std::move(sampler), 1);
  if (fault == "swapped-pdf") return swapped_pdf(std::move(sampler));
  if (fault == "lost-support") return lost_support(std::move(sampler), mirror, 0.99f);
  if (fault == "scaled-pdf") return scaled_pdf(std::move(sampler), 1.02f);
  if (fault == "scaled-weight") return scaled_weight(std::move(sampler), 1.02f);
  if (fault == "dying") return dying(std::move(sampler), 100);
  return sampler;
}

}  // namespace

const std::vector<std::string>& fault_names() {
  static const std::vector<std::string> names{"none",         "bent",       "halved-bound",  "swapped-pdf",
                                              "lost-support", "scaled-pdf", "scaled-weight", "dying"};
  return names;
}

std::string fault_list() {
  std::string list;
  for (const std::string& name : fault_names()) list += (list.empty() ? "" : ", ") + name;
  return list;
}

Subject with_fault(const std::string& fault, Subject subject) {
  if (fault != "halved-bound") return subject;
  subject.data = with_halved_bounds(std::move(subject.data));
  subject.packed = std::make_shared<const PackedSampler>(pack(subject.data));
  subject.sampler = {ExactSampler<AnyBrdf>(subject.f, subject.packed),
                     OneShotSampler<AnyBrdf>(subject.f, subject.packed)};
  return subject;
}

Suspects suspects(const Subject& subject, const std::string& fault, Direction wo) {
  const Target target = subject.data.target;
  return {spoiled(erase(subject.sampler.exact, target, "exact"), fault, wo),
          spoiled(erase(subject.sampler.one_shot, target, "one-shot"), fault, wo),
          target_function(subject.f, target)};
}

}  // namespace reflectree::cli
