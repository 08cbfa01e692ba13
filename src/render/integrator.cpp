// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/integrator.hpp"

#include "reflectree/error.hpp"
#include "reflectree/render/path_tracer.hpp"

namespace reflectree::render {

std::unique_ptr<Integrator> make_integrator(const Scene& scene, Technique technique) {
  if (technique == Technique::resampled && scene.transport.method != Transport::Method::direct)
    throw Error("resampling is for direct light alone", "--technique", "add --integrator direct");
  return std::make_unique<PathTracer>(scene, technique);
}

}  // namespace reflectree::render
