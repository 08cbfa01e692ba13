// SPDX-License-Identifier: Apache-2.0
// What Python calls a Family: a function with parameters that have ranges, and its sampler.
#pragma once

#include "reflectree/formats/open.hpp"
#include "sampler.hpp"

namespace reflectree::python {

struct PyFamily : OpenedFamily {
  std::optional<PythonBrdf> function = std::nullopt;  // where it is one of Python
  FunctionOwner owner = {};
};

}  // namespace reflectree::python
