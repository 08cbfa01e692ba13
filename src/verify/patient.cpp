// SPDX-License-Identifier: Apache-2.0
#include "reflectree/verify/patient.hpp"

namespace reflectree {

Patient patient(const AnyBrdf& f) {
  Patient p;
  p.name = f.traits().name;
  p.channels = f.channels();
  p.concurrent = f.traits().concurrent;
  p.eval = [f](std::span<const Direction> wo, std::span<const Direction> wi, std::span<double> out) {
    std::vector<float> values(out.size());
    f.eval(wo, wi, values);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = double(values[i]);
  };
  return p;
}

Patient patient(const AnyBrdf& f, const AnySampler<Spectrum>& sampler) {
  Patient p = patient(
      sampler.name(), f, [sampler](Direction wo, Pcg32& u) { return sampler.sample(wo, u); },
      [sampler](Direction wo, Direction wi) { return sampler.pdf(wo, wi); });
  if (!sampler.has_pdf()) p.pdf = nullptr;
  return p;
}

}  // namespace reflectree
