// SPDX-License-Identifier: Apache-2.0
#include "reflectree/study/measure.hpp"

#include <numeric>

#include "reflectree/error.hpp"
#include "reflectree/sampler/sampler.hpp"
#include "reflectree/study/thread_time.hpp"
#include "reflectree/verify/reference.hpp"

namespace reflectree::study {

namespace {

std::uint64_t seed_of(std::uint64_t seed, const std::string& name, std::uint64_t part) {
  std::uint64_t hash = 14695981039346656037ULL ^ seed;  // FNV-1a
  for (const char c : name) hash = (hash ^ std::uint8_t(c)) * 1099511628211ULL;
  hash += part * 0x9e3779b97f4a7c15ULL;
  hash = (hash ^ (hash >> 30U)) * 0xbf58476d1ce4e5b9ULL;  // SplitMix64, Steele et al. 2014
  hash = (hash ^ (hash >> 27U)) * 0x94d049bb133111ebULL;
  return hash ^ (hash >> 31U);
}

double azimuth_deg(const AnyBrdf& f, const StudyOptions& o) { return f.traits().isotropic ? 0 : o.phi_o_deg; }

void measure_time(const AnySampler<Spectrum>& sampler, Direction wo, const StudyOptions& o, StudyCell& cell) {
  constexpr std::size_t pool = 512;
  UniformBits u{Pcg32(o.seed, 9)};
  std::vector<Direction> wos(pool), wis(pool, Direction{0, 0, 1});
  for (std::size_t i = 0; i < pool; ++i) {
    wos[i] = direction_from_angles(theta_of(wo), 2 * pi * to_unit_float(u()));
    if (const auto s = sampler.sample(wos[i], u)) wis[i] = s->wi;
  }
  double sum = 0;  // keeps the work from being left out
  cell.floor_ns = 1e9 * median_seconds(o.round_seconds, [&](std::size_t) {
                    const float r2 = to_unit_float(u()), phi = 2 * pi * to_unit_float(u()), r = sqrt(r2);
                    const Direction w{r * cos(phi), r * sin(phi), sqrt(1 - r2)};
                    sum += double(w.x + w.y + w.z);
                  });
  cell.sample_ns = 1e9 * median_seconds(o.round_seconds, [&](std::size_t i) {
                     if (const auto s = sampler.sample(wos[i % pool], u)) sum += double(s->pdf);
                   });
  if (sampler.has_pdf()) {
    cell.pdf_ns = 1e9 * median_seconds(o.round_seconds, [&](std::size_t i) {
                    sum += double(sampler.pdf(wos[i % pool], wis[i % pool]));
                  });
  }
  volatile double used = sum;
  (void)used;
}

SamplerResult measure_sampler(const SamplerInfo& info, const AnySampler<Spectrum>& sampler,
                              const StudyMaterial& material, const MaterialResult& known,
                              std::span<const ReferenceDraws> reference, std::span<const Illumination> lights,
                              const StudyOptions& o, const Host& host) {
  SamplerResult result;
  result.sampler = info.name;
  result.bytes = sampler.bytes();
  const double phi_o_deg = azimuth_deg(material.f, o);
  for (std::size_t i = 0; i < o.theta_o_deg.size(); ++i) {
    if (host.cancelled()) throw Cancelled();
    const Direction wo = study_wo(material.f, o.theta_o_deg[i], o);
    result.cells.push_back(measure_cell(sampler, {}, wo, known.albedo[i], known.albedo_error[i], lights, o,
                                        seed_of(o.seed, material.name, i),
                                        reference.empty() ? nullptr : &reference[i]));
    measure_time(sampler, wo, o, result.cells.back());
    result.slices.push_back(density_slice(sampler, o.theta_o_deg[i], phi_o_deg));
  }
  return result;
}

}  // namespace

Direction study_wo(const AnyBrdf& f, double theta_o_deg, const StudyOptions& o) {
  const double degree = pi_v<double> / 180;
  return direction_from_angles(float(theta_o_deg * degree), float(azimuth_deg(f, o) * degree));
}

MaterialResult measure(const StudyMaterial& material, std::span<const SamplerInfo* const> samplers,
                       std::span<const Illumination> lights, const StudyOptions& o, const Host& host) {
  MaterialResult result;
  result.material = material.name;
  const std::size_t angles = o.theta_o_deg.size();
  result.albedo.resize(angles + 1), result.albedo_error.resize(angles + 1);
  const TargetFunction t = target_function(material.f);
  host.parallel_for(angles + 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (host.cancelled()) throw Cancelled();
      const double theta = i < angles ? o.theta_o_deg[i] : curve_theta_o_deg;
      ReferenceOptions reference;
      reference.max_evaluations = o.cubature_evaluations;
      const auto a = reference_albedo(t, study_wo(material.f, theta, o), reference);
      result.albedo[i] = a.value, result.albedo_error[i] = a.error;
    }
  });
  for (std::size_t i = 0; i < angles; ++i)
    result.slices.push_back(
        target_slice(material.f, {}, o.theta_o_deg[i], result.albedo[i], azimuth_deg(material.f, o)));
  // One build serves our modes; peers may use it too, so its time is counted where it is ours.
  Host alone;
  alone.cancelled = host.cancelled;
  PeerSubject subject{material.f, material.material, {}, nullptr};
  BuildOptions build_options;
  build_options.seed = o.seed;
  double our_seconds = 0;
  std::vector<ReferenceDraws> reference;
  try {
    const double start = thread_seconds();
    subject.packed = std::make_shared<const PackedSampler>(pack(build(material.f, build_options, alone)));
    our_seconds = thread_seconds() - start;
    const auto exact = find_sampler("exact")->make(subject, alone);
    reference.resize(angles);
    host.parallel_for(angles, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Direction wo = study_wo(material.f, o.theta_o_deg[i], o);
        reference[i] = reference_draws(*exact, wo, lights, o, seed_of(o.seed, material.name, i));
      }
    });
  } catch (const Error&) {
    reference.clear();  // our modes will say it again, as their fault
  }
  // Peers tabulate one azimuth of wo where traits say that it does not matter, and they do by default.
  if (subject.packed && material.f.traits().isotropic && !subject.packed->viewer.frame.isotropic()) {
    throw Error("depends on the azimuth of wo, and its traits say that it is isotropic", material.name,
                "set BrdfTraits::isotropic to false");
  }
  std::vector<std::optional<SamplerResult>> found(samplers.size());
  host.parallel_for(samplers.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SamplerInfo& info = *samplers[i];
      const double start = thread_seconds();
      try {
        const auto sampler = info.make(subject, alone);
        const double seconds = thread_seconds() - start + (is_ours(info) ? our_seconds : 0);
        if (!sampler) continue;
        found[i] = measure_sampler(info, *sampler, material, result, reference, lights, o, host);
        found[i]->build_seconds = seconds;
        const Direction wo = study_wo(material.f, curve_theta_o_deg, o);
        found[i]->curves = measure_curves(*sampler, wo, result.albedo[angles], lights, o,
                                          seed_of(o.seed, material.name, angles));
      } catch (const Error& error) {
        found[i] = SamplerResult{};
        found[i]->sampler = info.name;
        found[i]->fault = error.what();
      }
    }
  });
  result.albedo.pop_back(), result.albedo_error.pop_back();
  for (auto& s : found) {
    if (s) result.samplers.push_back(std::move(*s));
  }
  return result;
}

}  // namespace reflectree::study
