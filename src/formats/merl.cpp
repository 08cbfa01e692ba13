// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/merl.hpp"

#include <cassert>
#include <cmath>

#include "reflectree/error.hpp"

namespace reflectree {
namespace {

constexpr std::uint64_t header_bytes = 12;
constexpr int n_h = 90, n_d = 90, n_p = 180;
// f = stored value * scale; the planes are red, green, blue.
constexpr double scale[3] = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

std::size_t cell_count(const HalfAngleTable& table) {
  return std::size_t(table.n_h) * std::size_t(table.n_d) * std::size_t(table.n_p);
}

HalfAngleTable empty_table(bool reciprocal) {
  HalfAngleTable table;
  table.n_h = n_h, table.n_d = n_d, table.n_p = reciprocal ? n_p : 2 * n_p;
  table.reciprocal = reciprocal;
  table.rgb.resize(cell_count(table) * 3);
  return table;
}

// The cells of one theta_h.
void tabulate_layer(const AnyBrdf& f, int h, HalfAngleTable& table) {
  const auto channels = std::size_t(f.channels());
  const std::size_t cells = std::size_t(table.n_d) * std::size_t(table.n_p);
  std::vector<Direction> wo, wi;
  for (int d = 0; d < table.n_d; ++d) {
    for (int p = 0; p < table.n_p; ++p) {
      const DirectionPair<float> pair = cell_centre(table, h, d, p);
      wo.push_back(pair.wo);
      wi.push_back(pair.wi);
    }
  }
  std::vector<float> values(cells * channels), swapped(cells * channels);
  f.eval(wo, wi, values);
  if (table.reciprocal) f.eval(wi, wo, swapped);
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t k = i * channels + (channels == 3 ? c : 0);
      table.rgb[(std::size_t(h) * cells + i) * 3 + c] =
          table.reciprocal ? 0.5f * (values[k] + swapped[k]) : values[k];
    }
  }
}

}  // namespace

bool is_merl_file(ByteView bytes) {
  if (bytes.size() < header_bytes) return false;
  ByteReader in(bytes, "");
  const std::uint32_t h = in.u32(), d = in.u32(), p = in.u32();
  return h == n_h && d == n_d && (p == n_p || p == 2 * n_p);
}

HalfAngleTable read_merl(ByteView bytes, const std::string& where, TableLookup lookup) {
  if (!is_merl_file(bytes)) {
    throw Error("not a MERL file of 90 x 90 x 180 or 90 x 90 x 360 cells", where, "name a MERL .binary file");
  }
  ByteReader in(bytes, where);
  in.seek(8);
  HalfAngleTable table = empty_table(in.u32() == n_p);
  const std::size_t cells = cell_count(table);
  if (in.remaining() != cells * 24) {
    throw Error("damaged: " + std::to_string(bytes.size()) + " bytes instead of " +
                    std::to_string(header_bytes + cells * 24),
                where, "fetch the file again");
  }
  table.name = where;
  table.lookup = lookup;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < cells; ++i) {
      float& v = table.rgb[i * 3 + c];
      v = float(in.f64() * scale[c]);
      if (!std::isfinite(v)) {
        throw Error("damaged: entry " + std::to_string(c * cells + i) + " is not finite", where,
                    "fetch the file again");
      }
    }
  }
  return table;
}

HalfAngleTable tabulate_merl(const AnyBrdf& f, bool reciprocal, const Host& host) {
  const BrdfTraits& traits = f.traits();
  const std::string how = "bake an isotropic BRDF of 1 or 3 channels";
  if (!traits.isotropic) throw Error("anisotropic: a MERL file cannot hold it", traits.name, how);
  if (traits.channels != 1 && traits.channels != 3) {
    throw Error(std::to_string(traits.channels) + " channels: a MERL file holds 3", traits.name, how);
  }
  HalfAngleTable table = empty_table(reciprocal);
  table.name = traits.name;
  constexpr int layers = 6;  // between two looks at the host
  for (int first = 0; first < table.n_h; first += layers) {
    if (host.cancelled()) throw Cancelled();
    const auto body = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) tabulate_layer(f, first + int(i), table);
    };
    if (traits.concurrent) {
      host.parallel_for(layers, body);
    } else {
      body(0, layers);
    }
    host.progress(float(first + layers) / float(table.n_h));
  }
  for (const float v : table.rgb) {
    if (!(v >= 0 && std::isfinite(v))) {
      throw Error("negative or not finite in a cell", traits.name, "mend the BRDF before baking it");
    }
  }
  return table;
}

Bytes write_merl(const HalfAngleTable& table) {
  const std::size_t cells = cell_count(table);
  assert(table.n_h == n_h && table.n_d == n_d && table.n_p == (table.reciprocal ? n_p : 2 * n_p));
  Bytes out;
  out.reserve(header_bytes + cells * 24);
  for (const int n : {table.n_h, table.n_d, table.n_p}) append_u32(out, std::uint32_t(n));
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < cells; ++i) append_f64(out, double(table.rgb[i * 3 + c]) / scale[c]);
  }
  return out;
}

}  // namespace reflectree
