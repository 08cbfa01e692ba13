// SPDX-License-Identifier: Apache-2.0
// The doctor: judges anybody's eval, sample and pdf, and says in words what is wrong with them.
//
// Checks (names of CheckResult):
//   finite, not_negative   eval, pdf and sample over a sweep towards grazing and the normal
//   repeatable             the same arguments give the same values
//   pdf_agrees             sample's pdf == pdf(wo, wi)
//   weight_agrees          weight * pdf == f cos_theta_i, channel by channel
//   pdf_integral           integral of pdf + share of lost draws == 1
//   chi_square_pdf         directions fall into bins of equal probability as pdf says
//   light                  weights bin by bin, and their mean, are f cos_theta_i by cubature: the white furnace
//   support                pdf > 0 where f > 0
//   above                  no direction with a weight lies below the horizon
//   independent            successive directions know nothing of each other
//   spread                 directions do not repeat, nor lie on lines
// Where one fails, hypotheses are tried: each is a transformation of pdf, directions or weights that would
// explain what was seen. The simplest one that explains the data to within statistics is named.
#pragma once

#include "reflectree/host.hpp"
#include "reflectree/verify/diagnosis.hpp"
#include "reflectree/verify/patient.hpp"

namespace reflectree {

struct DoctorOptions {
  std::vector<double> theta_o_deg{0, 30, 55, 75, 86};  // viewers, at random azimuths,
  int random_viewers = 1;                              // and so many more, anywhere
  std::size_t samples = 200'000;                       // for each viewer
  int pointwise_viewers = 32, pointwise_draws = 100;   // looked at one by one
  int bins = 256;
  double family_significance = 1e-6;  // a sound sampler gets a finding in one run of 1 / this
  std::uint64_t seed = 1;
};
// Seconds, some ten seconds, a minute and more on a native sampler.
enum class DoctorEffort : std::uint8_t { quick, normal, thorough };
DoctorOptions doctor_options(DoctorEffort effort);

// Reflection only: wi above the surface. Throws Error where a function throws, Cancelled.
Diagnosis doctor(const Patient& patient, const DoctorOptions& options = {}, const Host& host = {});

}  // namespace reflectree
