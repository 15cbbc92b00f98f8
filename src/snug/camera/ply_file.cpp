// PLY: points with row and column, so that a cloud is a frame again when it is read.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <sstream>

#include "snug/camera/internal/cloud.hpp"
#include "snug/camera/internal/file_parts.hpp"
#include "snug/core/input_error.hpp"

namespace snug::camera {
namespace {

constexpr std::string_view kCameraComment = "comment snug-camera ";

template <class T>
void put(std::string& out, T value) {
  static_assert(std::endian::native == std::endian::little);
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

struct Property {
  std::string type, name;
  std::size_t offset = 0;
};

std::size_t size_of(const std::string& type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "int" || type == "uint" || type == "int32" || type == "uint32" || type == "float" || type == "float32")
    return 4;
  if (type == "double" || type == "float64") return 8;
  return 0;
}

/// A number of the file, whose bytes may stand the other way round.
template <class T>
double load_as(const char* at, bool is_big) {
  std::array<char, sizeof(T)> bytes{};
  std::copy_n(at, sizeof(T), bytes.begin());
  if (is_big) std::ranges::reverse(bytes);
  return static_cast<double>(std::bit_cast<T>(bytes));
}

double load(const std::string& type, const char* at, bool is_big) {
  if (type == "float" || type == "float32") return load_as<float>(at, is_big);
  if (type == "double" || type == "float64") return load_as<double>(at, is_big);
  if (type == "char" || type == "int8") return load_as<std::int8_t>(at, is_big);
  if (type == "uchar" || type == "uint8") return load_as<std::uint8_t>(at, is_big);
  if (type == "short" || type == "int16") return load_as<std::int16_t>(at, is_big);
  if (type == "ushort" || type == "uint16") return load_as<std::uint16_t>(at, is_big);
  if (type == "int" || type == "int32") return load_as<std::int32_t>(at, is_big);
  return load_as<std::uint32_t>(at, is_big);
}

struct Header {
  bool is_text = false, is_big = false;
  int rows = 0, cols = 0;  ///< of an organised cloud that says so; 0: it does not
  std::size_t count = 0, stride = 0, body = 0;
  std::vector<Property> properties;
  std::string camera;
  [[nodiscard]] int find(std::string_view name) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
      if (properties[i].name == name) return static_cast<int>(i);
    return -1;
  }
};

class Reader {
 public:
  Reader(const std::string& bytes, const std::string& name) : bytes_(bytes), name_(name) { read_header(); }

  [[nodiscard]] const Header& header() const { return header_; }

  /// Calls visit(index, values) for each vertex.
  template <class Visit>
  void each(const Visit& visit) {
    std::vector<double> values(header_.properties.size());
    const char* at = bytes_.data() + header_.body;
    const char* const end = bytes_.data() + bytes_.size();
    for (std::size_t i = 0; i < header_.count; ++i) {
      if (header_.is_text) {
        for (double& value : values) at = read_number(at, end, value);
      } else {
        if (static_cast<std::size_t>(end - at) < header_.stride) refuse("a file that ends too early");
        for (std::size_t k = 0; k < values.size(); ++k)
          values[k] = load(header_.properties[k].type, at + header_.properties[k].offset, header_.is_big);
        at += header_.stride;
      }
      visit(i, values);
    }
  }

  [[noreturn]] void refuse(const std::string& got) const {
    throw InputError(name_, "", got, "a PLY (ascii or binary) whose vertices, its first element, have x, y, z");
  }

 private:
  const char* read_number(const char* at, const char* end, double& value) const {
    while (at < end && std::isspace(static_cast<unsigned char>(*at)) != 0) ++at;
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error != std::errc()) refuse(at == end ? "a file that ends too early" : "text that is no number");
    return rest;
  }

  void read_header() {
    bool is_done = false, in_vertex = false;
    std::size_t at = 0;
    for (int lines = 0; !is_done; ++lines) {
      const std::size_t end = bytes_.find('\n', at);
      if (end == std::string::npos || lines > 200 || end - at > 4096) refuse("no end_header");
      std::string line = bytes_.substr(at, end - at);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      at = end + 1;
      std::istringstream words(line);
      std::string word;
      words >> word;
      if (word == "format") {
        words >> word;
        if (word != "ascii" && word != "binary_little_endian" && word != "binary_big_endian") refuse("format " + word);
        header_.is_text = word == "ascii";
        header_.is_big = word == "binary_big_endian";
      } else if (word == "element") {
        std::string what;
        long long count = -1;
        words >> what >> count;
        in_vertex = what == "vertex";
        if (in_vertex && (count < 0 || count > 8192LL * 8192)) refuse("an absurd number of vertices");
        if (in_vertex && !header_.properties.empty()) refuse("vertices twice");
        if (in_vertex)
          header_.count = static_cast<std::size_t>(count);
        else if (header_.properties.empty())
          refuse("an element before the vertices");
      } else if (word == "property" && in_vertex) {
        Property property;
        words >> property.type >> property.name;
        property.offset = header_.stride;
        if (size_of(property.type) == 0) refuse("a property of type '" + property.type + "'");
        header_.stride += size_of(property.type);
        header_.properties.push_back(property);
      } else if (word == "obj_info") {
        std::string what;
        int count = 0;
        words >> what >> count;
        if (count < 0 || count > internal::kLargestSide) refuse("an absurd " + what);
        if (what == "num_cols" || what == "width") header_.cols = count;
        if (what == "num_rows" || what == "height") header_.rows = count;
      } else if (line.starts_with(kCameraComment)) {
        header_.camera = line.substr(kCameraComment.size());
      }
      is_done = word == "end_header";
    }
    header_.body = at;
    for (const char* axis : {"x", "y", "z"})
      if (header_.find(axis) < 0) refuse(std::string("no property ") + axis);
    if (!header_.is_text && (bytes_.size() - at) / header_.stride < header_.count) refuse("a file that ends too early");
    if (header_.is_text && (bytes_.size() - at) / 2 < header_.count) refuse("a file that ends too early");
  }

  const std::string& bytes_;
  const std::string& name_;
  Header header_;
};

}  // namespace

std::string format_ply(const Frame& frame, const FrameTruth* truth) {
  std::string body;
  std::size_t count = 0;
  for (int r = 0; r < frame.depth.rows(); ++r) {
    for (int c = 0; c < frame.depth.cols(); ++c) {
      const float depth = frame.depth(r, c);
      if (!(depth > 0.0F)) continue;
      const Vector3 p_WQ = frame.camera.X_WC * Vector3(depth * pixel_ray(frame.camera.intrinsics, c, r));
      for (int i = 0; i < 3; ++i) put(body, static_cast<float>(p_WQ(i)));
      put(body, static_cast<std::uint16_t>(r));
      put(body, static_cast<std::uint16_t>(c));
      put(body, frame.intensity.values().empty() ? std::uint8_t{0} : frame.intensity(r, c));
      if (truth != nullptr) put(body, truth->label(r, c));
      ++count;
    }
  }
  std::string head = "ply\nformat binary_little_endian 1.0\ncomment points in the world frame, metres\n";
  head += std::string(kCameraComment) + format_camera(frame.camera) + "\n";
  if (truth != nullptr)
    for (std::size_t i = 0; i < truth->names.size(); ++i)
      head += "comment label " + std::to_string(i) + " " + truth->names[i] + "\n";
  head += "element vertex " + std::to_string(count) +
          "\nproperty float x\nproperty float y\nproperty float z\nproperty ushort row\nproperty ushort col\n"
          "property uchar intensity\n";
  if (truth != nullptr) head += "property short label\n";
  return head + "end_header\n" + body;
}

Frame internal::read_ply(const std::string& bytes, const std::string& name, const FrameHints& hints) {
  Reader reader(bytes, name);
  const Header& header = reader.header();
  model::CameraParams camera = hints.camera;
  const bool is_ours = !header.camera.empty() && !hints.camera_is_given;
  if (is_ours) parse_camera(header.camera, name, camera);
  if (is_ours &&
      !has_room(static_cast<std::size_t>(camera.height) * static_cast<std::size_t>(camera.width), bytes.size()))
    throw InputError(name, "size", "more pixels than a file of this size can hold", "as many as there are points");
  const bool is_organised =
      header.rows > 0 && static_cast<std::size_t>(header.rows) * static_cast<std::size_t>(header.cols) == header.count;
  take_size(hints, {header.cols, header.rows}, is_organised, camera, name);
  const int x = header.find("x"), y = header.find("y"), z = header.find("z"), row = header.find("row"),
            col = header.find("col");
  const bool says_pixels = row >= 0 && col >= 0;
  const std::size_t pixels = static_cast<std::size_t>(camera.height) * static_cast<std::size_t>(camera.width);
  const bool goes_by_place = !says_pixels && header.count == pixels;
  CloudReading reading;
  if (header.camera.empty()) {
    reading = {hints.depth_unit.value_or(1.0), hints.points_are_in_camera, hints.axes};
  }
  Cloud cloud(camera, reading);
  reader.each([&](std::size_t i, const std::vector<double>& values) {
    const auto at = [&values](int k) { return values[static_cast<std::size_t>(k)]; };
    Pixel pixel;
    if (says_pixels) pixel = {at(row), at(col)};
    if (goes_by_place) pixel = pixel_of(i, camera);
    cloud.add({at(x), at(y), at(z)}, pixel);
  });
  return std::move(cloud).finish(name);
}

}  // namespace snug::camera
