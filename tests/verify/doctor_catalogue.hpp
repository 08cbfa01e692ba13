// SPDX-License-Identifier: Apache-2.0
// A list of sound patients, and one of faults planted in them, each with the cause that the doctor must name.
#pragma once

#include "doctor_patients.hpp"

namespace reflectree::catalogue {

struct Entry {
  const char* name;
  const char* cause;  // what the doctor must name; empty: sound
  std::function<Patient()> make;
};

inline double wo_wh(Direction wo, Direction wi) { return 0.5 * double(length(wo + wi)); }

inline std::vector<Entry> sound() {
  return {
      {"cosine lobe on a diffuse surface", "", diffuse},
      {"visible normals on their metal", "", metal},
      {"cosine lobe on a metal", "",
       [] {
         return of_lobes("ggx:alpha=0.3", lobes({{1, cosine_lobe()}}));
       }},
      {"mixture on a plastic", "", plastic},
      {"half vectors on a brushed metal", "", [] { return brushed(); }},
      {"half-vector lobe of Ashikhmin and Shirley", "",
       [] {
         return of_lobes("ashikhmin_shirley",
                         lobes({{0.5f, cosine_lobe()}, {0.5f, {LobeKind::half_power, 10, 100}}}));
       }},
      {"uniform directions", "",
       [] {
         return of_lobes("plastic:alpha=0.3", lobes({{1, {LobeKind::uniform}}}));
       }},
      {"sub-normalised but honest", "", [] { return power_lobe(false); }},
      {"a table", "", [] { return of_table(); }},
      {"rejection", "", [] { return by_rejection(1); }},
      {"half vectors of a sharp metal", "", [] { return rough_lobe(0.002f, false); }},
      {"a function that is not reciprocal", "",
       [] {
         return patient(one_way(),
                        AnySampler<Spectrum>("one way", WeightedSampler<AnyBrdf, LobeMixture>(
                                                            one_way(), lobes({{1, cosine_lobe()}}))));
       }},
  };
}

inline std::vector<Entry> faults() {
  const auto each = [](auto f) { return f; };
  const auto half = [](Direction wo, Direction wi) { return wo_wh(wo, wi); };
  return {
      {"pdf(wi, wo) for pdf(wo, wi)", "pdf_swapped", each([] {
         Patient p = plastic();
         p.pdf = [inner = p.pdf](std::span<const Direction> wo, std::span<const Direction> wi,
                                 std::span<double> out) { inner(wi, wo, out); };
         return p;
       })},
      {"swapped directions, believed by sample", "pdf_swapped", each([] {
         const LobeMixture m = lobes({{1, visible_normals(0.3f)}});
         return with_pdf(metal(), [m](Direction wo, Direction wi, double) { return double(m.pdf(wi, wo)); });
       })},
      {"cosine missing in the weight", "weight_cosine_missing", each([] {
         return with_weight(metal(), [](Direction, Direction wi, double) { return 1 / double(wi.z); });
       })},
      {"cosine twice in the weight", "weight_cosine_twice", each([] {
         return with_weight(metal(), [](Direction, Direction wi, double) { return double(wi.z); });
       })},
      {"weight without 1/pdf", "weight_without_pdf",
       each([] { return with_weight(plastic(), [](Direction, Direction, double pdf) { return pdf; }); })},
      {"weight is f", "weight_is_f", each([] {
         return with_weight(plastic(),
                            [](Direction, Direction wi, double pdf) { return pdf / double(wi.z); });
       })},
      {"Jacobian without its 4", "jacobian_4",
       each([] { return with_pdf(metal(), [](Direction, Direction, double p) { return 4 * p; }); })},
      {"Jacobian without wo.wh", "jacobian_wo_wh",
       [half] {
         return with_pdf(metal(), [half](Direction wo, Direction wi, double p) { return p * half(wo, wi); });
       }},
      {"density of half vectors", "half_vector_density",
       [half] {
         return with_pdf(metal(),
                         [half](Direction wo, Direction wi, double p) { return 4 * p * half(wo, wi); });
       }},
      {"2 pi missing", "two_pi", each([] {
         return with_pdf(metal(), [](Direction, Direction, double p) { return 2 * pi_v<double> * p; });
       })},
      {"pi missing, in pdf alone", "pi", each([] {
         return with_pdf(
             diffuse(), [](Direction, Direction, double p) { return pi_v<double> * p; }, false);
       })},
      {"projected solid angle for solid angle", "projected_solid_angle", each([] {
         return with_pdf(plastic(), [](Direction, Direction wi, double p) { return p / double(wi.z); });
       })},
      {"cosine twice in the pdf", "pdf_cosine_twice", each([] {
         return with_pdf(plastic(), [](Direction, Direction wi, double p) { return p * double(wi.z); });
       })},
      {"cos_theta_h twice", "cos_h_twice", each([] {
         return with_pdf(metal(), [](Direction wo, Direction wi, double p) {
           return p * double((wo.z + wi.z) / length(wo + wi));
         });
       })},
      {"cosine pdf of uniform directions", "uniform_for_cosine", each([] {
         return with_directions(diffuse(), directions_of(lobes({{1, {LobeKind::uniform}}})));
       })},
      {"sub-normalised", "pdf_scaled",
       each([] { return with_pdf(metal(), [](Direction, Direction, double p) { return 0.9 * p; }); })},
      {"super-normalised", "pdf_scaled",
       each([] { return with_pdf(plastic(), [](Direction, Direction, double p) { return 1.1 * p; }); })},
      {"a bias of 0.5 % in the pdf", "pdf_scaled",
       each([] { return with_pdf(plastic(), [](Direction, Direction, double p) { return 1.005 * p; }); })},
      // As of an approximate masking function, which is in the pdf and not in the sampler.
      {"a factor that depends on wo", "pdf_normalisation", each([] {
         return with_pdf(metal(), [](Direction wo, Direction, double p) {
           return (1 + 0.03 * std::cos(8 * double(wo.z))) * p;
         });
       })},
      {"a bias of 0.5 % in the weight", "weight_scaled",
       each([] { return with_weight(plastic(), [](Direction, Direction, double) { return 1.005; }); })},
      {"wrong mixture weight", "mixture_weight",
       each([] { return with_directions(plastic(), mixed(0.3f, 0.2f)); })},
      {"dropped diffuse lobe", "dropped_lobe", each([] {
         return with_directions(plastic(), directions_of(lobes({{1, visible_normals(0.2f)}})));
       })},
      {"dropped specular lobe", "draws_cosine", each([] {
         return with_directions(plastic(), directions_of(lobes({{1, cosine_lobe()}})));
       })},
      {"a lobe missing in the pdf", "pdf_drops_lobe", each([] {
         const LobeMixture m = lobes({{1, visible_normals(0.2f)}});
         return with_pdf(plastic(),
                         [m](Direction wo, Direction wi, double) { return 0.5 * double(m.pdf(wo, wi)); });
       })},
      {"lobe choice not in the pdf", "lobe_choice",
       each([] { return with_pdf(plastic(), [](Direction, Direction, double p) { return 2 * p; }); })},
      {"pdf of the chosen lobe alone", "lobe_pdf", each([] {
         Patient p = plastic();
         const auto channels = std::size_t(p.channels);
         p.sample = [eval = p.eval, channels](std::span<const Direction> wo, std::uint64_t seed,
                                              std::span<PatientDraw> draws, std::span<double> values) {
           Pcg32 u(seed);
           const ProposalLobe both[] = {cosine_lobe(), visible_normals(0.2f)};
           std::vector<Direction> wi(wo.size(), {0, 0, 1});
           for (std::size_t i = 0; i < wo.size(); ++i) {
             const ProposalLobe& lobe = both[u() & 1U];
             UniformBits bits(u);
             const auto drawn = lobe.sample(wo[i], bits);
             u = bits.rest();
             draws[i] = {};
             if (drawn) wi[i] = *drawn, draws[i] = {*drawn, double(lobe.pdf(wo[i], *drawn)), true};
           }
           eval(wo, wi, values);
           for (std::size_t k = 0; k < values.size(); ++k) {
             const PatientDraw& d = draws[k / channels];
             values[k] = d.drawn ? values[k] * double(d.wi.z) / d.pdf : 0;
           }
         };
         return p;
       })},
      {"grazing never drawn", "grazing_never", each([] {
         return with_directions(diffuse(), [](Direction, Pcg32& u) -> std::optional<Direction> {
           for (;;) {
             const double a = to_unit_double(u()), b = to_unit_double(u());
             const Direction wi = cosine_direction(a, b);
             if (wi.z > 0.1f) return wi;
           }
         });
       })},
      {"grazing clamped", "grazing_clamped", each([] {
         return with_directions(
             diffuse(), changed(directions_of(lobes({{1, cosine_lobe()}})), [](Direction, Direction wi) {
               if (wi.z > 0.1f) return wi;
               const float r = std::sqrt((1 - 0.01f) / (wi.x * wi.x + wi.y * wi.y));
               return Direction{r * wi.x, r * wi.y, 0.1f};
             }));
       })},
      {"a bound that is too low", "bound_too_low", each([] { return by_rejection(0.4); })},
      {"a table off by one in phi", "table_off_by_one", each([] { return of_table(1, 0); })},
      {"a table off by one in radius", "table_off_by_one", each([] { return of_table(0, 1); })},
      {"a transposed table", "table_transposed", each([] { return of_table(0, 0, true); })},
      {"phi off by pi", "azimuth_half_turn", each([] {
         return with_directions(metal(), changed(directions_of(lobes({{1, visible_normals(0.3f)}})),
                                                 [](Direction, Direction wi) {
                                                   return Direction{-wi.x, -wi.y, wi.z};
                                                 }));
       })},
      {"the sign of phi", "azimuth_sign", each([] {
         return with_directions(metal(), changed(directions_of(lobes({{1, visible_normals(0.3f)}})),
                                                 [](Direction, Direction wi) {
                                                   return Direction{wi.x, -wi.y, wi.z};
                                                 }));
       })},
      {"half of an anisotropic lobe", "half_lobe", each([] {
         Patient p =
             of_lobes("ward:alpha_x=0.15,alpha_y=0.5", lobes({{1, {LobeKind::gaussian, 0.15f, 0.5f}}}));
         return with_directions(std::move(p), [](Direction wo, Pcg32& u) -> std::optional<Direction> {
           const double a = to_unit_double(u()), b = to_unit_double(u());
           const double r = std::sqrt(-std::log(1 - a)),
                        phi = std::atan(0.5 / 0.15 * std::tan(2 * pi_v<double> * b));
           const double width = 1 / std::sqrt(sqr(std::cos(phi) / 0.15) + sqr(std::sin(phi) / 0.5));
           const Direction wh =
               normalize(Direction{float(r * width * std::cos(phi)), float(r * width * std::sin(phi)), 1});
           if (!(dot(wo, wh) > 0)) return std::nullopt;
           const Direction wi = normalize(reflect(wo, wh));
           if (!(wi.z > 0)) return std::nullopt;
           return wi;
         });
       })},
      {"widths along x and y exchanged", "widths_exchanged", each([] {
         return with_directions(
             brushed(),
             directions_of(lobes({{0.3f, cosine_lobe()}, {0.7f, {LobeKind::gaussian, 0.5f, 0.15f}}})));
       })},
      {"degrees for radians", "degrees_for_radians", each([] {
         const float right = 30 * pi / 180;
         const LobeMixture m = lobes({{0.3f, cosine_lobe()}, {0.7f, {LobeKind::gaussian, 0.15f, 0.5f}}});
         Patient p = with_pdf(
             of_lobes("ward:alpha_x=0.15,alpha_y=0.5,phi_deg=30", m),
             [m, right](Direction wo, Direction wi, double) {
               return double(m.pdf(turned(wo, -right), turned(wi, -right)));
             },
             false);
         const auto own = directions_of(m);
         return with_directions(std::move(p),
                                [own, right](Direction wo, Pcg32& u) -> std::optional<Direction> {
                                  const auto wi = own(turned(wo, -right), u);
                                  if (!wi) return wi;
                                  return turned(*wi, 30.f);
                                });
       })},
      {"cosines near 1 in single precision", "float_precision",
       each([] { return rough_lobe(0.002f, true); })},
      {"the same random number twice", "same_random_number", each([] {
         return with_directions(diffuse(), [](Direction, Pcg32& u) -> std::optional<Direction> {
           const double a = to_unit_double(u());
           return cosine_direction(a, a);
         });
       })},
      {"a correlated generator", "correlated", each([] {
         Patient p = diffuse();
         const auto channels = std::size_t(p.channels);
         p.sample = [channels](std::span<const Direction> wo, std::uint64_t seed,
                               std::span<PatientDraw> draws, std::span<double> values) {
           Pcg32 u(seed);
           double a = to_unit_double(u()), b = to_unit_double(u());
           for (std::size_t i = 0; i < wo.size(); ++i) {
             // Every second one is near the one before.
             a = i % 2 == 1 ? a + 0.05 * to_unit_double(u()) : to_unit_double(u());
             b = i % 2 == 1 ? b + 0.05 * to_unit_double(u()) : to_unit_double(u());
             a -= std::floor(a), b -= std::floor(b);
             const Direction wi = cosine_direction(a, b);
             draws[i] = {wi, double(wi.z) / pi_v<double>, true};
             for (std::size_t c = 0; c < channels; ++c) values[i * channels + c] = 0.5;
           }
         };
         return p;
       })},
      {"a generator that repeats", "repeated", each([] {
         Patient p = diffuse();
         p.sample = [inner = p.sample](std::span<const Direction> wo, std::uint64_t seed,
                                       std::span<PatientDraw> draws,
                                       std::span<double> values) { inner(wo, seed % 4, draws, values); };
         return p;
       })},
      {"a seed that is ignored", "seed_ignored", each([] {
         Patient p = plastic();
         p.sample = [inner = p.sample](std::span<const Direction> wo, std::uint64_t,
                                       std::span<PatientDraw> draws,
                                       std::span<double> values) { inner(wo, 7, draws, values); };
         return p;
       })},
      {"a random eval", "eval_stochastic", each([] {
         const auto u = std::make_shared<Pcg32>(3);
         Patient p = with_eval(plastic(), [u](Direction, Direction, double v) {
           return v * (0.9 + 0.2 * to_unit_double((*u)()));
         });
         p.concurrent = false;
         return p;
       })},
      {"negative values", "negative", each([] {
         return with_eval(plastic(),
                          [](Direction, Direction wi, double v) { return wi.z < 0.1f ? -0.01 : v; });
       })},
      {"NaN at the normal", "not_finite_at_normal", each([] {
         return with_pdf(
             metal(),
             [](Direction wo, Direction, double p) { return wo.x == 0 && wo.y == 0 ? double(NAN) : p; },
             false);
       })},
      {"infinite at grazing", "not_finite_at_grazing", each([] {
         return with_eval(plastic(), [](Direction, Direction wi, double v) {
           return wi.z < 2e-3f ? double(INFINITY) : v;
         });
       })},
      {"zero support", "no_support", each([] {
         Patient p = with_pdf(
             diffuse(), [](Direction, Direction wi, double pdf) { return wi.x > 0 ? 2 * pdf : 0.; }, false);
         return with_directions(
             std::move(p), changed(directions_of(lobes({{1, cosine_lobe()}})), [](Direction, Direction wi) {
               return Direction{std::abs(wi.x), wi.y, wi.z};
             }));
       })},
      {"channels in another order", "wrong_channel", each([] {
         return with_draw(metal(), [](Direction, std::size_t, PatientDraw&, std::span<double> v) {
           std::swap(v[0], v[2]);
         });
       })},
      {"one channel for all", "wrong_channel", each([] {
         return with_draw(
             metal(), [](Direction, std::size_t, PatientDraw&, std::span<double> v) { v[1] = v[2] = v[0]; });
       })},
      {"f(wi, wo) in the weight", "f_swapped", each([] {
         const AnyBrdf f = one_way();
         Patient p = patient(f, AnySampler<Spectrum>("one way", WeightedSampler<AnyBrdf, LobeMixture>(
                                                                    f, lobes({{1, cosine_lobe()}}))));
         return with_draw(std::move(p), [f](Direction wo, std::size_t, PatientDraw& d, std::span<double> v) {
           float value = 0;
           f.eval({&d.wi, 1}, {&wo, 1}, {&value, 1});
           v[0] = double(value * d.wi.z) / d.pdf;
         });
       })},
      {"a discrete lobe with a continuous pdf", "discrete_lobe", each([] {
         const auto own = mixed(0.5f, 0.2f);
         return with_directions(plastic(), [own](Direction wo, Pcg32& u) -> std::optional<Direction> {
           if (to_unit_double(u()) < 0.3) return mirror_direction(wo);
           return own(wo, u);
         });
       })},
      {"density below the horizon, drawn again", "below_horizon", each([] { return power_lobe(true); })},
      {"directions below the horizon", "draws_below_horizon", each([] {
         return with_draw(metal(), [](Direction, std::size_t number, PatientDraw& d, std::span<double>) {
           if (number % 20 == 0) d.wi.z = -d.wi.z;
         });
       })},
      {"a weight for pdf(), and another pdf from sample", "sample_pdf_scaled", each([] {
         return with_draw(plastic(),
                          [](Direction, std::size_t, PatientDraw& d, std::span<double>) { d.pdf *= 1.02; });
       })},
      {"a lobe of f that pdf knows and the function lost", "weight_double",
       each([] { return with_weight(plastic(), [](Direction, Direction, double) { return 2.; }); })},
      {"NaN weights towards grazing viewers", "not_finite_at_grazing", each([] {
         return with_draw(metal(), [](Direction wo, std::size_t, PatientDraw&, std::span<double> v) {
           if (wo.z < 0.005f) v[0] = double(NAN);
         });
       })},
  };
}

}  // namespace reflectree::catalogue
