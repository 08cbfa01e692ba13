// SPDX-License-Identifier: Apache-2.0
#include "suspects.hpp"

#include "reflectree/formats/open.hpp"
#include "reflectree/verify/faults.hpp"

namespace reflectree::cli {

namespace {

WayIn with_fault(WayIn way, const std::string& fault) {
  if (fault == "bent") return bent(std::move(way), 1);
  if (fault == "lost-support") {
    return lost_support(
        std::move(way), [](Direction wo) { return mirror_direction(wo); }, 0.99f);
  }
  if (fault == "scaled-pdf") return scaled_pdf(std::move(way), 1.02f);
  if (fault == "scaled-weight") return scaled_weight(std::move(way), 1.02f);
  if (fault == "dying") return dying(std::move(way), 100);
  return way;
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

OpenedSampler with_fault(const std::string& fault, OpenedSampler subject) {
  if (fault != "halved-bound") return subject;
  subject.data = with_halved_bounds(std::move(subject.data));
  subject.packed = std::make_shared<const PackedSampler>(pack(subject.data));
  subject.sampler = {ExactSampler<AnyBrdf>(subject.f, subject.packed),
                     OneShotSampler<AnyBrdf>(subject.f, subject.packed)};
  return subject;
}

OpenedFamily with_fault(const std::string& fault, OpenedFamily subject) {
  if (fault != "halved-bound") return subject;
  subject.data = with_halved_bounds(std::move(subject.data));
  subject.packed = std::make_shared<const PackedSampler>(pack(subject.data));
  const auto family = std::make_shared<const Family<AnyFamily>>(subject.sampler.exact.family());
  subject.sampler = {{family, subject.packed}, {family, subject.packed}};
  return subject;
}

namespace {

Suspect planted(Suspect s, const std::string& fault) {
  for (WayIn& way : s.ways) way = with_fault(std::move(way), fault);
  if (fault == "scaled-pdf") {
    for (auto* pdf : {&s.exact_pdf, &s.one_shot_pdf}) {
      *pdf = [inner = *pdf](Direction wo, Direction wi) { return 1.02f * inner(wo, wi); };
    }
  }
  if (fault == "swapped-pdf") {
    for (auto* pdf : {&s.exact_pdf, &s.one_shot_pdf}) {
      *pdf = [inner = *pdf](Direction wo, Direction wi) { return inner(wi, wo); };
    }
  }
  return s;
}

}  // namespace

Suspect suspect_with_fault(const OpenedSampler& subject, const std::string& fault) {
  return planted(suspect(subject.sampler, subject.f, &subject.data), fault);
}

Suspect suspect_with_fault(const OpenedFamily& subject, const Parameters& at, const MemberSampler& member,
                           const std::string& fault) {
  Suspect s = suspect(member, subject.family.member(at), &subject.data);
  s.family = subject.family, s.at = at;
  return planted(std::move(s), fault);
}

}  // namespace reflectree::cli
