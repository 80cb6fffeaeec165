#include "aras_visual_servo_sim/image/sensor/jpeg.hpp"

#include <cstdio>  // before jpeglib.h, which needs FILE
//
#include <jpeglib.h>

#include <csetjmp>
#include <memory>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Where libjpeg goes back to when it fails. */
struct Failure {
  jpeg_error_mgr base;
  std::jmp_buf back;
  char text[JMSG_LENGTH_MAX];
};

[[noreturn]] void fail(j_common_ptr state) {
  auto* failure = reinterpret_cast<Failure*>(state->err);
  state->err->format_message(state, failure->text);
  std::longjmp(failure->back, 1);
}

J_COLOR_SPACE colorsOf(Encoding encoding) {
  if (channelsOf(encoding) == 1) return JCS_GRAYSCALE;
  return encoding == Encoding::kBgr8 ? JCS_EXT_BGR : JCS_EXT_RGB;
}

/** @return false with the reason in failure.text; nothing here has a destructor that a jump would pass over */
bool write(const Image& image, int quality, Failure& failure, unsigned char** bytes, unsigned long* size) {
  jpeg_compress_struct state;
  state.err = jpeg_std_error(&failure.base);
  failure.base.error_exit = fail;
  if (setjmp(failure.back) != 0) {  // NOLINT: libjpeg is C
    jpeg_destroy_compress(&state);
    return false;
  }
  jpeg_create_compress(&state);
  jpeg_mem_dest(&state, bytes, size);
  state.image_width = static_cast<JDIMENSION>(image.width);
  state.image_height = static_cast<JDIMENSION>(image.height);
  state.input_components = image.channels();
  state.in_color_space = colorsOf(image.encoding);
  jpeg_set_defaults(&state);
  jpeg_set_quality(&state, quality, TRUE);
  jpeg_start_compress(&state, TRUE);
  while (state.next_scanline < state.image_height) {
    auto* row = const_cast<JSAMPLE*>(image.pixel(0, static_cast<int>(state.next_scanline)));
    jpeg_write_scanlines(&state, &row, 1);
  }
  jpeg_finish_compress(&state);
  jpeg_destroy_compress(&state);
  return true;
}

bool read(const std::vector<std::uint8_t>& bytes, Failure& failure, Image& image) {
  jpeg_decompress_struct state;
  state.err = jpeg_std_error(&failure.base);
  failure.base.error_exit = fail;
  if (setjmp(failure.back) != 0) {  // NOLINT
    jpeg_destroy_decompress(&state);
    return false;
  }
  jpeg_create_decompress(&state);
  jpeg_mem_src(&state, bytes.data(), bytes.size());
  jpeg_read_header(&state, TRUE);
  state.out_color_space = colorsOf(image.encoding);
  jpeg_start_decompress(&state);
  while (state.output_scanline < state.output_height) {
    JSAMPLE* row = image.pixel(0, static_cast<int>(state.output_scanline));
    jpeg_read_scanlines(&state, &row, 1);
  }
  jpeg_finish_decompress(&state);
  jpeg_destroy_decompress(&state);
  return true;
}

}  // namespace

std::vector<std::uint8_t> jpegOf(const Image& image, int quality) {
  if (isDeep(image.encoding)) return jpegOf(upperBytes(image), quality);
  Failure failure;
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const bool written = write(image, quality, failure, &bytes, &size);
  const std::unique_ptr<unsigned char, void (*)(void*)> owner(bytes, std::free);
  if (!written) throw RenderError(std::string("JPEG: ") + failure.text);
  return {bytes, bytes + size};
}

void throughJpeg(int quality, Image& image) {
  const std::vector<std::uint8_t> bytes = jpegOf(image, quality);
  Failure failure;
  if (!read(bytes, failure, image)) throw RenderError(std::string("JPEG: ") + failure.text);
}

}  // namespace aras_visual_servo_sim
