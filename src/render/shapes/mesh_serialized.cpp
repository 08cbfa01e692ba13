// SPDX-License-Identifier: Apache-2.0
// Mitsuba's .serialized meshes: streams of zlib, each behind a header of four bytes, and at the end of the
// file where each begins. Nothing in the file is trusted: a stream is unpacked as far as its own counts ask,
// in steps, so that a lie costs no more memory than the file has bytes for.
#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "reflectree/error.hpp"
#include "reflectree/formats/file_kind.hpp"
#include "reflectree/render/shapes/mesh_files.hpp"

namespace reflectree::render {

namespace {

enum Flags : std::uint32_t { has_normals = 0x1, has_uv = 0x2, has_colours = 0x8, doubles = 0x2000 };

[[noreturn]] void fail(const std::string& what, const std::string& path) {
  throw Error(what, path, "export the mesh again, as PLY for example");
}

// Bytes of a stream, one after the other.
class Unpacked {
 public:
  Unpacked(ByteView packed, const std::string& path) : path_(path) {
    // zlib takes 32 bits of length; a mesh file of more is none that it wrote.
    stream_.next_in = const_cast<Bytef*>(packed.data());
    stream_.avail_in = uInt(std::min<std::size_t>(packed.size(), 0xffffffffU));
    if (inflateInit(&stream_) != Z_OK) fail("zlib cannot start", path);
  }
  ~Unpacked() { inflateEnd(&stream_); }
  Unpacked(const Unpacked&) = delete;
  Unpacked& operator=(const Unpacked&) = delete;

  Bytes take(std::uint64_t count) {
    Bytes out;
    while (out.size() < count) {
      const std::size_t before = out.size(),
                        step = std::size_t(std::min<std::uint64_t>(count - before, 1U << 20U));
      out.resize(before + step);
      stream_.next_out = out.data() + before, stream_.avail_out = uInt(step);
      const int result = inflate(&stream_, Z_NO_FLUSH);
      if (stream_.avail_out > 0 && result != Z_OK) fail("its stream ends early or is damaged", path_);
    }
    return out;
  }
  std::uint64_t integer(unsigned bytes) {
    const Bytes b = take(bytes);
    return bytes == 1 ? b[0] : bytes == 4 ? ByteReader(b, path_).u32() : ByteReader(b, path_).u64();
  }

 private:
  z_stream stream_{};
  const std::string& path_;
};

// `count` numbers, as floats.
std::vector<float> numbers(Unpacked& in, std::uint64_t count, bool wide, const std::string& path) {
  const Bytes bytes = in.take(count * (wide ? 8 : 4));
  ByteReader reader(bytes, path);
  std::vector<float> out(static_cast<std::size_t>(count));
  for (float& v : out) v = wide ? float(reader.f64()) : reader.f32();
  return out;
}

// Where the mesh's stream begins: for the first behind the header, for others as the end of the file says.
std::uint64_t beginning(ByteView bytes, int index, std::uint16_t version, const std::string& path) {
  if (index == 0) return 4;
  ByteReader in(bytes, path);
  in.seek(bytes.size() - 4);
  const std::uint64_t count = in.u32(), width = version == 4 ? 8 : 4, after = count - std::uint64_t(index);
  if (std::uint64_t(index) >= count || count > bytes.size() / width)
    fail("no mesh " + std::to_string(index) + " in it, but " + std::to_string(count), path);
  in.seek(bytes.size() - 4 - width * after);
  const std::uint64_t at = width == 8 ? in.u64() : in.u32();
  if (at > bytes.size() - 4) fail("mesh " + std::to_string(index) + " begins behind its end", path);
  return at + 4;
}

}  // namespace

Mesh read_serialized(ByteView bytes, const std::string& path, int index, bool face_normals) {
  ByteReader head(bytes, path);
  if (bytes.size() < 8 || head.u16() != 0x041c) {
    refuse_recognised(bytes, path, "name a .serialized mesh");
    fail("not a .serialized mesh", path);
  }
  const std::uint16_t version = head.u16();
  if (version != 3 && version != 4) fail("of version " + std::to_string(version) + ", not 3 or 4", path);
  Unpacked in(bytes.subspan(std::size_t(beginning(bytes, index, version, path))), path);
  const auto flags = std::uint32_t(in.integer(4));
  if (version == 4) {
    for (std::size_t i = 0; in.integer(1) != 0; ++i) {
      if (i > 65536) fail("a name that does not end", path);
    }
  }
  const std::uint64_t vertices = in.integer(8), triangles = in.integer(8);
  // A byte of zlib unpacks to at most 1032.
  if (vertices > 1032 * std::uint64_t(bytes.size()) / 12 ||
      triangles > 1032 * std::uint64_t(bytes.size()) / 12)
    fail("more vertices or triangles than it has bytes for", path);
  const bool wide = flags & doubles;
  Mesh mesh;
  mesh.has_uv = flags & has_uv;
  mesh.vertices.resize(std::size_t(vertices));
  const auto at = numbers(in, 3 * vertices, wide, path);
  const auto normals = flags & has_normals ? numbers(in, 3 * vertices, wide, path) : std::vector<float>{};
  const auto uv = flags & has_uv ? numbers(in, 2 * vertices, wide, path) : std::vector<float>{};
  if (flags & has_colours) numbers(in, 3 * vertices, wide, path);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    Vertex& v = mesh.vertices[i];
    v.at = {at[3 * i], at[3 * i + 1], at[3 * i + 2]};
    if (!normals.empty() && !face_normals)
      v.normal = {normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]};
    if (!uv.empty()) v.uv = {uv[2 * i], uv[2 * i + 1]};
  }
  const Bytes corners = in.take(12 * triangles);
  ByteReader reader(corners, path);
  mesh.triangles.resize(std::size_t(triangles));
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      corner = reader.u32();
      if (corner >= vertices) fail("a corner that does not exist", path);
    }
  }
  mesh.smooth = normals.empty() && !face_normals;
  return mesh;
}

}  // namespace reflectree::render
