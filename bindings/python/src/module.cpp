// SPDX-License-Identifier: Apache-2.0
// reflectree._core: what the package reflectree stands on. Its functions take arrays that the package has
// checked, and write into arrays that it has made.
#include "brdf.hpp"
#include "error.hpp"
#include "judges.hpp"

namespace nb = nanobind;
using namespace reflectree;

NB_MODULE(_core, m) {
  python::translate_errors();
  m.attr("version") = REFLECTREE_VERSION;
  python::bind_brdf(m);
  python::bind_sampler(m);
  python::bind_family(m);
  m.attr("has_judges") = REFLECTREE_PYTHON_JUDGES != 0;
#if REFLECTREE_PYTHON_JUDGES
  python::bind_verify(m);
  python::bind_doctor(m);
#endif
}
