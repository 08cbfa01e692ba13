// SPDX-License-Identifier: Apache-2.0
// A scene and a ray through Embree.
#include <reflectree/render/scene.hpp>
#include <reflectree/render/shapes/embree_scene.hpp>

int main() {
  using namespace reflectree::render;
  const Scene scene = parse_scene(R"(<scene version="3.0.0">
      <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="8"/>
        <integer name="height" value="8"/></film><float name="fov" value="40"/></sensor>
      <shape type="rectangle"/></scene>)",
                                  "memory");
  const EmbreeScene embree(scene);
  return embree.intersect({{0, 0, 3}, {0, 0, -1}}) && !embree.intersect({{3, 0, 3}, {0, 0, -1}}) ? 0 : 1;
}
