// SPDX-License-Identifier: Apache-2.0
#include "hypotheses.hpp"

#include <cstdio>

namespace reflectree::detail {
namespace {

constexpr double pi2 = pi_v<double>;
using P = DirectionPair;

double cos_d(const P& p) { return 0.5 * length(p.wo + p.wi); }
double cos_h(const P& p) { return (p.wo.z + p.wi.z) / length(p.wo + p.wi); }
double sin_i(const P& p) { return std::hypot(p.wi.x, p.wi.y); }

// Lambert's disk in polar coordinates (phi / 2 pi, r^2), its two coordinates exchanged: equal areas of the
// disk, so that densities per projected solid angle are kept.
P transposed_polar(P p) {
  double u = std::atan2(p.wi.y, p.wi.x) / (2 * pi2);
  if (u < 0) u += 1;
  const double v = sqr(p.wi.x) + sqr(p.wi.y), r = std::sqrt(u);
  return {p.wo, {r * std::cos(2 * pi2 * v), r * std::sin(2 * pi2 * v), std::sqrt(std::max(1 - u, 0.))}};
}
double transposed_polar_factor(const P& p) { return p.wi.z / std::max(transposed_polar(p).wi.z, 1e-9); }

constexpr DensityHypothesis density[] = {
    {"pdf_swapped", "the pdf is that of wi and wo exchanged",
     [](P p) {
       return P{p.wi, p.wo};
     },
     nullptr},
    {"projected_solid_angle",
     "the pdf is per projected solid angle where it should be per solid angle: a factor cos_theta_i is "
     "missing",
     nullptr, [](const P& p) { return p.wi.z; }},
    {"pdf_cosine_twice", "the pdf has the factor cos_theta_i once too often", nullptr,
     [](const P& p) { return 1 / p.wi.z; }},
    {"jacobian_4",
     "the pdf is 4 times too large: the 4 in the half vector's Jacobian 1 / (4 wo.wh) is missing", nullptr,
     [](const P&) { return 0.25; }},
    {"jacobian_4_twice", "the pdf is 4 times too small: the 4 of the half vector's Jacobian is in it twice",
     nullptr, [](const P&) { return 4.; }},
    {"jacobian_wo_wh", "the Jacobian's factor 1 / (wo.wh) is missing in the pdf", nullptr,
     [](const P& p) { return 1 / cos_d(p); }},
    {"jacobian_wo_wh_twice", "the Jacobian's factor 1 / (wo.wh) is in the pdf once too often", nullptr,
     [](const P& p) { return cos_d(p); }},
    {"half_vector_density", "the pdf is that of the half vector: the Jacobian 1 / (4 wo.wh) is missing",
     nullptr, [](const P& p) { return 0.25 / cos_d(p); }},
    {"half_vector_jacobian_twice", "the Jacobian 1 / (4 wo.wh) is in the pdf twice", nullptr,
     [](const P& p) { return 4 * cos_d(p); }},
    {"lobe_choice", "the pdf is twice too large: it leaves out the choice of the lobe (0.5)", nullptr,
     [](const P&) { return 0.5; }},
    {"pdf_half", "the pdf is half of the density", nullptr, [](const P&) { return 2.; }},
    {"two_pi", "the pdf is 2 pi times too large: a factor 1 / (2 pi) is missing", nullptr,
     [](const P&) { return 0.5 / pi2; }},
    {"two_pi_twice", "the pdf is 2 pi times too small: a factor 1 / (2 pi) is in it twice", nullptr,
     [](const P&) { return 2 * pi2; }},
    {"pi", "the pdf is pi times too large: a factor 1 / pi is missing", nullptr,
     [](const P&) { return 1 / pi2; }},
    {"pi_twice", "the pdf is pi times too small: a factor 1 / pi is in it twice", nullptr,
     [](const P&) { return pi2; }},
    {"pdf_degrees", "the pdf is per degree where it should be per radian", nullptr,
     [](const P&) { return 180 / pi2; }},
    {"cos_o_missing", "a factor cos_theta_o is missing in the pdf", nullptr,
     [](const P& p) { return p.wo.z; }},
    {"cos_o_twice", "a factor 1 / cos_theta_o is missing in the pdf", nullptr,
     [](const P& p) { return 1 / p.wo.z; }},
    {"cos_h_missing", "the factor cos_theta_h of the half vector's density is missing in the pdf", nullptr,
     cos_h},
    {"cos_h_twice", "the factor cos_theta_h of the half vector's density is in the pdf once too often",
     nullptr, [](const P& p) { return 1 / cos_h(p); }},
    {"sine_missing", "the pdf is per theta and phi: the factor 1 / sin_theta_i is missing", nullptr,
     [](const P& p) { return 1 / std::max(sin_i(p), 1e-9); }},
    {"azimuth_half_turn", "directions and pdf are half a turn apart: phi is off by pi",
     [](P p) {
       return P{p.wo, {-p.wi.x, -p.wi.y, p.wi.z}};
     },
     nullptr},
    {"azimuth_sign", "directions and pdf are mirror images: the sign of phi (of y) is lost or changed",
     [](P p) {
       return P{p.wo, {p.wi.x, -p.wi.y, p.wi.z}};
     },
     nullptr},
    {"azimuth_mirrored", "directions and pdf are mirror images: the sign of x is changed",
     [](P p) {
       return P{p.wo, {-p.wi.x, p.wi.y, p.wi.z}};
     },
     nullptr},
    {"widths_exchanged", "the widths along x and y are exchanged between directions and pdf",
     [](P p) {
       return P{{p.wo.y, p.wo.x, p.wo.z}, {p.wi.y, p.wi.x, p.wi.z}};
     },
     nullptr},
    {"table_transposed", "directions and pdf have x and y exchanged: a table is transposed",
     [](P p) {
       return P{p.wo, {p.wi.y, p.wi.x, p.wi.z}};
     },
     nullptr},
    {"table_transposed", "the two coordinates (phi, radius) are exchanged: a table is transposed",
     transposed_polar, transposed_polar_factor},
    {"azimuth_quarter_turn", "directions and pdf are a quarter of a turn apart",
     [](P p) {
       return P{p.wo, {-p.wi.y, p.wi.x, p.wi.z}};
     },
     nullptr},
    {"azimuth_quarter_turn", "directions and pdf are a quarter of a turn apart",
     [](P p) {
       return P{p.wo, {p.wi.y, -p.wi.x, p.wi.z}};
     },
     nullptr},
    {"uniform_for_cosine", "directions are uniform over the hemisphere and the pdf is that of a cosine lobe",
     nullptr, [](const P& p) { return 0.5 / p.wi.z; }},
    {"cosine_for_uniform", "directions follow a cosine lobe and the pdf is that of uniform ones", nullptr,
     [](const P& p) { return 2 * p.wi.z; }},
};

constexpr WeightHypothesis weights[] = {
    {"weight_cosine_twice", "the weight has the factor cos_theta_i once too often",
     [](const P& p, double) { return p.wi.z; }},
    {"weight_cosine_missing", "the weight leaves out cos_theta_i",
     [](const P& p, double) { return 1 / p.wi.z; }},
    {"weight_without_pdf", "the weight is f cos_theta_i: it is not divided by the pdf",
     [](const P&, double pdf) { return pdf; }},
    {"weight_is_f", "the weight is f: neither multiplied by cos_theta_i nor divided by the pdf",
     [](const P& p, double pdf) { return pdf / p.wi.z; }},
    {"weight_pdf_twice", "the weight is divided by the pdf twice",
     [](const P&, double pdf) { return 1 / pdf; }},
    {"weight_4", "the weight is 4 times too large", [](const P&, double) { return 4.; }},
    {"weight_quarter", "the weight is 4 times too small", [](const P&, double) { return 0.25; }},
    {"weight_lobe_choice",
     "the weight is half of f cos_theta_i / pdf: the choice of the lobe (0.5) is in it twice",
     [](const P&, double) { return 0.5; }},
    {"weight_double", "the weight is twice f cos_theta_i / pdf: the choice of the lobe (0.5) is left out",
     [](const P&, double) { return 2.; }},
    {"weight_pi", "the weight is pi times too large: a factor 1 / pi is missing",
     [](const P&, double) { return pi2; }},
    {"weight_pi_twice", "the weight is pi times too small: a factor 1 / pi is in it twice",
     [](const P&, double) { return 1 / pi2; }},
    {"weight_two_pi", "the weight is 2 pi times too large", [](const P&, double) { return 2 * pi2; }},
    {"weight_two_pi_twice", "the weight is 2 pi times too small", [](const P&, double) { return 0.5 / pi2; }},
    {"weight_cos_o", "the weight has a factor cos_theta_o too many",
     [](const P& p, double) { return p.wo.z; }},
    {"weight_cos_o_missing", "the weight has a factor 1 / cos_theta_o too many",
     [](const P& p, double) { return 1 / p.wo.z; }},
    {"weight_wo_wh", "the weight has a factor wo.wh too many", [](const P& p, double) { return cos_d(p); }},
    {"weight_wo_wh_missing", "the weight has a factor 1 / (wo.wh) too many",
     [](const P& p, double) { return 1 / cos_d(p); }},
    {"weight_jacobian", "the weight has the half vector's Jacobian 4 wo.wh too many",
     [](const P& p, double) { return 4 * cos_d(p); }},
    {"weight_jacobian_missing", "the weight leaves out the half vector's Jacobian 4 wo.wh",
     [](const P& p, double) { return 0.25 / cos_d(p); }},
    {"weight_cos_h", "the weight has a factor cos_theta_h too many",
     [](const P& p, double) { return cos_h(p); }},
    {"weight_cos_h_missing", "the weight has a factor 1 / cos_theta_h too many",
     [](const P& p, double) { return 1 / cos_h(p); }},
};

}  // namespace

std::span<const DensityHypothesis> density_hypotheses() { return density; }
std::span<const WeightHypothesis> weight_hypotheses() { return weights; }

std::string name_of_factor(double factor, double tolerance) {
  struct Named {
    double value;
    const char* name;
  };
  constexpr Named named[] = {{2, "2"},
                             {4, "4"},
                             {3, "3"},
                             {pi2, "pi"},
                             {2 * pi2, "2 pi"},
                             {4 * pi2, "4 pi"},
                             {180 / pi2, "180 / pi"},
                             {8, "8"}};
  for (const Named& n : named) {
    if (std::abs(factor / n.value - 1) < tolerance) return n.name;
    if (std::abs(factor * n.value - 1) < tolerance)
      return std::string("1 / ") + (n.value == 2 * pi2 || n.value == 4 * pi2 || n.value == 180 / pi2
                                        ? std::string("(") + n.name + ")"
                                        : n.name);
  }
  return "";
}

}  // namespace reflectree::detail
