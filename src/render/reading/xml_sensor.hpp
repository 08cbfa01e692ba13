// SPDX-License-Identifier: Apache-2.0
// <sensor>: the camera, its film and its points.
#pragma once

#include "xml_reader.hpp"

namespace reflectree::render {

void read_sensor(const XmlReader& xml, Node n, Scene& scene);

}  // namespace reflectree::render
