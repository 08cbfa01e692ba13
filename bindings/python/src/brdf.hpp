// SPDX-License-Identifier: Apache-2.0
// What Python calls a Brdf: a material, a file, or a function of its own.
#pragma once

#include <optional>

#include "arrays.hpp"
#include "python_brdf.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/simd/lane_function.hpp"

namespace reflectree::python {

struct PyBrdf {
  AnyBrdf f;
  std::optional<PythonBrdf> function = std::nullopt;  // where it is one of Python
  FunctionOwner owner = {};
  std::shared_ptr<const LaneFunction> lanes = nullptr;  // where it is one model
  Material material = {};                               // where it is made of its text

  // Directions per call, and per piece of a long call. A function of Python wants few calls.
  std::size_t batch() const { return function ? python_batch : 512; }
  std::size_t piece() const { return function ? 4 * python_batch : 1024; }
};

// Tells the garbage collector what an object of type T refers to; owner_of(T&).
template <class T, FunctionOwner& (*owner_of)(T&)>
struct Collected {
  static int traverse(PyObject* self, visitproc visit, void* arg) {
#if PY_VERSION_HEX >= 0x03090000
    Py_VISIT(Py_TYPE(self));
#endif
    return nb::inst_ready(self) ? owner_of(*nb::inst_ptr<T>(self)).traverse(visit, arg) : 0;
  }
  static int clear(PyObject* self) {
    if (nb::inst_ready(self)) owner_of(*nb::inst_ptr<T>(self)).clear();
    return 0;
  }
  static inline PyType_Slot slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&traverse)},
                                       {Py_tp_clear, reinterpret_cast<void*>(&clear)},
                                       {0, nullptr}};
};

// Runs work(first, count) over pieces of [0, n) without the GIL; Ctrl-C ends it between two.
template <class Work>
void in_pieces(std::size_t n, std::size_t piece, const Work& work) {
  for (std::size_t first = 0; first < n; first += piece) {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    const std::size_t most = std::max<std::size_t>(piece, std::size_t(1) << 20U);
    const std::size_t end = std::min(n, first + most / piece * piece);
    const nb::gil_scoped_release no_gil;
    for (; first + piece < end; first += piece) work(first, piece);
    work(first, std::min(piece, end - first));
  }
}

void bind_brdf(nb::module_& m);
void bind_sampler(nb::module_& m);
void bind_family(nb::module_& m);

}  // namespace reflectree::python
