// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <type_traits>

#include "reflectree/sampler/known/incidence.hpp"

namespace reflectree::python {

namespace {

constexpr auto float_code = std::uint8_t(nb::dlpack::dtype_code::Float);
constexpr auto bool_code = std::uint8_t(nb::dlpack::dtype_code::Bool);

bool is_float(nb::dlpack::dtype dtype, int bits) {
  return dtype.code == float_code && dtype.bits == bits && dtype.lanes == 1;
}

// Arrays may lie at any address.
template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
template <class T>
void store(std::byte* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

std::string text_of(std::span<const double> numbers) {
  std::string text = "(";
  for (const double x : numbers) {
    char word[32];
    std::snprintf(word, sizeof word, "%s%.9g", text.size() > 1 ? ", " : "", x);
    text += word;
  }
  return text + ")";
}

}  // namespace

Rows::Rows(void* data, std::size_t ndim, const std::int64_t* shape, const std::int64_t* strides,
           nb::dlpack::dtype dtype, std::size_t width, std::string name)
    : data_(static_cast<std::byte*>(data)),
      width_(std::max<std::size_t>(width, 1)),
      dtype_(dtype),
      name_(std::move(name)) {
  const bool boolean = dtype.code == bool_code && dtype.bits == 8;
  if (!is_float(dtype, 32) && !is_float(dtype, 64) && !boolean) {
    throw Error("an array of another type", name_, "make it float32 or float64 (valid: bool)");
  }
  const std::ptrdiff_t bytes = dtype.bits / 8;
  if (width > 0) {
    if (ndim == 0 || std::size_t(shape[ndim - 1]) != width) {
      throw Error("its last axis must have " + std::to_string(width) + " numbers", name_,
                  "give it the shape (..., " + std::to_string(width) + ")");
    }
    inner_ = std::ptrdiff_t(strides[--ndim]) * bytes;
  }
  for (std::size_t axis = 0; axis < ndim; ++axis) {
    const auto extent = std::size_t(shape[axis]);
    const std::ptrdiff_t stride = std::ptrdiff_t(strides[axis]) * bytes;
    shape_.push_back(extent);
    size_ *= extent;
    if (extent == 1) continue;
    if (!extent_.empty() && stride_.back() == stride * std::ptrdiff_t(extent)) {
      extent_.back() *= extent, stride_.back() = stride;
    } else {
      extent_.push_back(extent), stride_.push_back(stride);
    }
  }
  if (extent_.empty()) extent_.push_back(size_), stride_.push_back(0);
}

std::string Rows::place(std::size_t i) const {
  if (shape_.empty()) return name_;
  std::string text = "]";
  for (std::size_t axis = shape_.size(); axis-- > 0;) {
    text = (axis > 0 ? ", " : "") + std::to_string(i % shape_[axis]) + text;
    i /= shape_[axis];
  }
  return name_ + "[" + text;
}

// visit(place of the row) for rows first, first + 1, ...: the last axis runs, the others are counted on.
template <class Visit>
void Rows::each(std::size_t first, std::size_t count, const Visit& visit) const {
  const std::size_t last = extent_.size() - 1;
  std::vector<std::size_t> index(extent_.size());
  for (std::size_t axis = extent_.size(), rest = first; axis-- > 0; rest /= extent_[axis])
    index[axis] = extent_[axis] ? rest % extent_[axis] : 0;
  while (count > 0) {
    std::byte* at = data_;
    for (std::size_t axis = 0; axis <= last; ++axis) at += std::ptrdiff_t(index[axis]) * stride_[axis];
    const std::size_t run = std::min(count, extent_[last] - index[last]);
    const std::ptrdiff_t stride = stride_[last];
    for (std::size_t k = 0; k < run; ++k, at += stride) visit(at);
    count -= run;
    index[last] = 0;
    for (std::size_t axis = last; axis-- > 0;) {
      if (++index[axis] < extent_[axis]) break;
      index[axis] = 0;
    }
  }
}

// work(T(), width) with the type of the numbers, and with widths that occur often known at compile time.
template <class Work>
void Rows::specialised(const Work& work) const {
  const auto of_width = [&]<class T>(T t) {
    switch (width_) {
      case 1:
        return work(t, std::integral_constant<std::size_t, 1>());
      case 2:
        return work(t, std::integral_constant<std::size_t, 2>());
      case 3:
        return work(t, std::integral_constant<std::size_t, 3>());
      default:
        return work(t, width_);
    }
  };
  is_float(dtype_, 32) ? of_width(float()) : of_width(double());
}

void Rows::read(std::size_t first, std::span<double> out) const {
  specialised([&]<class T>(T, auto width) {
    double* to = out.data();
    each(first, out.size() / width, [&](const std::byte* row) {
      for (std::size_t k = 0; k < width; ++k) to[k] = double(load<T>(row + std::ptrdiff_t(k) * inner_));
      to += width;
    });
  });
}

template <class Visit>
void Rows::each_triple(std::size_t first, std::size_t count, const Visit& visit) const {
  const auto as = [&]<class T>(T) {
    each(first, count, [&](const std::byte* row) {
      visit(double(load<T>(row)), double(load<T>(row + inner_)), double(load<T>(row + 2 * inner_)));
    });
  };
  is_float(dtype_, 32) ? as(float()) : as(double());
}

void Rows::write(std::size_t first, std::span<const float> values) const {
  specialised([&]<class T>(T, auto width) {
    const float* from = values.data();
    each(first, values.size() / width, [&](std::byte* row) {
      for (std::size_t k = 0; k < width; ++k) store(row + std::ptrdiff_t(k) * inner_, T(from[k]));
      from += width;
    });
  });
}

void Rows::write(std::size_t first, std::span<const std::uint8_t> truths) const {
  const std::uint8_t* from = truths.data();
  each(first, truths.size(), [&](std::byte* row) { store(row, *from++); });
}

void read_directions(const Rows& rows, std::size_t first, std::span<Direction> out) {
  Direction* to = out.data();
  rows.each_triple(first, out.size(), [&](double x, double y, double z) {
    const double squared = x * x + y * y + z * z;
    if (!(std::abs(squared - 1) <= double(unit_length_tolerance))) {
      const double w[] = {x, y, z};
      const bool finite = std::isfinite(squared);
      throw Error(text_of(w) + (finite ? " is not of unit length" : " is no direction"),
                  rows.place(first + std::size_t(to - out.data())),
                  finite ? "divide it by its length" : "leave such rows out");
    }
    *to++ = {float(x), float(y), float(z)};
  });
}

void read_points(const Rows& rows, std::size_t first, std::span<Vec2<double>> out) {
  std::vector<double> numbers(2 * out.size());
  rows.read(first, numbers);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double* u = &numbers[2 * i];
    if (!(u[0] >= 0 && u[0] <= 1 && u[1] >= 0 && u[1] <= 1)) {
      throw Error(text_of({u, 2}) + " is not in the unit square", rows.place(first + i),
                  "give uniforms in [0, 1)");
    }
    out[i] = {u[0], u[1]};
  }
}

}  // namespace reflectree::python
