// Logs of mc_rtc in its flat form: each column whole, one after the other.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>

#include "snug/archive_import/internal/readers.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/core/units.hpp"

namespace snug::archive_import::internal {
namespace {

using record::PoseSample;

constexpr std::size_t kMostEntries = 100'000;
constexpr std::size_t kLongestName = 1000;
constexpr std::array<const char*, 6> kCoupleAndForce = {"_cx", "_cy", "_cz", "_fx", "_fy", "_fz"};
constexpr std::array<const char*, 7> kQuaternionAndPosition = {"_qw", "_qx", "_qy", "_qz", "_tx", "_ty", "_tz"};
constexpr std::array<const char*, 7> kFloatingBase = {"_FloatingBase_orientation_w", "_FloatingBase_orientation_x",
                                                      "_FloatingBase_orientation_y", "_FloatingBase_orientation_z",
                                                      "_FloatingBase_position_x",    "_FloatingBase_position_y",
                                                      "_FloatingBase_position_z"};

class FlatReader {
 public:
  FlatReader(std::string_view bytes, const std::string& name, const Hints& hints)
      : rest_(bytes), name_(name), hints_(hints) {}

  Imported read() {
    read_entries();
    const auto time = columns_.find("t");
    if (time == columns_.end()) fail("t", "no such entry", "the time in s, which mc_rtc logs as 't'");
    times_ = time->second;
    for (std::size_t i = 0; i < times_.size(); ++i) {
      if (!std::isfinite(times_[i]) || (i > 0 && !(times_[i] > times_[i - 1])))
        fail("t", fmt::format("{} s at index {}", times_[i], i), "times that grow");
    }
    if (times_.size() < 2) fail("t", std::to_string(times_.size()) + " instants", "two or more");
    for (const auto& [entry, values] : columns_) {
      if (values.size() != times_.size())
        fail(entry, std::to_string(values.size()) + " values", std::to_string(times_.size()) + ", one for each time");
    }
    take_bodies();
    take_wrench();
    take_joints();
    if (imported_.recording.motion_capture.times.empty() && imported_.recording.force_torque.times.empty() &&
        imported_.recording.robot.times.empty())
      fail("", "no pose of a robot, no force sensor, no joints",
           "entries like box013_FloatingBase_position_x, box013_ff_tx, UR10FTSensor_fx or qIn_0");
    turn_wrenches(imported_.recording, hints_);
    return std::move(imported_);
  }

 private:
  [[noreturn]] void fail(const std::string& entry, const std::string& got, const std::string& expected) const {
    throw InputError(name_, printable(entry, 60), got, expected);
  }
  [[noreturn]] void fail_cut() const {
    fail("", fmt::format("an end after {} entries", columns_.size() + texts_), "a log that is whole");
  }

  std::string_view take(std::uint64_t size) {
    if (size > rest_.size()) fail_cut();
    const std::string_view part = rest_.substr(0, static_cast<std::size_t>(size));
    rest_.remove_prefix(part.size());
    return part;
  }
  /// Little-endian, as all machines that mc_rtc runs on have it.
  std::uint64_t take_size() {
    std::uint64_t size = 0;
    const std::string_view bytes = take(8);
    for (std::size_t i = 8; i > 0; --i) size = size << 8U | static_cast<unsigned char>(bytes[i - 1]);
    return size;
  }

  void read_entries() {
    const std::uint64_t entries = take_size();
    if (entries == 0 || entries > kMostEntries)
      fail("", fmt::format("{} entries", entries), "a flat log of mc_rtc with 1 to 100000");
    for (std::uint64_t i = 0; i < entries; ++i) {
      const char is_numeric = take(1)[0];
      if (is_numeric != 0 && is_numeric != 1) fail("", "an entry that is neither numbers nor texts", "a flat log");
      const std::uint64_t length = take_size();
      if (length > kLongestName) fail("", fmt::format("a name of {} bytes", length), "a flat log of mc_rtc");
      const std::string entry(take(length));
      if (!is_printable(entry)) fail("", "a name that is not printable", "a flat log of mc_rtc");
      const std::uint64_t count = take_size();
      if (is_numeric == 0) {
        if (count > rest_.size() / 8) fail_cut();
        for (std::uint64_t k = 0; k < count; ++k) (void)take(take_size());
        ++texts_;
        continue;
      }
      if (count > rest_.size() / 8) fail_cut();
      std::vector<double> values(static_cast<std::size_t>(count));
      const std::string_view bytes = take(8 * count);
      if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
      if (!columns_.emplace(entry, std::move(values)).second) fail(entry, "the entry twice", "each once");
    }
    if (!rest_.empty()) fail("", fmt::format("{} bytes behind the last entry", rest_.size()), "a log that ends there");
  }

  template <std::size_t kCount>
  [[nodiscard]] std::optional<std::array<const std::vector<double>*, kCount>> find(
      const std::string& prefix, const std::array<const char*, kCount>& endings) const {
    std::array<const std::vector<double>*, kCount> found{};
    for (std::size_t k = 0; k < kCount; ++k) {
      const auto column = columns_.find(prefix + endings[k]);
      if (column == columns_.end()) return std::nullopt;
      found[k] = &column->second;
    }
    return found;
  }

  void take_bodies() {
    record::MotionCaptureLog& log = imported_.recording.motion_capture;
    for (const auto& [entry, values] : columns_) {
      for (const auto& [endings, mark] : {std::pair(&kFloatingBase, std::string_view("_FloatingBase_orientation_w")),
                                          std::pair(&kQuaternionAndPosition, std::string_view("_ff_qw"))}) {
        if (!entry.ends_with(mark) || entry.size() == mark.size()) continue;
        const std::string body = entry.substr(0, entry.size() - mark.size());
        const auto columns = find(endings == &kFloatingBase ? body : body + "_ff", *endings);
        if (!columns) fail(body, "some of the columns of a pose", "all seven");
        log.bodies.push_back({name_of(body), read_poses(*columns, body)});
      }
    }
    if (log.bodies.empty()) return;
    log.times = times_;
    log.sample_frequency = rate_of(times_);
    order_bodies(log, name_);
  }

  /// "box013" of logs is "Box013" of archives, as in validation::load_log.
  [[nodiscard]] std::string name_of(const std::string& body) const {
    std::string name = body_name(body, hints_);
    if (name.size() > 3 && name.starts_with("box") && name[3] >= '0' && name[3] <= '9') name[0] = 'B';
    return name;
  }

  /// mc_rtc's rotations map the world to the body.
  [[nodiscard]] std::vector<PoseSample> read_poses(const std::array<const std::vector<double>*, 7>& columns,
                                                   const std::string& body) const {
    std::vector<PoseSample> poses;
    for (std::size_t i = 0; i < times_.size(); ++i) {
      std::array<double, 7> v{};
      for (std::size_t k = 0; k < 7; ++k) v[k] = (*columns[k])[i];
      const auto missing = std::count_if(v.begin(), v.end(), [](double x) { return !std::isfinite(x); });
      if (missing > 0 && missing < 7)
        fail(body, fmt::format("some of a pose at index {}", i), "all seven numbers, or none where it was not logged");
      if (missing > 0) {
        poses.push_back(record::lost_pose());
        continue;
      }
      const Vector3 p(v[4], v[5], v[6]);
      if (!(p.cwiseAbs().maxCoeff() <= 1000.0))
        fail(body, fmt::format("a position beyond 1 km at index {}", i), "metres");
      poses.push_back({p, read_quaternion(v[0], v[1], v[2], v[3], name_, body).conjugate()});
    }
    return poses;
  }

  void take_wrench() {
    std::vector<std::string> sensors;
    for (const auto& [entry, values] : columns_) {
      if (!entry.ends_with("_cx")) continue;
      const std::string sensor = entry.substr(0, entry.size() - 3);
      if (find(sensor, kCoupleAndForce)) sensors.push_back(sensor);
    }
    const auto is_there = [&](const std::string& name) {
      return std::find(sensors.begin(), sensors.end(), name) != sensors.end();
    };
    std::string chosen = hints_.wrench;
    if (!chosen.empty() && !is_there(chosen)) {
      const std::string_view nearest = find_nearest(chosen, sensors);
      fail("--wrench", "'" + printable(chosen, 60) + "'",
           nearest.empty() ? "a sensor of the log" : std::string(nearest));
    }
    if (chosen.empty() && is_there("UR10FTSensor")) chosen = "UR10FTSensor";
    if (chosen.empty() && sensors.size() == 1) chosen = sensors.front();
    if (chosen.empty()) {
      for (const std::string& sensor : sensors)
        imported_.remarks.push_back(fmt::format("'{}' has forces; --wrench {} takes them", sensor, sensor));
      return;
    }
    record::WrenchLog& log = imported_.recording.force_torque;
    const auto columns = *find(chosen, kCoupleAndForce);
    for (std::size_t i = 0; i < times_.size(); ++i) {
      Vector6 v;
      for (std::size_t k = 0; k < 6; ++k) v[static_cast<int>(k)] = (*columns[k])[i];
      if (!v.allFinite()) continue;  // not logged then
      log.times.push_back(times_[i]);
      log.wrenches.push_back({v.tail<3>(), v.head<3>()});
    }
    if (log.times.size() < 2) log = {};
  }

  void take_joints() {
    record::RobotLog& robot = imported_.recording.robot;
    for (const auto& [entry, name] :
         {std::pair("qIn_", "actual_q_"), std::pair("alphaIn_", "actual_qd_"), std::pair("tauIn_", "actual_tau_")}) {
      for (std::size_t joint = 0; joint < kMostColumns / 4; ++joint) {
        const auto column = columns_.find(entry + std::to_string(joint));
        if (column == columns_.end()) break;
        robot.names.push_back(name + std::to_string(joint));
        robot.columns.push_back(column->second);
      }
    }
    if (!robot.names.empty()) robot.times = times_;
  }

  std::string_view rest_;
  std::string name_;
  const Hints& hints_;
  std::map<std::string, std::vector<double>> columns_;
  std::size_t texts_ = 0;
  std::vector<double> times_;
  Imported imported_;
};

}  // namespace

Imported read_flat_log(std::string_view bytes, const std::string& name, const Hints& hints) {
  return FlatReader(bytes, name, hints).read();
}

}  // namespace snug::archive_import::internal
