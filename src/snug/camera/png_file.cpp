// PNG: 16-bit grey for depth and labels, 8-bit grey for intensity.
#include <png.h>

#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <utility>

#include "snug/camera/internal/file_parts.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"

namespace snug::camera {
namespace {

constexpr const char* kTextKey = "snug-camera";

/// Grey values, most significant byte first.
struct Raster {
  int cols = 0, rows = 0, bits = 16;
  std::string bytes;
  std::string text;  ///< of the chunk
};

void append(png_structp png, png_bytep data, std::size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

std::string write_raster(Raster& raster) {
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  SNUG_CHECK(png != nullptr && info != nullptr, "memory for a PNG");
  png_set_write_fn(png, &out, append, [](png_structp) {});
  png_set_compression_level(png, 3);
  png_set_filter(png, 0, PNG_FILTER_UP);
  png_set_IHDR(png, info, static_cast<png_uint_32>(raster.cols), static_cast<png_uint_32>(raster.rows), raster.bits,
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_text text{};
  std::string key = kTextKey;
  if (!raster.text.empty()) {
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = key.data();
    text.text = raster.text.data();
    text.text_length = raster.text.size();
    png_set_text(png, info, &text, 1);
  }
  png_write_info(png, info);
  const std::size_t stride = static_cast<std::size_t>(raster.cols) * static_cast<std::size_t>(raster.bits / 8);
  for (int r = 0; r < raster.rows; ++r)
    png_write_row(png, reinterpret_cast<png_const_bytep>(raster.bytes.data() + stride * static_cast<std::size_t>(r)));
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

void put16(std::string& bytes, unsigned value) {
  bytes.push_back(static_cast<char>(value >> 8U));
  bytes.push_back(static_cast<char>(value & 0xffU));
}

struct Source {
  const std::string* bytes = nullptr;
  std::size_t at = 0;
  std::string why;
};

void take(png_structp png, png_bytep out, std::size_t size) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (size > source->bytes->size() - source->at) png_error(png, "the file ends too early");
  std::memcpy(out, source->bytes->data() + source->at, size);
  source->at += size;
}

void complain(png_structp png, png_const_charp why) {
  static_cast<Source*>(png_get_error_ptr(png))->why = why;
  png_longjmp(png, 1);
}

/// Nothing with a destructor lives between setjmp and what may jump: `raster` and `source` are the caller's.
bool read_raster(Source& source, Raster& raster) {
  png_structp png =
      png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, complain, [](png_structp, png_const_charp) {});
  if (png == nullptr) return false;
  png_infop info = png_create_info_struct(png);
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_read_struct(&png, &info, nullptr);
    return false;
  }
  png_set_user_limits(png, internal::kLargestSide, internal::kLargestSide);
  png_set_read_fn(png, &source, take);
  png_read_info(png, info);
  if (png_get_color_type(png, info) != PNG_COLOR_TYPE_GRAY || png_get_bit_depth(png, info) != 16)
    png_error(png, "not grey of 16 bits");
  if (png_get_interlace_type(png, info) != PNG_INTERLACE_NONE) png_error(png, "interlaced");
  raster.cols = static_cast<int>(png_get_image_width(png, info));
  raster.rows = static_cast<int>(png_get_image_height(png, info));
  const std::size_t stride = static_cast<std::size_t>(raster.cols) * 2;
  if (!internal::has_room(stride / 2 * static_cast<std::size_t>(raster.rows), source.bytes->size()))
    png_error(png, "more pixels than a file of this size can hold");
  raster.bytes.resize(stride * static_cast<std::size_t>(raster.rows));
  for (int r = 0; r < raster.rows; ++r)
    png_read_row(png, reinterpret_cast<png_bytep>(raster.bytes.data() + stride * static_cast<std::size_t>(r)), nullptr);
  png_read_end(png, info);
  png_textp texts = nullptr;
  const int count = png_get_text(png, info, &texts, nullptr);
  for (int i = 0; i < count; ++i)
    if (std::strcmp(texts[i].key, kTextKey) == 0) raster.text.assign(texts[i].text, texts[i].text_length);
  png_destroy_read_struct(&png, &info, nullptr);
  return true;
}

}  // namespace

std::string format_png(const Frame& frame) {
  Raster raster{frame.depth.cols(), frame.depth.rows(), 16, {}, format_camera(frame.camera)};
  for (const float depth : frame.depth.values())
    put16(raster.bytes, static_cast<unsigned>(std::lround(std::min(depth / kPngUnit, 65535.0))));
  return write_raster(raster);
}

std::string format_intensity_png(const Frame& frame) {
  Raster raster{frame.intensity.cols(), frame.intensity.rows(), 8, {}, {}};
  for (const std::uint8_t value : frame.intensity.values()) raster.bytes.push_back(std::bit_cast<char>(value));
  return write_raster(raster);
}

std::string format_label_png(const FrameTruth& truth) {
  Raster raster{truth.label.cols(), truth.label.rows(), 16, {}, {}};
  for (const std::int16_t label : truth.label.values()) put16(raster.bytes, static_cast<unsigned>(label + 1));
  return write_raster(raster);
}

Frame internal::read_png(const std::string& bytes, const std::string& name, const FrameHints& hints) {
  Source source{&bytes, 0, "not a PNG"};
  Raster raster;
  if (!read_raster(source, raster)) throw InputError(name, "", source.why, "a PNG of 16-bit grey, whole");
  Frame frame;
  frame.camera = hints.camera;
  if (!raster.text.empty() && !hints.camera_is_given) parse_camera(raster.text, name, frame.camera);
  if (hints.has_any_size) {
    frame.camera.width = raster.cols;
    frame.camera.height = raster.rows;
  }
  expect_size(frame.camera, raster.cols, raster.rows, name);
  const double unit = hints.depth_unit.value_or(raster.text.empty() ? 1e-3 : kPngUnit);
  frame.depth = Grid2<float>(raster.rows, raster.cols);
  std::vector<double> depths;
  for (std::size_t i = 0; i < frame.depth.values().size(); ++i) {
    const auto high = std::bit_cast<std::uint8_t>(raster.bytes[2 * i]),
               low = std::bit_cast<std::uint8_t>(raster.bytes[2 * i + 1]);
    const double depth = unit * (256.0 * high + low);
    if (depth > 0.0) depths.push_back(depth);
    frame.depth.values()[i] = usable(frame.camera, depth);
  }
  expect_in_range(frame.camera, std::move(depths), unit, name);
  return frame;
}

}  // namespace snug::camera
