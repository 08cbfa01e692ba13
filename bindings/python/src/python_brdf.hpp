// SPDX-License-Identifier: Apache-2.0
// A function of Python as a BRDF, f(wo, wi) -> (n,) or (n, channels), called with arrays of its own; or, with
// an array of shape (n,) more for each parameter, by its name, as a family.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "reflectree/brdf/family.hpp"

namespace reflectree::python {

namespace nb = nanobind;

// Calls with so many directions at most.
inline constexpr std::size_t python_batch = 65536;

// The garbage collector of Python must see who refers to a function: objects of Python own it, each for
// itself, and what lies deeper borrows it from this place, which is empty once nobody owns it.
struct FunctionPlace {
  PyObject* function = nullptr;
  std::size_t owners = 0;
};
class FunctionOwner {  // all under the GIL
 public:
  FunctionOwner() = default;
  explicit FunctionOwner(const nb::object& function);
  FunctionOwner(const FunctionOwner& other);
  FunctionOwner& operator=(const FunctionOwner&) = delete;
  ~FunctionOwner() { clear(); }
  const std::shared_ptr<FunctionPlace>& place() const { return place_; }
  int traverse(visitproc visit, void* arg) const;
  void clear();

 private:
  std::shared_ptr<FunctionPlace> place_;
};

class PythonBrdf {
 public:
  // Borrows the function. `name`: in errors. double_precision: the type of the arrays that f is given.
  // ranges: of its parameters, where it is a family's. Holding the GIL; calls f once to learn its channels.
  // Throws Error, and what f raises.
  PythonBrdf(std::shared_ptr<FunctionPlace> f, std::string name, bool double_precision,
             std::vector<ParameterRange> ranges = {});

  // With or without the GIL. Throws Error for what is no BRDF, nb::python_error for what f raises.
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<float> out) const;
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const;
  // Of a family; at: the parameters of each pair.
  void eval(std::span<const Direction> wo, std::span<const Direction> wi, std::span<const Parameters> at,
            std::span<float> out) const;
  Spectrum operator()(Direction wo, Direction wi) const;
  BrdfTraits traits() const;

  // Whether it returns (n, channels) rather than (n,).
  bool has_channel_axis() const { return has_channel_axis_; }
  // How often f was called, and for how many pairs of directions.
  struct Calls {
    std::size_t count = 0, directions = 0;
  };
  Calls calls() const { return *calls_; }

 private:
  // Pairs of directions, and of a family the parameters of each.
  struct Pairs {
    std::span<const Direction> wo, wi;
    std::span<const Parameters> at;
  };
  // What f returns, as an array of floats of any shape; and its values, checked. Both under the GIL.
  nb::object ask(const Pairs& pairs) const;
  void take(const nb::object& answer, const Pairs& pairs, std::span<float> out) const;

  std::shared_ptr<FunctionPlace> f_;
  std::shared_ptr<Calls> calls_ = std::make_shared<Calls>();
  std::string name_;
  bool double_precision_, has_channel_axis_ = false;
  int channels_ = 0;
  std::vector<ParameterRange> ranges_;
};

// A PythonBrdf with ranges as a family's function (family.hpp).
class PythonFamily {
 public:
  explicit PythonFamily(PythonBrdf f) : f_(std::move(f)) {}
  void eval(std::span<const ShadingGeometry<float>> geometry, std::span<const Parameters> at,
            std::span<float> out) const;
  Spectrum operator()(const ShadingGeometry<float>& g, const Parameters& at) const;
  BrdfTraits traits(const Parameters&) const { return f_.traits(); }

 private:
  PythonBrdf f_;
};

}  // namespace reflectree::python
