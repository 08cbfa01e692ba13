// SPDX-License-Identifier: Apache-2.0
#include "targets.hpp"

#include "../formats/examples.hpp"
#include "../formats/synthetic_sampler.hpp"
#include "expect.hpp"
#include "reflectree/brdf/material/material.hpp"
#include "reflectree/brdf/material/registry.hpp"
#include "reflectree/formats/checksum.hpp"
#include "reflectree/formats/format_table.hpp"
#include "reflectree/formats/material_file.hpp"
#include "reflectree/formats/merl.hpp"
#include "reflectree/formats/parameter_table.hpp"
#include "reflectree/formats/rgl.hpp"
#include "reflectree/formats/sampler_file.hpp"
#include "reflectree/sampler/sampler.hpp"

namespace reflectree::fuzz {
namespace {

void require_sound(const AnyBrdf& f) {
  const Direction up{0, 0, 1}, tilted{0.6f, 0, 0.8f}, mirror{-0.6f, 0, 0.8f}, aside{0, 0.96f, 0.28f},
      grazing{0.99999995f, 0, 1.7453292e-5f};
  const Direction wo[] = {up, tilted, tilted, aside, grazing, grazing, mirror, grazing};
  const Direction wi[] = {up, mirror, aside, tilted, tilted, grazing, grazing, mirror};
  std::vector<float> values(std::size(wo) * std::size_t(f.channels()));
  f.eval(wo, wi, values);
  for (const float v : values) require(v >= 0 && std::isfinite(v));
}

void run_rgl(ByteView bytes) {
  expect_error_or_success([&] { require_sound(read_rgl(bytes, "rgl")); });
  for (const char* member : {"", "rgb"})
    expect_error_or_success([&] { require_sound(read_brdf(bytes, "rgl", member)); });
}

// The header as it comes; behind a good one, for one input in 64, the rest repeated up to the length that the
// format wants: 35 or 70 MB, which takes a second.
void run_merl(ByteView bytes) {
  expect_error_or_success([&] { read_merl(bytes, "merl"); });
  std::uint32_t hash = 0;
  for (const std::uint8_t byte : bytes) hash = hash * 31 + byte;
  if (!is_merl_file(bytes) || bytes.size() < 20 || (hash >> 8U) % 64 != 0) return;
  const ByteView header = bytes.first(12), body = bytes.subspan(12);
  Bytes whole(header.begin(), header.end());
  const std::size_t size = 12 + std::size_t(90 * 90 * 24) * (bytes[8] == 180 ? 180U : 360U);
  while (whole.size() + body.size() < size) whole.insert(whole.end(), body.begin(), body.end());
  whole.resize(size);
  expect_error_or_success([&] {
    HalfAngleTable table = read_merl(whole, "merl");
    require_sound(table);
    table.lookup = TableLookup::linear;
    require_sound(table);
  });
}

void run_zemax(ByteView bytes) {
  for (const char* member : {"", "zeros", "rgb-zeros", "y"})
    expect_error_or_success([&] { require_sound(read_brdf(bytes, "zemax", member)); });
  expect_error_or_success([&] { measured_facts(bytes, "zemax"); });
}

void run_klems(ByteView bytes) {
  for (const char* member : {"", "back", "solar-front"})
    expect_error_or_success([&] { require_sound(read_brdf(bytes, "klems", member)); });
  expect_error_or_success([&] { measured_facts(bytes, "klems"); });
}

void run_table(ByteView bytes) {
  expect_error_or_success([&] {
    const ParameterTable table = read_parameter_table(bytes, "table");
    for (const ParameterTable::Row& row : table.rows) require(row.values.size() == table.columns.size());
  });
  for (const char* member : {"", "one", "varnish"}) {
    expect_error_or_success([&] { require_sound(read_brdf(bytes, "table", member)); });
  }
}

void run_material(ByteView bytes) {
  for (const char* member : {"", "two", "linear"}) {
    expect_error_or_success([&] { require_sound(read_brdf(bytes, "file", member)); });
  }
  if (const MaterialFormat* format = find_format(bytes); format && format->list_members) {
    expect_error_or_success([&] { format->list_members(bytes, "file"); });
  }
}

// Any text; what can be parsed prints and parses back to itself, and is a sound BRDF if it is one at all.
void run_grammar(ByteView bytes) {
  const std::string text(bytes.begin(), bytes.end());
  expect_error_or_success([&] {
    const Material material = parse_material(text);
    const std::string canonical = to_text(material);
    const Material again = parse_material(canonical);
    require(again == material && to_text(again) == canonical);
    for (const MaterialTerm& term : material.terms) {
      if (term.model.rfind("baked_", 0) == 0) return;  // takes too long for a fuzzer
    }
    const AnyBrdf f = make_brdf(material);
    require(f.channels() >= 1 && f.channels() <= max_channels);
  });
}

// Behind a right checksum, or nothing past it would ever be reached. What is accepted can be written and
// sampled from.
void run_sampler(ByteView bytes) {
  Bytes mended(bytes.begin(), bytes.end());
  if (mended.size() >= 4) {
    mended.resize(mended.size() - 4);
    append_u32(mended, crc32(mended));
  }
  expect_error_or_success([&] {
    const SamplerData data = decode_sampler(mended, "sampler");
    require(decode_sampler(encode_sampler(data), "again") == data);
    const auto packed = std::make_shared<const PackedSampler>(pack(data));
    const auto f = [](Direction, Direction) { return 0.3f; };
    const ExactSampler exact(f, packed);
    const OneShotSampler one_shot(f, packed);
    Pcg32 u(1);
    for (int i = 0; i < 20; ++i) {
      const Direction wo = direction_from_angles(0.08f * float(i), float(i));
      exact.sample(wo, u);
      one_shot.sample(wo, u);
      one_shot.sample(wo, 0.3, 0.9);
      one_shot.pdf(wo, Direction{0, 0.6f, 0.8f});
    }
  });
}

std::vector<Bytes> rgl_seeds() { return example_files("rgl"); }
std::vector<Bytes> merl_seeds() { return example_files("merl"); }
std::vector<Bytes> zemax_seeds() { return example_files("zemax"); }
std::vector<Bytes> klems_seeds() { return example_files("klems"); }
std::vector<Bytes> table_seeds() { return example_files("table"); }
std::vector<Bytes> material_seeds() {  // of every format of the table
  std::vector<Bytes> seeds;
  for (const MaterialFormat& format : material_formats()) {
    for (Bytes& seed : example_files(format.key)) seeds.push_back(std::move(seed));
  }
  return seeds;
}
std::vector<Bytes> sampler_seeds() {
  SamplerData half = synthetic::sampler_data();
  half.domain = {DomainKind::half_vector, Symmetry::mirror, 0};
  return {encode_sampler(synthetic::sampler_data()), encode_sampler(half)};
}
std::vector<Bytes> grammar_seeds() {
  std::vector<Bytes> seeds{
      synthetic::as_bytes("0.3*lambert:rho=0.5 + ggx:alpha=0.1,f0=1/0.8/0.3"),
      synthetic::as_bytes("dir/file.csv#member + \"a \\\"b\\\\\"#\"c d\" + 1e-3*x.bsdf")};
  for (const ModelInfo& model : models()) seeds.push_back(synthetic::as_bytes(std::string(model.name)));
  return seeds;
}

}  // namespace

std::span<const Target> targets() {
  static const Target all[] = {{"rgl", run_rgl, rgl_seeds},
                               {"merl", run_merl, merl_seeds},
                               {"zemax", run_zemax, zemax_seeds},
                               {"klems", run_klems, klems_seeds},
                               {"table", run_table, table_seeds},
                               {"material", run_material, material_seeds},
                               {"sampler", run_sampler, sampler_seeds},
                               {"grammar", run_grammar, grammar_seeds}};
  return all;
}

}  // namespace reflectree::fuzz
