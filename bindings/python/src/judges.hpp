// SPDX-License-Identifier: Apache-2.0
// What judges samplers: built where the headers of Boost and Eigen were found (decision 0053).
#pragma once

#include <nanobind/nanobind.h>

namespace reflectree::python {

void bind_verify(nanobind::module_& m);
void bind_doctor(nanobind::module_& m);

}  // namespace reflectree::python
