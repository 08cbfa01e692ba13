// SPDX-License-Identifier: Apache-2.0
// Where many samples go: Python's arrays, and the buffers through which they are written.
#pragma once

#include "arrays.hpp"
#include "reflectree/simd/sample_rounds.hpp"

namespace reflectree::python {

class SampleOutput {
 public:
  // weight_width: of a row of `weight`, 0 where values have no axis of channels
  SampleOutput(int channels, std::size_t weight_width, const Output& wi, const Output& pdf,
               const Output& weight, const Output& valid)
      : channels_(std::size_t(channels)),
        wi_(wi, 3, "out.wi"),
        pdf_(pdf, 0, "out.pdf"),
        weight_(weight, weight_width, "out.weight"),
        valid_(valid, 0, "out.valid") {
    for (const Rows* rows : {&pdf_, &weight_, &valid_}) {
      if (rows->size() != wi_.size())
        throw Error("it has " + std::to_string(rows->size()) + " places where out.wi has " +
                        std::to_string(wi_.size()),
                    rows->name(), "give all four the same leading shape");
    }
  }
  std::size_t size() const { return wi_.size(); }
  SampleRows buffers(std::size_t count) {
    wi_buffer_.resize(count), pdf_buffer_.resize(count), valid_buffer_.resize(count);
    weight_buffer_.resize(count * channels_);
    return {wi_buffer_, pdf_buffer_, weight_buffer_, valid_buffer_};
  }
  void write(std::size_t first) {
    const auto* numbers = reinterpret_cast<const float*>(wi_buffer_.data());
    static_assert(sizeof(Direction) == 3 * sizeof(float));
    wi_.write(first, std::span<const float>(numbers, 3 * wi_buffer_.size()));
    pdf_.write(first, std::span<const float>(pdf_buffer_));
    weight_.write(first, std::span<const float>(weight_buffer_));
    valid_.write(first, std::span<const std::uint8_t>(valid_buffer_));
  }

 private:
  std::size_t channels_;
  Rows wi_, pdf_, weight_, valid_;
  std::vector<Direction> wi_buffer_;
  std::vector<float> pdf_buffer_, weight_buffer_;
  std::vector<std::uint8_t> valid_buffer_;
};

}  // namespace reflectree::python
