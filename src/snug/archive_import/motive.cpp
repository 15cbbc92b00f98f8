// Motion capture by OptiTrack's Motive, exported as CSV.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "snug/archive_import/internal/readers.hpp"
#include "snug/core/csv_fields.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::archive_import::internal {
namespace {

using record::PoseSample;

constexpr std::size_t kMostHeaderLines = 20;

struct MotiveUnit {
  std::string_view name, word;  ///< of a header, of the hints
  double metres;
};
constexpr std::array<MotiveUnit, 5> kMotiveUnits = {{{"Meters", "m", 1.0},
                                                     {"Centimeters", "cm", 0.01},
                                                     {"Millimeters", "mm", 0.001},
                                                     {"Inches", "in", 0.0254},
                                                     {"Feet", "ft", 0.3048}}};

bool is_order_of_axes(std::string axes) {
  std::sort(axes.begin(), axes.end());
  return axes == "XYZ";
}

/// Columns of one rigid body; -1 where it has none.
struct MotiveBody {
  std::string name;
  std::array<int, 4> rotation{-1, -1, -1, -1};  ///< X, Y, Z, W
  std::array<int, 3> position{-1, -1, -1};
  record::BodyTrack track;
};

/// z up from y up.
Matrix3 quarter_turn() {
  Matrix3 R;
  R << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return R;
}

class MotiveReader {
 public:
  MotiveReader(std::string_view text, const std::string& name, const Hints& hints)
      : rest_(text), name_(name), hints_(hints) {}

  Imported read() {
    if (rest_.starts_with("Format Version;"))
      throw InputError(name_ + ":1", "", "semicolons between cells, as a spreadsheet saves them",
                       "the file as Motive exported it: commas, and decimal points");
    read_first_line(next_fields());
    read_header();
    while (!rest_.empty()) {
      const std::string_view line = next_line();
      if (!trim(line).empty()) read_row(split_csv(line, where()));
    }
    return finish();
  }

 private:
  [[nodiscard]] std::string where() const { return name_ + ":" + std::to_string(line_); }
  [[noreturn]] void fail(const std::string& column, const std::string& got, const std::string& expected) const {
    throw InputError(where(), column, got, expected);
  }

  std::string_view next_line() {
    ++line_;
    return take_line(rest_);
  }
  std::vector<std::string> next_fields() { return split_csv(next_line(), where()); }

  /// Names and values in turn.
  void read_first_line(const std::vector<std::string>& fields) {
    std::map<std::string, std::string> said;
    for (std::size_t i = 0; i + 1 < fields.size(); i += 2) said[fields[i]] = fields[i + 1];
    read_unit(said["Length Units"]);
    if (said["Coordinate Space"] == "Local")
      fail("Coordinate Space", "'Local'", "'Global', an option of the export: poses in motion capture's frame");
    rotation_ = said["Rotation Type"];
    if (rotation_.empty() || rotation_ == "Quaternion") return;
    if (!is_order_of_axes(rotation_))
      fail("Rotation Type", "'" + printable(rotation_, 40) + "'", "'Quaternion', or three axes such as 'XYZ'");
    if (!hints_.rotation.empty() && hints_.rotation != rotation_)
      fail("--rotation", "'" + printable(hints_.rotation, 40) + "'", "'" + rotation_ + "', as the header says");
  }

  /// What the header says, else what the hints do.
  void read_unit(const std::string& said) {
    const auto unit = std::find_if(kMotiveUnits.begin(), kMotiveUnits.end(), [&](const MotiveUnit& one) {
      return said.empty() ? one.word == hints_.length_unit : one.name == said;
    });
    if (unit == kMotiveUnits.end() && said.empty() && hints_.length_unit.empty())
      fail("Length Units", "nothing: the header has none", "one, by --length-unit m, cm, mm, in or ft");
    if (unit == kMotiveUnits.end())
      fail(said.empty() ? "--length-unit" : "Length Units",
           "'" + printable(said.empty() ? hints_.length_unit : said, 40) + "'",
           said.empty() ? "m, cm, mm, in or ft" : "Meters, Centimeters, Millimeters, Inches or Feet");
    if (!hints_.length_unit.empty() && hints_.length_unit != unit->word)
      fail("--length-unit", "'" + printable(hints_.length_unit, 40) + "'",
           fmt::format("'{}', as the header says", unit->word));
    unit_ = unit->metres;
  }

  /// The lines up to that of the columns: kinds of things first, their names second, what is measured last.
  void read_header() {
    std::vector<std::vector<std::string>> lines;
    while (true) {
      if (rest_.empty() || lines.size() > kMostHeaderLines)
        fail("", "no line that begins with Frame,Time (Seconds)", "the header of an export by Motive");
      std::vector<std::string> fields = next_fields();
      if (!fields.empty() && fields[0] == "Frame") {
        width_ = fields.size();
        lines.push_back(std::move(fields));
        break;
      }
      // A spreadsheet that saved the table has filled the empty line with commas.
      const bool is_empty =
          std::all_of(fields.begin(), fields.end(), [](const std::string& one) { return one.empty(); });
      if (fields.size() > 2 && !is_empty) lines.push_back(std::move(fields));
    }
    if (width_ <= 2)
      fail("", "times alone",
           "a rigid body at least: Motive exports what is ticked in its dialog, of a take that was solved");
    if (lines.size() < 4) fail("", "no lines of types, names and kinds above the columns", "an export by Motive");
    for (std::vector<std::string>& line : lines) line.resize(width_);
    const auto& types = lines[0];
    const auto& names = lines[1];
    const auto& kinds = lines[lines.size() - 2];
    const auto& axes = lines.back();
    std::map<std::string, std::size_t> at;
    for (std::size_t i = 0; i < width_; ++i) {
      if (axes[i].starts_with("Time (") || axes[i] == "Time") time_ = static_cast<int>(i);
      if (types[i] != "Rigid Body") {
        ++others_[types[i]];
        continue;
      }
      if (!is_utf8(names[i]) || names[i].empty()) fail("", "a rigid body without a name", "a name");
      const auto [found, is_new] = at.emplace(names[i], bodies_.size());
      if (is_new) bodies_.push_back({names[i], {-1, -1, -1, -1}, {-1, -1, -1}, {}});
      enter(bodies_[found->second], kinds[i], axes[i], static_cast<int>(i));
    }
    if (time_ < 0) fail("", "no column Time (Seconds)", "the header of an export by Motive");
    if (bodies_.empty())
      fail("", "no rigid body" + list_others(),
           "at least one: markers alone say no orientation; define rigid bodies in Motive and export them");
    if (rotation_.empty()) rotation_ = guess_rotation();
    for (const MotiveBody& body : bodies_) {
      const std::size_t parts = rotation_ == "Quaternion" ? 4 : 3;
      for (std::size_t k = 0; k < parts; ++k)
        if (body.rotation[k] < 0) fail(printable(body.name, 60), "a rotation that lacks columns", "all of them");
      for (const int column : body.position)
        if (column < 0) fail(printable(body.name, 60), "a position that lacks columns", "X, Y and Z");
    }
  }

  /// Of a header that does not say it: four numbers are a quaternion, three need an order.
  [[nodiscard]] std::string guess_rotation() const {
    if (std::any_of(bodies_.begin(), bodies_.end(), [](const MotiveBody& body) { return body.rotation[3] >= 0; }))
      return "Quaternion";
    if (!hints_.rotation.empty() && !is_order_of_axes(hints_.rotation))
      fail("--rotation", "'" + printable(hints_.rotation, 40) + "'", "three axes such as 'XYZ'");
    if (hints_.rotation.empty())
      fail("Rotation Type", "nothing: the header has none, and rotations are angles",
           "their order, by --rotation XYZ or another");
    return hints_.rotation;
  }

  /// Kinds of what is no rigid body, with their columns.
  [[nodiscard]] std::string list_others() const {
    std::string text;
    for (const auto& [type, columns] : others_)
      if (!type.empty() && type != "Type") text += fmt::format(", but {} columns of kind '{}'", columns, type);
    return printable(text, 60);
  }

  void enter(MotiveBody& body, const std::string& kind, const std::string& axis, int column) const {
    const std::size_t part = axis.size() == 1 ? std::string_view("XYZW").find(axis[0]) : std::string_view::npos;
    if (part == std::string_view::npos) return;
    int* place = nullptr;
    if (kind == "Rotation") place = &body.rotation[part];
    if (kind == "Position" && part < 3) place = &body.position[part];
    if (place == nullptr) return;
    if (*place >= 0) fail(printable(body.name, 60), "the column " + kind + " " + axis + " twice", "each once");
    *place = column;
  }

  [[nodiscard]] double cell(const std::vector<std::string>& fields, int column, const std::string& what) const {
    const auto at = static_cast<std::size_t>(column);
    return at < fields.size() ? read_cell(fields[at], where(), what) : std::nan("");
  }

  /// Angles of Motive turn one after the other about the axes as turned, degrees.
  [[nodiscard]] Matrix3 read_rotation(const std::array<double, 4>& v, const MotiveBody& body) const {
    if (rotation_ == "Quaternion")
      return read_quaternion(v[3], v[0], v[1], v[2], where(), body.name).toRotationMatrix();
    Matrix3 R = Matrix3::Identity();
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = rotation_[k] - 'X';
      const double angle = v[static_cast<std::size_t>(axis)] * std::numbers::pi / 180.0;
      R = R * exp_rotation(angle * Vector3::Unit(axis));
    }
    return R;
  }

  [[nodiscard]] PoseSample read_pose(const std::vector<std::string>& fields, const MotiveBody& body) const {
    const std::size_t parts = rotation_ == "Quaternion" ? 4 : 3;
    std::array<double, 4> turn{};
    Vector3 p;
    std::size_t missing = 0;
    for (std::size_t k = 0; k < parts; ++k) {
      turn[k] = cell(fields, body.rotation[k], body.name);
      missing += std::isfinite(turn[k]) ? 0 : 1;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      p[static_cast<int>(k)] = cell(fields, body.position[k], body.name);
      missing += std::isfinite(p[static_cast<int>(k)]) ? 0 : 1;
    }
    if (missing == parts + 3) return record::lost_pose();
    if (missing > 0) fail(printable(body.name, 60), "some of a pose", "all of it, or nothing where the body was lost");
    Pose X_MB{read_rotation(turn, body), unit_ * p};
    if (!(X_MB.p.cwiseAbs().maxCoeff() <= 1000.0))
      fail(printable(body.name, 60), fmt::format("a position of {:.4g} m", X_MB.p.norm()),
           "less than 1 km: is the unit of the header right?");
    if (hints_.up == UpAxis::Y) {
      const Matrix3 turned = quarter_turn();
      X_MB = {turned * X_MB.R * turned.transpose(), turned * X_MB.p};
    }
    return {X_MB.p, Quaternion(X_MB.R).normalized()};
  }

  void read_row(const std::vector<std::string>& fields) {
    if (fields.size() > width_)
      fail("", std::to_string(fields.size()) + " cells", std::to_string(width_) + ", one for each column, or fewer");
    const double time = cell(fields, time_, "Time");
    require_growth(times_, time, where());
    times_.push_back(time);
    for (MotiveBody& body : bodies_) body.track.poses.push_back(read_pose(fields, body));
  }

  Imported finish() {
    require_two_rows(times_.size(), name_);
    Imported imported;
    record::MotionCaptureLog& log = imported.recording.motion_capture;
    log.sample_frequency = rate_of(times_);
    log.times = std::move(times_);
    for (MotiveBody& body : bodies_) {
      body.track.name = body_name(body.name, hints_);
      log.bodies.push_back(std::move(body.track));
    }
    order_bodies(log, name_);
    for (const auto& [type, columns] : others_)
      if (!type.empty() && type != "Type")
        imported.remarks.push_back(fmt::format("{} columns of kind '{}' are left out", columns, printable(type, 40)));
    if (hints_.up == UpAxis::Y)
      imported.remarks.emplace_back("taken as y up, Motive's usual axes, and turned to z up; --up z: they are so");
    return imported;
  }

  std::string_view rest_;
  std::string name_;
  const Hints& hints_;
  int line_ = 0;
  double unit_ = 1.0;
  std::string rotation_;
  std::size_t width_ = 0;
  int time_ = -1;
  std::vector<MotiveBody> bodies_;
  std::map<std::string, int> others_;
  std::vector<double> times_;
};

}  // namespace

bool is_motive(std::string_view text) {
  return text.starts_with("Format Version,") || text.starts_with("\"Format Version\",") ||
         text.starts_with("Format Version;");
}

bool is_early_motive(std::string_view text) {
  if (!text.starts_with("comment,")) return false;
  const std::string_view title = take_line(text);
  return title.find("OptiTrack") != std::string_view::npos || title.find("NaturalPoint") != std::string_view::npos;
}

Imported read_motive(std::string_view text, const std::string& name, const Hints& hints) {
  return MotiveReader(text, name, hints).read();
}

}  // namespace snug::archive_import::internal
