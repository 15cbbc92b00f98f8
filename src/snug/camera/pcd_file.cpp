// PCD: clouds as the Point Cloud Library writes them: ascii, binary, binary_compressed; organised or not.
#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>

#include "snug/camera/internal/cloud.hpp"
#include "snug/camera/internal/file_parts.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::camera {
namespace {

constexpr std::size_t kMostPoints = std::size_t{8192} * 8192;

struct PcdField {
  std::string name;
  std::size_t size = 4, count = 1;
  char type = 'F';
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t width = 0, height = 0, points = 0, body = 0;
  std::string data;

  [[nodiscard]] std::size_t stride() const {
    std::size_t bytes = 0;
    for (const PcdField& field : fields) bytes += field.size * field.count;
    return bytes;
  }
};

[[noreturn]] void refuse_pcd(const std::string& name, const std::string& got) {
  throw InputError(name, "", got, "a PCD (ascii, binary or binary_compressed) whose points have x, y, z as F 4 or F 8");
}

PcdHeader read_pcd_header(const std::string& bytes, const std::string& name) {
  PcdHeader header;
  std::size_t at = 0;
  for (int lines = 0; header.data.empty(); ++lines) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos || lines > 100 || end - at > 4096) refuse_pcd(name, "no DATA");
    std::istringstream words(bytes.substr(at, end - at));
    at = end + 1;
    std::string key;
    words >> key;
    if (key.empty() || key[0] == '#') continue;
    std::vector<std::string> values;
    for (std::string word; words >> word;) values.push_back(word);
    const auto number = [&](std::size_t i) {
      std::size_t value = 0;
      const std::string& text = i < values.size() ? values[i] : key;
      const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error != std::errc() || rest != text.data() + text.size() || value > kMostPoints)
        refuse_pcd(name, key + " " + printable(text, 60));
      return value;
    };
    if (key == "FIELDS" || key == "COLUMNS") {
      for (const std::string& one : values) header.fields.push_back({one});
      if (header.fields.size() > 64) refuse_pcd(name, "more than 64 fields");
    } else if (key == "SIZE" || key == "COUNT" || key == "TYPE") {
      if (values.size() != header.fields.size()) refuse_pcd(name, key + " of another number of fields");
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (key == "SIZE") header.fields[i].size = number(i);
        if (key == "COUNT") header.fields[i].count = number(i);
        if (key == "TYPE") header.fields[i].type = values[i][0];
      }
    } else if (key == "WIDTH") {
      header.width = number(0);
    } else if (key == "HEIGHT") {
      header.height = number(0);
    } else if (key == "POINTS") {
      header.points = number(0);
    } else if (key == "DATA") {
      header.data = values.empty() ? "nothing" : values[0];
    }
  }
  header.body = at;
  if (header.points == 0) header.points = header.width * header.height;
  if (header.points > kMostPoints) refuse_pcd(name, "an absurd number of points");
  for (const PcdField& field : header.fields) {
    if (field.size > 8 || field.count > 4096) refuse_pcd(name, "field " + printable(field.name, 60));
  }
  return header;
}

/// LZF: runs of bytes as they are, and copies of what came before.
std::string unpack_lzf(std::string_view packed, std::size_t size, const std::string& name) {
  std::string out;
  out.reserve(size);
  std::size_t at = 0;
  const auto next = [&]() -> std::size_t {
    if (at >= packed.size()) refuse_pcd(name, "packed bytes that end too early");
    return std::bit_cast<std::uint8_t>(packed[at++]);
  };
  while (at < packed.size()) {
    const std::size_t control = next();
    if (control < 32) {
      const std::size_t length = control + 1;
      if (packed.size() - at < length || out.size() + length > size) refuse_pcd(name, "packed bytes that do not fit");
      out.append(packed.substr(at, length));
      at += length;
      continue;
    }
    std::size_t length = control >> 5U;
    if (length == 7) length += next();
    const std::size_t back = ((control & 31U) << 8U) + next() + 1;
    length += 2;
    if (back > out.size() || out.size() + length > size) refuse_pcd(name, "packed bytes that do not fit");
    for (std::size_t i = 0; i < length; ++i) out.push_back(out[out.size() - back]);
  }
  if (out.size() != size) refuse_pcd(name, "packed bytes that end too early");
  return out;
}

double load_pcd_number(const char* at, std::size_t size) {
  if (size == 8) {
    double value = 0.0;
    std::memcpy(&value, at, sizeof value);
    return value;
  }
  float value = 0.0F;
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// Where x, y and z are: index of the field, number of values before it, and bytes before it in a point.
struct PcdPlace {
  std::size_t size = 4, values = 0, bytes = 0;
};

std::array<PcdPlace, 3> find_pcd_axes(const PcdHeader& header, const std::string& name) {
  std::array<PcdPlace, 3> places;
  constexpr std::array kNames = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < kNames.size(); ++axis) {
    PcdPlace place;
    bool is_there = false;
    for (const PcdField& field : header.fields) {
      if (field.name == kNames[axis]) {
        is_there = field.type == 'F' && field.count == 1 && (field.size == 4 || field.size == 8);
        place.size = field.size;
        break;
      }
      place.values += field.count;
      place.bytes += field.size * field.count;
    }
    if (!is_there) refuse_pcd(name, std::string("no field ") + kNames[axis] + " of that kind");
    places[axis] = place;
  }
  return places;
}

template <class Visit>
void each_ascii(const std::string& bytes, const PcdHeader& header, const std::array<PcdPlace, 3>& axes,
                const std::string& name, const Visit& visit) {
  std::size_t values = 0;
  for (const PcdField& field : header.fields) values += field.count;
  const char* at = bytes.data() + header.body;
  const char* const end = bytes.data() + bytes.size();
  for (std::size_t i = 0; i < header.points; ++i) {
    Vector3 p = Vector3::Zero();
    for (std::size_t k = 0; k < values; ++k) {
      while (at < end && std::isspace(static_cast<unsigned char>(*at)) != 0) ++at;
      const char* stop = at;
      while (stop < end && std::isspace(static_cast<unsigned char>(*stop)) == 0) ++stop;
      double value = 0.0;
      const auto [rest, error] = std::from_chars(at, stop, value);
      if (at == end) refuse_pcd(name, "a file that ends too early");
      if (error != std::errc() || rest != stop) refuse_pcd(name, "text that is no number");
      at = stop;
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (axes[axis].values == k) p[static_cast<Eigen::Index>(axis)] = value;
    }
    visit(i, p);
  }
}

/// The fields of a packed cloud stand one after the other, those of others point by point.
template <class Visit>
void each_binary(std::string_view body, const PcdHeader& header, const std::array<PcdPlace, 3>& axes, bool is_by_field,
                 const Visit& visit) {
  const std::size_t stride = header.stride();
  for (std::size_t i = 0; i < header.points; ++i) {
    Vector3 p;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const PcdPlace& place = axes[axis];
      const std::size_t at = is_by_field ? place.bytes * header.points + i * place.size : i * stride + place.bytes;
      p[static_cast<Eigen::Index>(axis)] = load_pcd_number(body.data() + at, place.size);
    }
    visit(i, p);
  }
}

std::string unpack_pcd(std::string_view body, const PcdHeader& header, const std::string& name) {
  std::array<std::uint32_t, 2> sizes{};
  if (body.size() < sizeof sizes) refuse_pcd(name, "a file that ends too early");
  std::memcpy(sizes.data(), body.data(), sizeof sizes);
  const std::size_t size = header.points * header.stride();
  if (sizes[0] > body.size() - sizeof sizes) refuse_pcd(name, "a file that ends too early");
  if (sizes[1] != size || !internal::has_room(size / 6, body.size())) refuse_pcd(name, "another size of the points");
  return unpack_lzf(body.substr(sizeof sizes, sizes[0]), size, name);
}

}  // namespace

Frame internal::read_pcd(const std::string& bytes, const std::string& name, const FrameHints& hints) {
  static_assert(std::endian::native == std::endian::little, "the form is little-endian");
  const PcdHeader header = read_pcd_header(bytes, name);
  const std::array<PcdPlace, 3> axes = find_pcd_axes(header, name);
  std::string_view body = std::string_view(bytes).substr(header.body);
  std::string unpacked;
  const bool is_packed = header.data == "binary_compressed", is_text = header.data == "ascii";
  if (!is_packed && !is_text && header.data != "binary") refuse_pcd(name, "DATA " + printable(header.data, 60));
  if (is_packed) body = unpacked = unpack_pcd(body, header, name);
  if (!is_text && body.size() / std::max<std::size_t>(1, header.stride()) < header.points)
    refuse_pcd(name, "a file that ends too early");
  if (is_text && body.size() / 2 < header.points) refuse_pcd(name, "a file that ends too early");

  model::CameraParams camera = hints.camera;
  const bool is_organised = header.height > 1 && header.width * header.height == header.points &&
                            header.width <= static_cast<std::size_t>(kLargestSide) &&
                            header.height <= static_cast<std::size_t>(kLargestSide);
  take_size(hints,
            {static_cast<int>(is_organised ? header.width : 0), static_cast<int>(is_organised ? header.height : 0)},
            is_organised, camera, name);
  Cloud cloud(camera, {hints.depth_unit.value_or(1.0), hints.points_are_in_camera, hints.axes});
  const auto add = [&](std::size_t i, const Vector3& p) { cloud.add(p, is_organised ? pixel_of(i, camera) : Pixel{}); };
  if (is_text) {
    each_ascii(bytes, header, axes, name, add);
  } else {
    each_binary(body, header, axes, is_packed, add);
  }
  return std::move(cloud).finish(name);
}

}  // namespace snug::camera
