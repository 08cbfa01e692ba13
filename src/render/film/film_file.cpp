// SPDX-License-Identifier: Apache-2.0
// A film on disk: magic, width, height, samples, seed, identity, points (kind, columns, rows), and the sums
// as doubles, little-endian.
#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/formats/file_kind.hpp"
#include "reflectree/render/film/film.hpp"

namespace reflectree::render {

namespace {
constexpr std::string_view magic = "reflectree film 4\n";
}

void save_film(const std::string& path, const Film& film) {
  Bytes out;
  append_text(out, magic);
  append_u32(out, std::uint32_t(film.width)), append_u32(out, std::uint32_t(film.height));
  append_u32(out, std::uint32_t(film.samples)), append_u64(out, film.seed), append_u64(out, film.identity);
  append_u32(out, std::uint32_t(film.points.kind));
  append_u32(out, film.points.columns), append_u32(out, film.points.rows);
  for (const double v : film.sums) append_f64(out, v);
  write_file_atomically(path, out);
}

Film load_film(const std::string& path) {
  const Bytes bytes = read_file(path, std::uint64_t(1) << 34U);
  if (!starts_with(bytes, magic)) {
    refuse_recognised(bytes, path, "render anew");
    throw Error("not a film", path, "render anew");
  }
  ByteReader in(bytes, path);
  in.seek(magic.size());
  Film film;
  const std::uint32_t width = in.u32(), height = in.u32(), samples = in.u32();
  film.seed = in.u64(), film.identity = in.u64();
  const std::uint32_t kind = in.u32(), columns = in.u32(), rows = in.u32();
  if (kind > std::uint32_t(PointSet::Kind::sobol) || columns == 0 || rows == 0 || columns > (1U << 15U) ||
      rows > (1U << 16U)) {
    throw Error("a film of unknown points", path, "render anew");
  }
  film.points = {PointSet::Kind(kind), columns, rows};
  const std::uint64_t count = 6 * std::uint64_t(width) * height;
  if (width == 0 || height == 0 || width > 65536 || height > 65536 || samples > (1U << 30U) ||
      in.remaining() != 8 * count) {
    throw Error("a film of the wrong length", path, "render anew");
  }
  film.width = int(width), film.height = int(height), film.samples = int(samples);
  film.sums.resize(count);
  for (double& v : film.sums) v = in.f64();
  return film;
}

}  // namespace reflectree::render
