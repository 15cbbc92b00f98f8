// DhTable: forward kinematics, and reading a controller's deviations.
#include "snug/calibration/dh.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <vector>

#include "snug/calibration/internal/frames.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"

namespace snug::calibration {
namespace {

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::array<double, 6> parse_six(const std::string& written, const std::string& where, const std::string& key) {
  const auto refuse = [&] { throw InputError(where, key, written, "[six finite numbers]"); };
  std::array<double, 6> values{};
  if (written.size() < 2 || written.front() != '[' || written.back() != ']') refuse();
  std::istringstream parts(written.substr(1, written.size() - 2));
  std::size_t count = 0;
  for (std::string part; std::getline(parts, part, ',');) {
    const std::string word = trimmed(part);
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (count == 6 || word.empty() || error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      refuse();
    values[count++] = value;
  }
  if (count != 6) refuse();
  return values;
}

}  // namespace

Pose forward(const DhTable& table, const robot::JointVector& q) {
  Pose X;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const DhRow& row = table[i];
    const Pose along{internal::turn_z(row.theta + q(static_cast<Eigen::Index>(i))), Vector3(0.0, 0.0, row.d)};
    const Pose across{internal::turn_x(row.alpha), Vector3(row.a, 0.0, 0.0)};
    X = X * along * across;
  }
  return X;
}

DhTable add(const DhTable& a, const DhTable& b) {
  DhTable sum = a;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum[i].theta += b[i].theta;
    sum[i].d += b[i].d;
    sum[i].a += b[i].a;
    sum[i].alpha += b[i].alpha;
  }
  return sum;
}

DhTable nominal_dh(const robot::ArmModel& arm, const std::string& source) {
  if (arm.joint_count() != 6)
    throw InputError(source, "robot", std::to_string(arm.joint_count()) + " joints", "six: deltas are those of a UR");
  DhTable table;
  for (std::size_t i = 0; i < 6; ++i) {
    const robot::Joint& joint = arm.joints[i];
    const Pose X = internal::joint_origin(arm, i);
    DhRow before;
    before.alpha = std::atan2(-X.R(1, 2), X.R(2, 2));
    before.a = X.p.x();
    table[i].theta = std::atan2(-X.R(0, 1), X.R(0, 0));
    table[i].d = -std::sin(before.alpha) * X.p.y() + std::cos(before.alpha) * X.p.z();
    const Pose back = Pose{internal::turn_x(before.alpha), Vector3(before.a, 0.0, 0.0)} *
                      Pose{internal::turn_z(table[i].theta), Vector3(0.0, 0.0, table[i].d)};
    // 1 nm and 1 nrad: files round pi/2 to ten digits.
    const bool is_dh = joint.kind == robot::JointKind::Revolute && (joint.axis - Vector3::UnitZ()).norm() < 1e-9 &&
                       (back.p - X.p).norm() < 1e-9 && (back.R - X.R).norm() < 4e-9 &&
                       (i > 0 || (std::abs(before.a) < 1e-9 && std::abs(before.alpha) < 1e-9));
    if (!is_dh)
      throw InputError(source, "joint '" + joint.name + "'", "an origin that is no Denavit-Hartenberg step",
                       "the nominal URDF of a UR: xyz and rpy as Tx(a) Rx(alpha) Rz(theta) Tz(d), axis 0 0 1");
    if (i > 0) {
      table[i - 1].a = before.a;
      table[i - 1].alpha = before.alpha;
    }
  }
  return table;
}

DhTable parse_deltas(const std::string& text, const std::string& name) {
  check_utf8(text, name);
  const std::vector<std::string> keys = {"delta_theta", "delta_d", "delta_a", "delta_alpha"};
  std::array<std::optional<std::array<double, 6>>, 4> columns;
  std::istringstream lines(text);
  std::string section;
  int number = 0;
  int section_line = 1;
  for (std::string raw; std::getline(lines, raw);) {
    ++number;
    const std::string line = trimmed(raw);
    const std::string where = name + ":" + std::to_string(number);
    if (line.empty() || line.front() == '#' || line.front() == ';') continue;
    if (line.front() == '[' && line.back() == ']' && line.find('=') == std::string::npos) {
      section = line.substr(1, line.size() - 2);
      if (section == "mounting") section_line = number;
      continue;
    }
    if (section != "mounting") continue;
    const auto equals = line.find('=');
    if (equals == std::string::npos) throw InputError(where, "", line, "KEY = [six numbers]");
    const std::string key = trimmed(line.substr(0, equals));
    std::size_t column = 0;
    while (column < keys.size() && keys[column] != key) ++column;
    if (column == keys.size()) {
      const std::string_view nearest = key.starts_with("delta_") ? find_nearest(key, keys) : std::string_view();
      if (!nearest.empty()) throw InputError(where, key, "", "'" + std::string(nearest) + "'");
      continue;  // other settings of the controller
    }
    if (columns[column]) throw InputError(where, key, "a second time", "once");
    columns[column] = parse_six(trimmed(line.substr(equals + 1)), where, key);
  }
  DhTable deltas;
  for (std::size_t column = 0; column < keys.size(); ++column) {
    if (!columns[column])
      throw InputError(name + ":" + std::to_string(section_line), keys[column], "nothing",
                       "[six numbers] in section [mounting]");
    for (std::size_t i = 0; i < 6; ++i) {
      double DhRow::*const fields[] = {&DhRow::theta, &DhRow::d, &DhRow::a, &DhRow::alpha};
      deltas[i].*fields[column] = (*columns[column])[i];
    }
  }
  return deltas;
}

DhTable load_deltas(const std::filesystem::path& path) {
  return parse_deltas(read_file(path, "calibration.conf of a controller"), path.string());
}

}  // namespace snug::calibration
