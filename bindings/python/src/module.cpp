// SPDX-License-Identifier: Apache-2.0
// reflectree._core: what the package reflectree stands on. Its functions take arrays that the package has
// checked, and write into arrays that it has made.
#include "brdf.hpp"

namespace nb = nanobind;
using namespace reflectree;

NB_MODULE(_core, m) {
  // reflectree.Error, with what, where and how.
  nb::register_exception_translator(
      [](const std::exception_ptr& thrown, void*) {
        try {
          std::rethrow_exception(thrown);
        } catch (const Error& e) {
          const nb::object type = nb::module_::import_("reflectree._error").attr("Error");
          const nb::object error = type(e.wrong().c_str(), e.where().c_str(), e.how().c_str());
          PyErr_SetObject(type.ptr(), error.ptr());
        }
      },
      nullptr);
  m.attr("version") = REFLECTREE_VERSION;
  python::bind_brdf(m);
  python::bind_sampler(m);
}
