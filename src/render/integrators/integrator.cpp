// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/integrators/integrator.hpp"

#include <algorithm>

#include "reflectree/error.hpp"
#include "reflectree/render/integrators/path_tracer.hpp"
#include "reflectree/render/integrators/photon_mapper.hpp"
#include "reflectree/render/integrators/recursive_tracer.hpp"
#include "reflectree/render/integrators/resampled_direct.hpp"

namespace reflectree::render {

std::unique_ptr<Integrator> make_integrator(const Scene& scene, Technique technique) {
  if (technique == Technique::resampled && scene.transport.method != Transport::Method::direct)
    throw Error("resampling is for direct light alone", "--technique", "add --integrator direct");
  const auto split = [&](int otherwise) {
    return scene.transport.split > 0 ? scene.transport.split : otherwise;
  };
  const int once = scene.max_depth < 0 ? 2 : std::min(2, scene.max_depth);
  switch (scene.transport.method) {
    case Transport::Method::direct:
      if (technique == Technique::resampled) return std::make_unique<ResampledDirect>(scene, split(16));
      return std::make_unique<RecursiveTracer>(scene, technique, split(1), once);
    case Transport::Method::recursive:
      return std::make_unique<RecursiveTracer>(scene, technique, split(16), scene.max_depth);
    case Transport::Method::photons:
      if (technique != Technique::balance && technique != Technique::power)
        throw Error("photons are for indirect light", "--technique", "choose balance or power");
      return std::make_unique<PhotonMapper>(scene, technique);
    case Transport::Method::path:
      break;
  }
  return std::make_unique<PathTracer>(scene, technique);
}

}  // namespace reflectree::render
