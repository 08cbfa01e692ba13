// SPDX-License-Identifier: Apache-2.0
#include "reflectree/formats/sampler_file.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "reflectree/error.hpp"
#include "reflectree/formats/checksum.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/file_kind.hpp"

namespace reflectree {

namespace {

// As PNG's: a byte that is no text, and line ends that a transfer as text would spoil.
constexpr std::string_view magic = "\x89RFL\r\n\x1a\n";
constexpr std::uint16_t optional_flag = 1;
constexpr const char* fetch_again = "fetch the file again, or build the sampler again";

// --- writing ---

void append_u8(Bytes& out, std::uint8_t v) { out.push_back(v); }
void append_u16(Bytes& out, std::uint16_t v) {
  append_u8(out, std::uint8_t(v)), append_u8(out, std::uint8_t(v >> 8U));
}

void append_words(Bytes& out, const std::string& text) {
  append_u32(out, std::uint32_t(text.size()));
  append_text(out, text);
}

void append_floats(Bytes& out, std::span<const float> values) {
  append_u32(out, std::uint32_t(values.size()));
  for (const float v : values) append_f32(out, v);
}

void append_partition(Bytes& out, const Partition& partition) {
  append_u32(out, std::uint32_t(partition.coordinates.size()));
  for (const KnownCoordinate& c : partition.coordinates) {
    append_words(out, c.name), append_f32(out, c.lo), append_f32(out, c.hi);
  }
  append_u32(out, std::uint32_t(partition.axis.size()));
  out.insert(out.end(), partition.axis.begin(), partition.axis.end());
  append_floats(out, partition.split);
}

void append_tree(Bytes& out, const CanonicalTree& tree) {
  append_u32(out, std::uint32_t(tree.nodes.size()));
  for (std::size_t i = 0; i < tree.nodes.size(); i += 4) {
    std::uint8_t four = 0;
    for (std::size_t k = i; k < tree.nodes.size() && k < i + 4; ++k) {
      four = std::uint8_t(four | (std::uint8_t(tree.nodes[k]) << (2 * (k - i))));
    }
    append_u8(out, four);
  }
  append_u32(out, std::uint32_t(tree.mass.size()));
  for (const std::uint32_t m : tree.mass) append_u32(out, m);
  for (const std::int8_t s : tree.slope_x) append_u8(out, std::uint8_t(s));
  for (const std::int8_t s : tree.slope_y) append_u8(out, std::uint8_t(s));
}

void append_chunk(Bytes& out, std::string_view tag, const Bytes& payload, std::uint16_t flags = 0) {
  append_text(out, tag);
  append_u16(out, 1);
  append_u16(out, flags);
  append_u64(out, payload.size());
  out.insert(out.end(), payload.begin(), payload.end());
}

// --- reading ---

constexpr std::uint32_t max_slabs = 60000, max_coordinates = 8;

// A length that the rest of the chunk can hold, at `bytes_each` (or more) bytes per item.
std::uint32_t read_count(ByteReader& in, std::uint64_t bytes_each, std::uint32_t limit = 0xffffffffU) {
  const std::uint32_t count = in.u32();
  if (count > limit || count * bytes_each > in.remaining()) {
    throw Error("damaged: a list of " + std::to_string(count) + " items in " +
                    std::to_string(in.remaining()) + " bytes",
                in.where(), fetch_again);
  }
  return count;
}

std::string read_words(ByteReader& in) { return in.text(read_count(in, 1)); }

// Finite, as every float of the format is.
float read_float(ByteReader& in) {
  const float v = in.f32();
  if (!std::isfinite(v)) throw Error("damaged: a number is not finite", in.where(), fetch_again);
  return v;
}

std::vector<float> read_floats(ByteReader& in) {
  std::vector<float> values(read_count(in, 4));
  for (float& v : values) v = read_float(in);
  return values;
}

Partition read_partition(ByteReader& in) {
  Partition partition;
  partition.coordinates.resize(read_count(in, 12, max_coordinates));
  for (KnownCoordinate& c : partition.coordinates) {
    c.name = read_words(in), c.lo = read_float(in), c.hi = read_float(in);
  }
  const ByteView axis = in.take(read_count(in, 1));
  partition.axis.assign(axis.begin(), axis.end());
  partition.split = read_floats(in);
  return partition;
}

void read_tree(ByteReader& in, CanonicalTree& tree) {
  const std::uint32_t nodes = in.u32();
  const ByteView packed = in.take((std::uint64_t(nodes) + 3) / 4);
  tree.nodes.resize(nodes);
  for (std::size_t i = 0; i < nodes; ++i) tree.nodes[i] = TreeSplit((packed[i / 4] >> (2 * (i % 4))) & 3U);
  if (nodes % 4 != 0 && (packed.back() >> (2 * (nodes % 4))) != 0) {
    throw Error("damaged: bits after the last node", in.where(), fetch_again);
  }
  tree.mass.resize(read_count(in, 6));
  for (std::uint32_t& m : tree.mass) m = in.u32();
  for (auto* slopes : {&tree.slope_x, &tree.slope_y}) {
    const ByteView bytes = in.take(tree.mass.size());
    for (const std::uint8_t b : bytes) slopes->push_back(std::int8_t(b));
  }
}

// A value of an enumeration whose last is `last`.
template <class E>
E read_kind(ByteReader& in, E last, const char* what) {
  const std::uint8_t value = in.u8();
  if (value > std::uint8_t(last)) {
    throw Error(std::string("unknown ") + what + " (" + std::to_string(value) + ")", in.where(), fetch_again);
  }
  return E(value);
}

void read_target(ByteReader& in, SamplerData& data) {
  data.target.kind = read_kind(in, TargetKind::channel, "target");
  data.target.index = in.u16();
}

void read_domain(ByteReader& in, SamplerData& data) {
  data.domain.kind = read_kind(in, DomainKind::scaled_star, "domain");
  data.domain.symmetry = read_kind(in, Symmetry::mirror, "symmetry");
  data.domain.exponent = read_float(in);
}

void read_exact(ByteReader& in, SamplerData& data) {
  data.exact.resize(read_count(in, 14, max_slabs));
  for (MajorantTree& tree : data.exact) {
    tree.status = read_kind(in, BoundStatus::estimated, "status of the bounds");
    tree.volume = read_float(in);
    read_tree(in, tree);
  }
}

void read_one_shot(ByteReader& in, SamplerData& data) {
  data.one_shot.resize(read_count(in, 9, max_slabs));
  for (DensityTree& tree : data.one_shot) read_tree(in, tree);
}

void read_albedo(ByteReader& in, SamplerData& data) {
  data.albedo.relative_error = read_float(in);
  data.albedo.cos_theta_o = read_floats(in);
  data.albedo.albedo = read_floats(in);
}

void read_probes(ByteReader& in, SamplerData& data) {
  const std::vector<float> probes = read_floats(in);
  if (probes.size() != BrdfProbes::count) {
    throw Error("damaged: " + std::to_string(probes.size()) + " probes in place of 64", in.where(),
                fetch_again);
  }
  std::copy(probes.begin(), probes.end(), data.probes.target.begin());
}

void read_report(ByteReader& in, SamplerData& data) {
  BuildReport& r = data.report;
  for (float* v : {&r.expected_trials, &r.overshoot_mass, &r.one_shot_variance, &r.asymmetry})
    *v = read_float(in);
  r.evaluations = in.u64();
}

void read_notes(ByteReader& in, SamplerData& data) {
  data.report.notes.resize(read_count(in, 4, 64));
  for (std::string& note : data.report.notes) note = read_words(in);
}

void read_anisotropy(ByteReader& in, SamplerData& data) {
  data.frame.symmetry = read_kind(in, ViewerSymmetry::none, "symmetry of the viewer");
  data.frame.axis = read_float(in);
  data.domain.stretch = read_float(in);
  data.albedo.phi_o = read_floats(in);
  data.albedo.even = is_mirrored(data.frame.symmetry);
}

void read_family(ByteReader& in, SamplerData& data) {
  data.parameters.resize(read_count(in, 21, max_parameters));
  for (KnownParameter& p : data.parameters) {
    p.range.name = read_words(in), p.range.lo = read_float(in), p.range.hi = read_float(in);
    p.logarithmic = in.u8() != 0;
    AlbedoAxis axis;
    axis.lo = read_float(in), axis.hi = read_float(in), axis.rows = in.u32();
    data.albedo.parameters.push_back(axis);
  }
  for (auto* law : {&data.law.x, &data.law.y}) {
    for (float& v : *law) v = read_float(in);
  }
}

void read_widths(ByteReader& in, SamplerData& data) {
  data.domain.scale_x = read_float(in), data.domain.scale_y = read_float(in);
}

// Of every exact tree, in order.
void read_ratios(ByteReader& in, SamplerData& data) {
  const std::vector<float> ratios = read_floats(in);
  if (ratios.size() != data.exact.size()) {
    throw Error("damaged: " + std::to_string(ratios.size()) + " ratios for the " +
                    std::to_string(data.exact.size()) + " trees of chunk EXTR",
                in.where(), fetch_again);
  }
  for (std::size_t s = 0; s < ratios.size(); ++s) data.exact[s].bound_ratio = ratios[s];
}

struct ChunkReader {
  std::string_view tag;
  bool required;
  void (*read)(ByteReader& in, SamplerData& data);
};
constexpr ChunkReader chunk_readers[] = {
    {"MATL", true, [](ByteReader& in, SamplerData& data) { data.material = read_words(in); }},
    {"TARG", true, read_target},
    {"DOMN", true, read_domain},
    {"EXPA", true, [](ByteReader& in, SamplerData& data) { data.exact_partition = read_partition(in); }},
    {"EXTR", true, read_exact},
    {"ONPA", true, [](ByteReader& in, SamplerData& data) { data.one_shot_partition = read_partition(in); }},
    {"ONTR", true, read_one_shot},
    {"ALBD", true, read_albedo},
    {"PROB", true, read_probes},
    {"REPT", false, read_report},
    {"SCAL", false, [](ByteReader& in, SamplerData& data) { data.target.scale = read_float(in); }},
    {"PRCH", false, [](ByteReader& in, SamplerData& data) { data.probes.channels = read_floats(in); }},
    {"NOTE", false, read_notes},
    {"ANIS", false, read_anisotropy},
    {"FMLY", false, read_family},
    {"WDTH", false, read_widths},
    {"CERT", false, read_ratios},
    {"ALBP", false, [](ByteReader& in, SamplerData& data) { data.albedo.proved_error = read_float(in); }},
};

const ChunkReader* find_reader(std::string_view tag) {
  for (const ChunkReader& reader : chunk_readers) {
    if (reader.tag == tag) return &reader;
  }
  return nullptr;
}

void read_chunks(ByteView body, const std::string& where, SamplerData& data) {
  ByteReader in(body, where);
  std::set<std::string, std::less<>> seen;
  while (in.remaining() > 0) {
    const std::string tag = in.text(4);
    const std::uint16_t version = in.u16(), flags = in.u16();
    ByteReader payload(in.take(in.u64()), where + ", chunk " + tag);
    const ChunkReader* reader = find_reader(tag);
    if (!reader || version != 1) {
      if (flags & optional_flag) continue;
      throw Error("written by a later version (chunk " + tag + ", version " + std::to_string(version) + ")",
                  where, "read it with a newer reflectree, or build the sampler again");
    }
    if (!seen.insert(tag).second) throw Error("damaged: the chunk comes twice", payload.where(), fetch_again);
    reader->read(payload, data);
    if (payload.remaining() > 0) throw Error("damaged: bytes after its end", payload.where(), fetch_again);
  }
  for (const ChunkReader& reader : chunk_readers) {
    if (reader.required && seen.find(reader.tag) == seen.end()) {
      throw Error("damaged: no chunk " + std::string(reader.tag), where, fetch_again);
    }
  }
}

}  // namespace

bool is_sampler_file(ByteView bytes) { return starts_with(bytes, magic); }

Bytes encode_sampler(const SamplerData& data) {
  validate(data);
  Bytes out;
  append_text(out, magic);
  const auto chunk = [&out](std::string_view tag, const auto& fill, std::uint16_t flags = 0) {
    Bytes payload;
    fill(payload);
    append_chunk(out, tag, payload, flags);
  };
  chunk("MATL", [&](Bytes& p) { append_words(p, data.material); });
  chunk("TARG",
        [&](Bytes& p) { append_u8(p, std::uint8_t(data.target.kind)), append_u16(p, data.target.index); });
  chunk("DOMN", [&](Bytes& p) {
    append_u8(p, std::uint8_t(data.domain.kind)), append_u8(p, std::uint8_t(data.domain.symmetry));
    append_f32(p, data.domain.exponent);
  });
  chunk("EXPA", [&](Bytes& p) { append_partition(p, data.exact_partition); });
  chunk("EXTR", [&](Bytes& p) {
    append_u32(p, std::uint32_t(data.exact.size()));
    for (const MajorantTree& tree : data.exact) {
      append_u8(p, std::uint8_t(tree.status)), append_f32(p, tree.volume), append_tree(p, tree);
    }
  });
  chunk("ONPA", [&](Bytes& p) { append_partition(p, data.one_shot_partition); });
  chunk("ONTR", [&](Bytes& p) {
    append_u32(p, std::uint32_t(data.one_shot.size()));
    for (const DensityTree& tree : data.one_shot) append_tree(p, tree);
  });
  chunk("ALBD", [&](Bytes& p) {
    append_f32(p, data.albedo.relative_error);
    append_floats(p, data.albedo.cos_theta_o), append_floats(p, data.albedo.albedo);
  });
  chunk("PROB", [&](Bytes& p) { append_floats(p, data.probes.target); });
  const auto report = [&](Bytes& p) {
    const BuildReport& r = data.report;
    for (const float v : {r.expected_trials, r.overshoot_mass, r.one_shot_variance, r.asymmetry})
      append_f32(p, v);
    append_u64(p, r.evaluations);
  };
  chunk("REPT", report, optional_flag);
  // What most samplers have not: an older reader must not overlook a scale, or the azimuth of the viewer.
  if (!data.frame.isotropic()) {
    chunk("ANIS", [&](Bytes& p) {
      append_u8(p, std::uint8_t(data.frame.symmetry)), append_f32(p, data.frame.axis);
      append_f32(p, data.domain.stretch), append_floats(p, data.albedo.phi_o);
    });
  }
  if (!data.parameters.empty()) {
    chunk("FMLY", [&](Bytes& p) {
      append_u32(p, std::uint32_t(data.parameters.size()));
      for (std::size_t i = 0; i < data.parameters.size(); ++i) {
        const KnownParameter& q = data.parameters[i];
        const AlbedoAxis& axis = data.albedo.parameters[i];
        append_words(p, q.range.name), append_f32(p, q.range.lo), append_f32(p, q.range.hi);
        append_u8(p, q.logarithmic ? 1 : 0);
        append_f32(p, axis.lo), append_f32(p, axis.hi), append_u32(p, axis.rows);
      }
      for (const auto* law : {&data.law.x, &data.law.y}) {
        for (const float v : *law) append_f32(p, v);
      }
    });
  }
  if (data.domain.scale_x != 1 || data.domain.scale_y != 1) {
    chunk("WDTH", [&](Bytes& p) { append_f32(p, data.domain.scale_x), append_f32(p, data.domain.scale_y); });
  }
  if (data.target.scale != 1) chunk("SCAL", [&](Bytes& p) { append_f32(p, data.target.scale); });
  if (!data.probes.channels.empty())
    chunk(
        "PRCH", [&](Bytes& p) { append_floats(p, data.probes.channels); }, optional_flag);
  const auto is_proved = [](const MajorantTree& tree) { return tree.bound_ratio != 0; };
  if (std::any_of(data.exact.begin(), data.exact.end(), is_proved)) {
    const auto ratios = [&](Bytes& p) {
      append_u32(p, std::uint32_t(data.exact.size()));
      for (const MajorantTree& tree : data.exact) append_f32(p, tree.bound_ratio);
    };
    chunk("CERT", ratios, optional_flag);
  }
  if (data.albedo.proved_error != 0)
    chunk(
        "ALBP", [&](Bytes& p) { append_f32(p, data.albedo.proved_error); }, optional_flag);
  if (!data.report.notes.empty()) {
    const auto notes = [&](Bytes& p) {
      append_u32(p, std::uint32_t(data.report.notes.size()));
      for (const std::string& note : data.report.notes) append_words(p, note);
    };
    chunk("NOTE", notes, optional_flag);
  }
  append_u32(out, crc32(out));
  return out;
}

SamplerData decode_sampler(ByteView bytes, const std::string& where) {
  if (!is_sampler_file(bytes)) {
    const std::string how = "name a file that 'reflectree build' saved";
    refuse_recognised(bytes, where, how);
    throw Error("not a sampler file", where, how);
  }
  if (bytes.size() < magic.size() + 4) throw Error("truncated", where, fetch_again);
  const ByteView body = bytes.first(bytes.size() - 4);
  if (ByteReader(bytes.last(4), where).u32() != crc32(body)) {
    throw Error("truncated or damaged: its checksum is wrong", where, fetch_again);
  }
  SamplerData data;
  read_chunks(body.subspan(magic.size()), where, data);
  try {
    validate(data);
  } catch (const Error& error) {
    throw Error(std::string("damaged (") + error.what() + ")", where, fetch_again);
  }
  return data;
}

void save_sampler(const std::string& path, const SamplerData& data) {
  write_file_atomically(path, ByteView(encode_sampler(data)));
}

SamplerData load_sampler(const std::string& path) {
  return decode_sampler(read_file(path, max_sampler_bytes), path);
}

}  // namespace reflectree
