// SPDX-License-Identifier: Apache-2.0
// JPEG by libjpeg-turbo: grey or three colours, 8 bits, baseline or progressive. Orientation and profile are
// not heeded, as in Mitsuba.
#include <cstdio>
// jpeglib.h wants stdio before it.
#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>

#include "reflectree/error.hpp"
#include "reflectree/picture/image.hpp"

namespace reflectree {

namespace {

// What libjpeg's callbacks see; no destructors, since its errors are jumps.
struct Failure {
  jpeg_error_mgr manager;
  std::jmp_buf back;
  char message[JMSG_LENGTH_MAX];
};

[[noreturn]] void jump(j_common_ptr info) {
  auto* failure = reinterpret_cast<Failure*>(info->err);
  info->err->format_message(info, failure->message);
  std::longjmp(failure->back, 1);
}
// A warning is a damaged file: what it would show is a guess. But bytes between its parts harm nobody.
void judge(j_common_ptr info, int level) {
  if (level < 0 && info->err->msg_code != JWRN_EXTRANEOUS_DATA) jump(info);
}
// Progressive pictures are refined scan by scan; each costs the whole picture's time.
void watch(j_common_ptr info) {
  constexpr int most_scans = 200;
  if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > most_scans) {
    info->err->msg_code = JERR_BAD_PROGRESSION;
    jump(info);
  }
}

struct Reader {
  jpeg_decompress_struct info{};
  Failure failure{};
  jpeg_progress_mgr progress{};

  explicit Reader(ByteView bytes) {
    info.err = jpeg_std_error(&failure.manager);
    failure.manager.error_exit = jump, failure.manager.emit_message = judge;
    if (setjmp(failure.back)) return;
    jpeg_create_decompress(&info);
    progress.progress_monitor = watch, info.progress = &progress;
    jpeg_mem_src(&info, bytes.data(), static_cast<unsigned long>(bytes.size()));
  }
  ~Reader() { jpeg_destroy_decompress(&info); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  // Both return false where libjpeg has an error to tell.
  bool head() {
    if (setjmp(failure.back)) return false;
    jpeg_read_header(&info, TRUE);
    info.out_color_space = info.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_calc_output_dimensions(&info);
    return true;
  }
  bool body(JSAMPROW pixels, std::size_t row) {
    if (setjmp(failure.back)) return false;
    jpeg_start_decompress(&info);
    while (info.output_scanline < info.output_height) {
      JSAMPROW at = pixels + info.output_scanline * row;
      jpeg_read_scanlines(&info, &at, 1);
    }
    jpeg_finish_decompress(&info);
    return true;
  }
};

}  // namespace

Image read_jpeg(ByteView bytes, const std::string& where) {
  Reader in(bytes);
  const auto fail = [&] {
    return Error("libjpeg cannot read it (" + std::string(in.failure.message) + ")", where,
                 "save the picture again");
  };
  if (in.failure.message[0] || !in.head()) throw fail();
  if (in.info.num_components != 1 && in.info.num_components != 3)
    throw Error("a JPEG picture of four inks", where, "save it in red, green and blue");
  // A block of 8 x 8 takes a bit at least.
  if (std::uint64_t(in.info.output_width) * in.info.output_height / 512 > bytes.size())
    throw Error("shorter than its size says", where, "fetch the file again");
  const bool grey = in.info.num_components == 1;
  Image image = make_image(int(in.info.output_width), int(in.info.output_height),
                           grey ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"});
  image.encoded = true;
  Bytes pixels(image.values.size());
  if (!in.body(pixels.data(), pixels.size() / in.info.output_height)) throw fail();
  for (std::size_t i = 0; i < pixels.size(); ++i) image.values[i] = float(pixels[i]) / 255;
  return image;
}

}  // namespace reflectree
