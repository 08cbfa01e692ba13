// SPDX-License-Identifier: Apache-2.0
#include "python_brdf.hpp"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "arrays.hpp"

namespace reflectree::python {

namespace {

std::string shape_text(const Input& array) {
  std::string text = "(";
  for (std::size_t k = 0; k < array.ndim(); ++k)
    text += std::to_string(array.shape(k)) + (k + 1 < array.ndim() ? ", " : array.ndim() == 1 ? "," : "");
  return text + ")";
}

[[noreturn]] void refuse_shape(const Input& values, std::size_t n, const std::string& name,
                               const std::string& wanted) {
  throw Error("it returned the shape " + shape_text(values) + " for n = " + std::to_string(n) +
                  " pairs of directions",
              name, "return the shape " + wanted + ", one value per pair");
}

std::string pair_text(Direction wo, Direction wi) {
  char text[160];
  std::snprintf(text, sizeof text, "wo = (%.9g, %.9g, %.9g), wi = (%.9g, %.9g, %.9g)", double(wo.x),
                double(wo.y), double(wo.z), double(wi.x), double(wi.y), double(wi.z));
  return text;
}

// An array of shape (n, 3) that Python owns, each coordinate of one piece: columns are quick.
nb::object directions_array(const nb::module_& numpy, std::span<const Direction> w, bool double_precision) {
  nb::object rows =
      numpy.attr("empty")(nb::make_tuple(3, w.size()), double_precision ? "float64" : "float32");
  const auto fill = [&]<class T>(T) {
    const auto array = nb::cast<nb::ndarray<T, nb::shape<3, -1>, nb::c_contig, nb::device::cpu>>(rows);
    T *x = array.data(), *y = x + w.size(), *z = y + w.size();
    for (std::size_t i = 0; i < w.size(); ++i) x[i] = T(w[i].x), y[i] = T(w[i].y), z[i] = T(w[i].z);
  };
  double_precision ? fill(double()) : fill(float());
  return rows.attr("T");
}

// The values of one parameter, likewise.
nb::object parameter_array(const nb::module_& numpy, std::span<const Parameters> at, std::size_t parameter,
                           bool double_precision) {
  nb::object values = numpy.attr("empty")(at.size(), double_precision ? "float64" : "float32");
  const auto fill = [&]<class T>(T) {
    const auto array = nb::cast<nb::ndarray<T, nb::shape<-1>, nb::c_contig, nb::device::cpu>>(values);
    for (std::size_t i = 0; i < at.size(); ++i) array.data()[i] = T(at[i][parameter]);
  };
  double_precision ? fill(double()) : fill(float());
  return values;
}

}  // namespace

FunctionOwner::FunctionOwner(const nb::object& function) : place_(std::make_shared<FunctionPlace>()) {
  place_->function = function.ptr(), place_->owners = 1;
  Py_INCREF(place_->function);
}

FunctionOwner::FunctionOwner(const FunctionOwner& other) : place_(other.place_) {
  if (!place_) return;
  ++place_->owners;
  Py_INCREF(place_->function);
}

int FunctionOwner::traverse(visitproc visit, void* arg) const {
  if (place_) Py_VISIT(place_->function);
  return 0;
}

void FunctionOwner::clear() {
  const std::shared_ptr<FunctionPlace> place = std::move(place_);
  place_ = nullptr;
  if (!place) return;
  PyObject* function = place->function;
  if (--place->owners == 0) place->function = nullptr;
  Py_DECREF(function);
}

PythonBrdf::PythonBrdf(std::shared_ptr<FunctionPlace> f, std::string name, bool double_precision,
                       std::vector<ParameterRange> ranges)
    : f_(std::move(f)),
      name_(std::move(name)),
      double_precision_(double_precision),
      ranges_(std::move(ranges)) {
  if (!PyCallable_Check(f_->function))
    throw Error("it cannot be called", name_, "give a function f(wo, wi), a material's text or an rt.Brdf");
  if (!ranges_.empty()) check_ranges(ranges_, name_);
  // As many pairs as nobody has channels, so that axes cannot be taken for each other.
  constexpr std::size_t pairs = 1021;
  std::vector<Direction> wo, wi;
  std::vector<Parameters> at;
  for (std::size_t i = 0; i < pairs; ++i) {
    wo.push_back(direction_from_angles(0.3f + 1e-3f * float(i), 0.1f));
    wi.push_back(direction_from_angles(0.2f + 1e-3f * float(i), 3.f + 0.01f * float(i)));
    if (ranges_.empty()) continue;
    at.emplace_back();
    for (std::size_t k = 0; k < ranges_.size(); ++k)
      at[i][k] = linear_mix(float(i) / float(pairs - 1), ranges_[k].lo, ranges_[k].hi);
  }
  const Pairs all{wo, wi, at};
  const nb::object answer = ask(all);
  const auto values = nb::cast<Input>(answer);
  if ((values.ndim() != 1 && values.ndim() != 2) || values.shape(0) != pairs)
    refuse_shape(values, pairs, name_, "(n,) or (n, channels)");
  has_channel_axis_ = values.ndim() == 2;
  const std::size_t channels = has_channel_axis_ ? values.shape(1) : 1;
  if (channels < 1 || channels > std::size_t(max_channels)) {
    throw Error("it returned " + std::to_string(channels) + " channels", name_,
                "return 1 to " + std::to_string(max_channels));
  }
  channels_ = int(channels);
  std::vector<float> checked(pairs * channels);
  take(answer, all, checked);
}

nb::object PythonBrdf::ask(const Pairs& pairs) const {
  const nb::module_ numpy = nb::module_::import_("numpy");
  ++calls_->count, calls_->directions += pairs.wo.size();
  if (!f_->function) throw Error("the function is gone", name_, "keep the object that holds it");
  const auto f = nb::borrow<nb::object>(f_->function);
  nb::kwargs parameters = nb::steal<nb::kwargs>(nb::dict().release());
  for (std::size_t k = 0; k < ranges_.size(); ++k)
    parameters[ranges_[k].name.c_str()] = parameter_array(numpy, pairs.at, k, double_precision_);
  const nb::object returned = f(directions_array(numpy, pairs.wo, double_precision_),
                                directions_array(numpy, pairs.wi, double_precision_), **parameters);
  nb::object array = numpy.attr("asarray")(returned);
  const auto kind = nb::cast<std::string>(array.attr("dtype").attr("kind"));
  const auto bytes = nb::cast<int>(array.attr("itemsize"));
  // What numpy.ma masks is no value, and its data there is anything.
  if (kind != "O" && nb::hasattr(returned, "filled"))
    return returned.attr("astype")("float64").attr("filled")(NAN);
  if (kind == "f" && (bytes == 4 || bytes == 8) && nb::cast<bool>(array.attr("dtype").attr("isnative")))
    return array;
  if (kind == "f" || kind == "i" || kind == "u" || kind == "b") return array.attr("astype")("float64");
  throw Error("it returned a " + nb::cast<std::string>(nb::handle(returned.type()).attr("__name__")) +
                  " instead of an array of numbers",
              name_, "return an array of shape (n,) or (n, channels)");
}

void PythonBrdf::take(const nb::object& answer, const Pairs& pairs, std::span<float> out) const {
  const std::size_t n = pairs.wo.size(), channels = std::size_t(channels_);
  const auto values = nb::cast<Input>(answer);
  if (values.ndim() != (has_channel_axis_ ? 2 : 1) || values.shape(0) != n ||
      (has_channel_axis_ && values.shape(1) != channels)) {
    refuse_shape(values, n, name_, has_channel_axis_ ? "(n, " + std::to_string(channels) + ")" : "(n,)");
  }
  std::vector<double> numbers(n * channels);
  Rows(values, has_channel_axis_ ? channels : 0, name_).read(0, numbers);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    out[k] = float(numbers[k]);
    if (out[k] >= 0 && std::isfinite(out[k])) continue;
    char number[48];
    std::snprintf(number, sizeof number, "it returned %.9g", numbers[k]);
    const std::size_t i = k / channels;
    throw Error(number,
                name_ + " at " + pair_text(pairs.wo[i], pairs.wi[i]) +
                    (ranges_.empty() ? "" : ", " + to_text(ranges_, pairs.at[i])),
                "return finite values that are not negative, in sr^-1");
  }
}

void PythonBrdf::eval(std::span<const Direction> wo, std::span<const Direction> wi,
                      std::span<float> out) const {
  eval(wo, wi, {}, out);
}

void PythonBrdf::eval(std::span<const Direction> wo, std::span<const Direction> wi,
                      std::span<const Parameters> at, std::span<float> out) const {
  const auto channels = std::size_t(channels_);
  std::vector<Direction> asked_wo, asked_wi;
  std::vector<Parameters> asked_at;
  std::vector<std::size_t> place;
  std::vector<float> values;
  for (std::size_t begin = 0; begin < wo.size(); begin += python_batch) {
    const std::size_t end = std::min(wo.size(), begin + python_batch);
    asked_wo.clear(), asked_wi.clear(), asked_at.clear(), place.clear();
    for (std::size_t i = begin; i < end; ++i) {
      std::fill_n(out.begin() + std::ptrdiff_t(i * channels), channels, 0.f);
      if (!(wo[i].z > 0 && wi[i].z > 0)) continue;
      asked_wo.push_back(wo[i]), asked_wi.push_back(wi[i]), place.push_back(i);
      if (!at.empty()) asked_at.push_back(at[i]);
    }
    if (place.empty()) continue;
    values.resize(place.size() * channels);
    {
      const nb::gil_scoped_acquire gil;
      const Pairs asked{asked_wo, asked_wi, asked_at};
      take(ask(asked), asked, values);
    }
    for (std::size_t k = 0; k < place.size(); ++k)
      std::copy_n(values.begin() + std::ptrdiff_t(k * channels), channels,
                  out.begin() + std::ptrdiff_t(place[k] * channels));
  }
}

namespace {

// eval(wo, wi) with the directions of geometries.
template <class Eval>
void with_directions(std::span<const ShadingGeometry<float>> geometry, const Eval& eval) {
  std::vector<Direction> wo(geometry.size()), wi(geometry.size());
  for (std::size_t i = 0; i < geometry.size(); ++i) wo[i] = geometry[i].wo, wi[i] = geometry[i].wi;
  eval(wo, wi);
}

}  // namespace

void PythonBrdf::eval(std::span<const ShadingGeometry<float>> geometry, std::span<float> out) const {
  with_directions(geometry, [&](const auto& wo, const auto& wi) { eval(wo, wi, out); });
}

void PythonFamily::eval(std::span<const ShadingGeometry<float>> geometry, std::span<const Parameters> at,
                        std::span<float> out) const {
  with_directions(geometry, [&](const auto& wo, const auto& wi) { f_.eval(wo, wi, at, out); });
}

Spectrum PythonFamily::operator()(const ShadingGeometry<float>& g, const Parameters& at) const {
  Spectrum value(f_.traits().channels);
  eval({&g, 1}, {&at, 1}, {value.data(), std::size_t(value.channels())});
  return value;
}

Spectrum PythonBrdf::operator()(Direction wo, Direction wi) const {
  Spectrum value(channels_);
  eval({&wo, 1}, {&wi, 1}, {value.data(), std::size_t(channels_)});
  return value;
}

BrdfTraits PythonBrdf::traits() const {
  BrdfTraits traits;  // the default name: identity is then judged channel by channel
  traits.channels = channels_;
  traits.concurrent = false;
  return traits;
}

}  // namespace reflectree::python
