// SPDX-License-Identifier: Apache-2.0
// <shape>: its vertices, triangles, spheres and disks, its material, and the light it gives.
#pragma once

#include "xml_materials.hpp"

namespace reflectree::render {

void read_shape(const XmlReader& xml, MaterialReader& materials, Node n, Scene& scene);

}  // namespace reflectree::render
