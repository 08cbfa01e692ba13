// SPDX-License-Identifier: Apache-2.0
// OpenEXR through memory: what is read is one span of bytes, what is written appears by a rename.
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "reflectree/error.hpp"
#include "reflectree/formats/file.hpp"
#include "reflectree/picture/image.hpp"

namespace reflectree {

namespace {

class MemoryIn : public Imf::IStream {
 public:
  explicit MemoryIn(ByteView bytes) : IStream("memory"), bytes_(bytes) {}
  bool read(char out[], int n) override {
    if (n < 0 || std::uint64_t(n) > bytes_.size() - at_) throw std::runtime_error("the file ends early");
    std::memcpy(out, bytes_.data() + at_, std::size_t(n));
    at_ += std::size_t(n);
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t to) override {
    if (to > bytes_.size()) throw std::runtime_error("the file ends early");
    at_ = std::size_t(to);
  }

 private:
  ByteView bytes_;
  std::size_t at_ = 0;
};

class MemoryOut : public Imf::OStream {
 public:
  MemoryOut() : OStream("memory") {}
  void write(const char data[], int n) override {
    if (bytes.size() < at_ + std::size_t(n)) bytes.resize(at_ + std::size_t(n));
    std::memcpy(bytes.data() + at_, data, std::size_t(n));
    at_ += std::size_t(n);
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t to) override { at_ = std::size_t(to); }
  Bytes bytes;

 private:
  std::size_t at_ = 0;
};

Imf::FrameBuffer frame_of(Image& image, int x0, int y0) {
  Imf::FrameBuffer frame;
  const std::size_t pixel = sizeof(float) * image.channels.size(), row = pixel * std::size_t(image.width);
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    // OpenEXR wants the address of pixel (0, 0), which the data window need not hold.
    char* base = reinterpret_cast<char*>(image.values.data() + c) - std::ptrdiff_t(pixel) * x0 -
                 std::ptrdiff_t(row) * y0;
    frame.insert(image.channels[c], Imf::Slice(Imf::FLOAT, base, pixel, row));
  }
  return frame;
}

// Types of attributes that have one size, which OpenEXR reads by that and not by the size that the file gives.
constexpr std::pair<std::uint32_t, std::string_view> sizes[] = {
    {1, " compression deepImageState envmap lineOrder "},
    {4, " float int "},
    {8, " double rational timecode v2f v2i "},
    {9, " tiledesc "},
    {12, " v3f v3i "},
    {16, " box2f box2i v2d "},
    {24, " v3d "},
    {28, " keycode "},
    {32, " chromaticities "},
    {36, " m33f "},
    {64, " m44f "},
    {72, " m33d "},
    {128, " m44d "}};
std::uint32_t size_of(const std::string& type) {
  for (const auto& [size, types] : sizes) {
    if (types.find(" " + type + " ") != std::string_view::npos) return size;
  }
  return 0;
}

// OpenEXR allocates what a header claims before it reads on; a damaged one claims gigabytes. So the
// headers are walked here: attributes are as long as they say and end within the file, and pixels or tiles
// are no more than the best compression can hold, a thousand values per byte and some more for small files.
void check_claims(ByteView bytes, const std::string& where) {
  const auto lie = [&] {
    return Error("a header that claims more than the file holds", where, "fetch the file again");
  };
  ByteReader in(bytes, where);
  const auto at = [&] { return bytes.size() - in.remaining(); };
  const auto word = [&] {
    std::string found;
    while (const std::uint8_t c = in.u8()) found += char(c);
    return found;
  };
  in.seek(4);
  const bool parts = (in.u32() & 0x1000U) != 0;
  std::uint64_t channels = 0, width = 1, height = 1, tile = 1;
  // A file of several parts ends its headers with an empty one.
  for (bool more = false;;) {
    if (word().empty()) {
      if (!parts || !more) break;
      more = false;
      continue;
    }
    more = true;
    const std::string type = word();
    const std::uint32_t size = in.u32(), right = size_of(type);
    if (size > in.remaining() || (right && size != right)) throw lie();
    const std::size_t end = at() + size;
    if (type == "chlist") {
      for (; !word().empty(); ++channels) in.seek(at() + 16);
      if (at() != end) throw lie();
    } else if (type == "box2i") {
      const auto x0 = std::int32_t(in.u32()), y0 = std::int32_t(in.u32()), x1 = std::int32_t(in.u32()),
                 y1 = std::int32_t(in.u32());
      width = std::max(width, std::uint64_t(std::max<std::int64_t>(1, std::int64_t(x1) - x0 + 1)));
      height = std::max(height, std::uint64_t(std::max<std::int64_t>(1, std::int64_t(y1) - y0 + 1)));
    } else if (type == "tiledesc") {
      tile = in.u32();
      tile *= in.u32();
    } else if (type == "preview") {
      const std::uint64_t wide = in.u32(), high = in.u32();
      if (wide > size || high > size || 8 + 4 * wide * high != size) throw lie();
    }
    in.seek(end);
  }
  if (width > (1U << 20U) || height > (1U << 20U)) throw Error("too large", where, "make it smaller");
  const std::uint64_t most = 1024 * bytes.size() + (1U << 24U);
  const std::uint64_t blocks = std::max<std::uint64_t>(height, 256);  // lines are unpacked 256 at a time
  if (channels > most / (width * blocks) || channels > most / std::max<std::uint64_t>(1, tile)) throw lie();
}

// The file's R, G and B, of every layer, as sRGB's; without adaptation of the white point, as in Mitsuba.
void to_srgb_primaries(Image& image, const Imf::Chromaticities& own) {
  const Imf::Chromaticities srgb;
  const auto apart = [](Imath::V2f a, Imath::V2f b) { return (a - b).length2(); };
  if (apart(own.red, srgb.red) + apart(own.green, srgb.green) + apart(own.blue, srgb.blue) +
          apart(own.white, srgb.white) <
      1e-6f)
    return;
  const Imath::M44f m = Imf::RGBtoXYZ(own, 1) * Imf::XYZtoRGB(srgb, 1);
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    const std::string& name = image.channels[c];
    if (name.back() != 'R' || (name.size() > 1 && name[name.size() - 2] != '.')) continue;
    const std::string layer = name.substr(0, name.size() - 1);
    const int g = image.find(layer + "G"), b = image.find(layer + "B");
    if (g < 0 || b < 0) continue;
    for (std::size_t i = 0; i < image.values.size(); i += image.channels.size()) {
      float &vr = image.values[i + c], &vg = image.values[i + std::size_t(g)],
            &vb = image.values[i + std::size_t(b)];
      const Imath::V3f rgb = Imath::V3f(vr, vg, vb) * m;
      vr = rgb.x, vg = rgb.y, vb = rgb.z;
    }
  }
}

}  // namespace

Image read_exr(ByteView bytes, const std::string& where) {
  check_claims(bytes, where);
  try {
    MemoryIn in(bytes);
    Imf::InputFile file(in);
    const Imath::Box2i box = file.header().dataWindow();
    std::vector<std::string> names;
    for (auto c = file.header().channels().begin(); c != file.header().channels().end(); ++c) {
      if (c.channel().xSampling != 1 || c.channel().ySampling != 1) {
        throw std::runtime_error("channels of several resolutions");
      }
      if (c.channel().type == Imf::UINT)
        throw Error(std::string("channel ") + c.name() + " holds whole numbers, not light", where,
                    "save it as half or float");
      names.emplace_back(c.name());
    }
    const std::int64_t width = std::int64_t(box.max.x) - box.min.x + 1,
                       height = std::int64_t(box.max.y) - box.min.y + 1;
    if (width > (1 << 20) || height > (1 << 20)) throw std::runtime_error("too large");
    Image image = make_image(int(width), int(height), std::move(names));
    for (auto a = file.header().begin(); a != file.header().end(); ++a) {
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute())) {
        image.metadata[a.name()] = text->value();
      }
    }
    file.setFrameBuffer(frame_of(image, box.min.x, box.min.y));
    file.readPixels(box.min.y, box.max.y);
    if (Imf::hasChromaticities(file.header())) to_srgb_primaries(image, Imf::chromaticities(file.header()));
    return image;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(std::string("OpenEXR cannot read it (") + error.what() + ")", where, "fetch the file again");
  }
}

void write_exr(const std::string& path, const Image& image) {
  Image copy = image;  // OpenEXR asks for pixels that can be written
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const std::string& name : image.channels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  for (const auto& [key, value] : image.metadata) header.insert(key, Imf::StringAttribute(value));
  MemoryOut out;
  try {
    Imf::OutputFile file(out, header);
    file.setFrameBuffer(frame_of(copy, 0, 0));
    file.writePixels(image.height);
  } catch (const std::exception& error) {
    throw Error(std::string("OpenEXR cannot write it (") + error.what() + ")", path, "check the picture");
  }
  write_file_atomically(path, ByteView(out.bytes));
}

}  // namespace reflectree
