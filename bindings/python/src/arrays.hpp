// SPDX-License-Identifier: Apache-2.0
// Rows of foreign arrays, read and written where they lie: any strides, float32 or float64.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "reflectree/error.hpp"
#include "reflectree/math/direction.hpp"

namespace reflectree::python {

namespace nb = nanobind;

using Input = nb::ndarray<nb::ro, nb::device::cpu>;
using Output = nb::ndarray<nb::device::cpu>;

// Of an array of shape (..., width), or (...) for width 0. The array must outlive it.
class Rows {
 public:
  template <class Array>
  Rows(const Array& array, std::size_t width, std::string name)
      : Rows(const_cast<void*>(static_cast<const void*>(array.data())), array.ndim(), array.shape_ptr(),
             array.stride_ptr(), array.dtype(), width, std::move(name)) {}

  std::size_t size() const { return size_; }
  const std::string& name() const { return name_; }
  // Of row i as Python indexes it: "wo[2, 5]"; "wo" where there is but one.
  std::string place(std::size_t i) const;

  // visit(x, y, z) for rows of three numbers; in arrays.cpp alone.
  template <class Visit>
  void each_triple(std::size_t first, std::size_t count, const Visit& visit) const;
  // Rows [first, first + out.size() / width), one after the other.
  void read(std::size_t first, std::span<double> out) const;
  void write(std::size_t first, std::span<const float> values) const;
  void write(std::size_t first, std::span<const std::uint8_t> truths) const;

 private:
  Rows(void* data, std::size_t ndim, const std::int64_t* shape, const std::int64_t* strides,
       nb::dlpack::dtype dtype, std::size_t width, std::string name);
  template <class Work>
  void specialised(const Work& work) const;
  template <class Visit>
  void each(std::size_t first, std::size_t count, const Visit& visit) const;

  std::byte* data_;
  std::vector<std::size_t> shape_;      // of the rows, as the caller sees it
  std::vector<std::size_t> extent_;     // the same, axes merged where strides allow
  std::vector<std::ptrdiff_t> stride_;  // bytes
  std::size_t width_, size_ = 1;
  std::ptrdiff_t inner_ = 0;  // bytes between the numbers of a row
  nb::dlpack::dtype dtype_;
  std::string name_;
};

// Directions of rows [first, first + out.size()). Throws Error for what is not finite or not of unit length.
void read_directions(const Rows& rows, std::size_t first, std::span<Direction> out);
// Pairs in [0, 1].
void read_points(const Rows& rows, std::size_t first, std::span<Vec2<double>> out);

}  // namespace reflectree::python
