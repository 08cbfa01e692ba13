// SPDX-License-Identifier: Apache-2.0
// <sensor>: the camera, its film and its points.
#pragma once

#include "xml_reader.hpp"

namespace reflectree::render {

void read_sensor(const XmlReader& xml, Node n, Scene& scene);

// Half the width at distance 1 of a picture of this aspect, by 'fov' and 'fov_axis' or 'focal_length'.
double half_width(const XmlReader& xml, Node n, double aspect);

}  // namespace reflectree::render
