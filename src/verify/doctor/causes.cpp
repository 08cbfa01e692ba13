// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "hypotheses.hpp"
#include "reflectree/verify/diagnosis.hpp"

namespace reflectree {
namespace {

// Those that no row of a table of hypotheses names.
constexpr DoctorCause others[] = {
    {"unexplained", "a check fails, and no hypothesis explains the data to within statistics"},
    {"not_finite", "NaN or infinite values"},
    {"not_finite_at_normal", "NaN or infinite values where a direction is the normal"},
    {"not_finite_at_grazing", "NaN or infinite values towards grazing"},
    {"negative", "negative values"},
    {"not_unit", "directions that are not of unit length"},
    {"eval_stochastic", "eval is random"},
    {"pdf_stochastic", "pdf is random"},
    {"seed_ignored", "another seed gives the same directions"},
    {"seed_without_effect", "a remark: the same seed gives other directions"},
    {"discrete_lobe", "a discrete lobe among directions with a density"},
    {"grazing_clamped", "directions beyond a cosine are moved to it"},
    {"same_random_number", "the same random number is used twice"},
    {"float_precision", "cosines near 1 are rounded to single precision"},
    {"repeated", "directions repeat"},
    {"correlated", "successive directions depend on each other"},
    {"draws_below_horizon", "directions below the horizon carry a weight"},
    {"never_draws", "no direction is drawn for a viewer"},
    {"pdf_scaled", "the pdf is the density times a factor"},
    {"below_horizon", "density below the horizon is drawn again, and the pdf does not know"},
    {"pdf_normalisation", "the pdf has the right shape and a wrong integral that depends on wo"},
    {"pdf_below_horizon", "a remark: pdf is not 0 below the horizon, nor what the lost draws there say"},
    {"draws_f_cos", "directions follow f cos_theta_i exactly, and pdf says something else"},
    {"draws_f", "directions follow f without its cosine"},
    {"draws_cosine", "directions follow a cosine lobe whatever pdf says"},
    {"draws_uniform", "directions are uniform whatever pdf says"},
    {"grazing_never", "directions next to the horizon are never drawn"},
    {"half_lobe", "half of the half vectors are never drawn"},
    {"mixture_weight", "a mixture is drawn with other weights than pdf has"},
    {"dropped_lobe", "a lobe that pdf counts is never drawn"},
    {"pdf_drops_lobe", "the pdf leaves out a lobe that is drawn"},
    {"bound_too_low", "a bound of rejection is too low"},
    {"degrees_for_radians", "an angle in degrees is taken for radians"},
    {"table_off_by_one", "directions and pdf differ by a cell of a table"},
    {"azimuth_turned", "directions and pdf are turned against each other"},
    {"sample_pdf_scaled", "the pdf that sample returns is pdf(wo, wi) times a factor"},
    {"lobe_pdf", "sample returns the pdf of the lobe that it chose"},
    {"weight_scaled", "the weight is f cos_theta_i / pdf times a factor"},
    {"wrong_channel", "the weight's channels are not f's"},
    {"f_swapped", "the weight takes f with its directions exchanged"},
    {"f_half_turn", "the weight takes f half a turn away"},
    {"f_mirrored", "the weight takes f at the mirror image"},
    {"no_support", "pdf is 0 where f is not"},
    {"biased", "weights do not add up to f cos_theta_i"},
    {"not_reciprocal", "a remark: f is not reciprocal"},
    {"gains_energy", "a remark: f reflects more than it receives"},
};

}  // namespace

std::span<const DoctorCause> doctor_causes() {
  static const std::vector<DoctorCause> all = [] {
    std::vector<DoctorCause> list(std::begin(others), std::end(others));
    const auto add = [&](const DoctorCause& cause) {
      for (const DoctorCause& known : list) {
        if (known.key == cause.key) return;
      }
      list.push_back(cause);
    };
    for (const auto& h : detail::density_hypotheses()) add({h.cause, h.words});
    for (const auto& h : detail::weight_hypotheses()) add({h.cause, h.words});
    return list;
  }();
  return all;
}

}  // namespace reflectree
