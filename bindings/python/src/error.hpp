// SPDX-License-Identifier: Apache-2.0
// reflectree::Error as the exception reflectree.Error, with what, where and how.
#pragma once

#include <nanobind/nanobind.h>

#include "reflectree/error.hpp"

namespace reflectree::python {

inline void translate_errors() {
  nanobind::register_exception_translator(
      [](const std::exception_ptr& thrown, void*) {
        try {
          std::rethrow_exception(thrown);
        } catch (const Error& e) {
          const nanobind::object type = nanobind::module_::import_("reflectree._error").attr("Error");
          const nanobind::object error = type(e.wrong().c_str(), e.where().c_str(), e.how().c_str());
          PyErr_SetObject(type.ptr(), error.ptr());
        }
      },
      nullptr);
}

}  // namespace reflectree::python
