// SPDX-License-Identifier: Apache-2.0
// Pictures from many samples per pixel, in passes: a render can stop after any of them, be saved, and go on.
// A sample's random bits depend on seed, pixel, sample and point set alone: the picture is the same for any
// number of threads, passes and interruptions. The strata of stratified points are as many as the samples
// that the first render was asked for, columns by rows; the film keeps them.
#pragma once

#include "reflectree/picture/image.hpp"
#include "reflectree/render/integrators/integrator.hpp"

namespace reflectree::render {

struct RenderOptions {
  int samples = 0;  // per pixel; 0: the scene's
  std::uint64_t seed = 1;
  std::optional<Technique> technique{};  // otherwise the scene's
  double seconds = 0;  // > 0: stop after this time, between passes; `samples` is then ignored
};

// The sums of all samples so far.
struct Film {
  int width = 0, height = 0, samples = 0;
  std::uint64_t seed = 1;
  PointSet points;
  std::uint64_t identity = 0;  // of the scene and the options that its samples depend on
  std::vector<double> sums;    // [pixel][r, g, b, r^2, g^2, b^2]
};

// Adds passes to `film`, empty or from an earlier render of the same scene, seed and technique (else an
// Error), until it has what `options` ask for. False where the host cancelled:
// `film` then holds the whole passes before.
bool render_into(Film& film, const Scene& scene, const RenderOptions& options, const Host& host = {});

// Channels R, G, B and stderr.R, stderr.G, stderr.B, the standard error of each pixel's mean, too
// large for stratified and Sobol' points: it takes samples for independent.
Image to_image(const Film& film);

// Throws Error for a file that is damaged.
void save_film(const std::string& path, const Film& film);
Film load_film(const std::string& path);

// All at once. Throws Cancelled.
Image render(const Scene& scene, const RenderOptions& options = {}, const Host& host = {});

}  // namespace reflectree::render
