// SPDX-License-Identifier: Apache-2.0
// Renders cells. Time is CPU time of the one thread that renders a cell, so that what else the machine does
// counts for little; cells run side by side.
#pragma once

#include <functional>

#include "cells.hpp"
#include "reflectree/render/film/film.hpp"

namespace reflectree::pictures {

// The converged picture, its own noise, and the pixels that count: all where there is no mask.
struct Reference {
  Image image;
  RelativeError noise;
  std::vector<char> mask;
};

// b's noise from the standard errors of its pixels.
Reference reference_of(const render::Film& film, std::vector<char> mask = {});
RelativeError relative_error(const Image& a, const Reference& b);

// How a cell is rendered.
struct Method {
  render::Transport transport;
  render::Technique technique = render::Technique::balance;
  render::PointSet::Kind points = render::PointSet::Kind::independent;
  int samples = 25;
};

// The scene as the method wants it.
render::Scene prepared(const render::Scene& scene, const Method& method);

// CPU seconds of a sample per pixel, the lesser of two short renders. Throws Cancelled.
double seconds_per_sample(const render::Scene& scene, const Method& method, const Host& host);

// One film that stops at the lesser of both numbers of samples, is looked at, and goes on to the other.
// `image`: of the film at method.samples. Throws Cancelled.
void measure(PictureCell& cell, const render::Scene& scene, const Method& method, int timed_samples,
             std::uint64_t seed, const Reference& reference, const Host& host, Image* image = nullptr);

// body(0) ... body(n - 1), begun in this order on so many threads. What one throws ends the others.
void for_each_job(unsigned threads, std::size_t n, const std::function<void(std::size_t)>& body);
// A host whose parallel_for is this; `cancelled` and the progress are the caller's.
Host with_threads(unsigned threads, Host host);

}  // namespace reflectree::pictures
