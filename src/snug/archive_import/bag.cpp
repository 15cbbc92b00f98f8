// Bags of ROS and MCAP: a program for Python writes their messages as lines, which become a recording here.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "snug/archive_import/internal/readers.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/python_interpreter.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/temporary_folder.hpp"
#include "snug/core/text.hpp"
#include "snug/core/units.hpp"
#include "snug/core/write_file.hpp"

extern char** environ;

namespace snug::archive_import::internal {
namespace {

using record::PoseSample;
using Json = nlohmann::json;

/// Periods of its own for which a body that has been seen counts as seen: between two poses farther apart it was lost.
constexpr double kPeriodsUntilLost = 4.0;
constexpr std::size_t kMostFrames = 1000;
constexpr std::array<std::string_view, 6> kUrJoints = {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                                       "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};

/// Poses of one thing on a clock of its own.
struct Stream {
  std::vector<double> times;
  std::vector<Pose> poses;

  /// Leaves out what does not come after what it has: messages that were sent twice.
  bool add(double time, const Pose& pose) {
    if (!times.empty() && !(time > times.back())) return false;
    times.push_back(time);
    poses.push_back(pose);
    return true;
  }
  [[nodiscard]] double median_period() const {
    std::vector<double> periods;
    for (std::size_t i = 1; i < times.size(); ++i) periods.push_back(times[i] - times[i - 1]);
    if (periods.empty()) return 0.0;
    const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
    std::nth_element(periods.begin(), middle, periods.end());
    return *middle;
  }
  /// Between the two poses around `time`; lost before the first, behind the last and in gaps.
  [[nodiscard]] PoseSample at(double time, double longest_gap) const {
    const auto after = std::lower_bound(times.begin(), times.end(), time);
    if (after == times.end()) return record::lost_pose();
    const auto i = static_cast<std::size_t>(after - times.begin());
    if (times[i] == time) return sample(poses[i]);
    if (i == 0 || times[i] - times[i - 1] > longest_gap) return record::lost_pose();
    const double share = (time - times[i - 1]) / (times[i] - times[i - 1]);
    const Pose &a = poses[i - 1], &b = poses[i];
    const Matrix3 R = a.R * exp_rotation(share * log_rotation(a.R.transpose() * b.R));
    return sample({R, a.p + share * (b.p - a.p)});
  }
  static PoseSample sample(const Pose& pose) { return {pose.p, Quaternion(pose.R).normalized()}; }
};

class BagReader {
 public:
  BagReader(std::string_view lines, const std::string& name, const Hints& hints)
      : rest_(lines), name_(name), hints_(hints) {}

  Imported read() {
    for (line_ = 1; !rest_.empty(); ++line_) read_line(take_line(rest_));
    follow_frames();
    finish_bodies();
    finish_wrench();
    const record::ArchiveRecording& recording = imported_.recording;
    if (recording.motion_capture.times.empty() && recording.force_torque.times.empty() && recording.robot.times.empty())
      throw InputError(name_, "", "no two messages to take" + list_left("; there are "),
                       "JointState, WrenchStamped, PoseStamped, TransformStamped or TFMessage");
    if (!left_.empty()) imported_.remarks.push_back("left out" + list_left(": "));
    if (without_rotation_ > 0)
      imported_.remarks.push_back(
          fmt::format("poses whose quaternion is (0, 0, 0, 0) count as lost: {}", without_rotation_));
    return std::move(imported_);
  }

 private:
  [[noreturn]] void fail(const std::string& got, const std::string& expected) const {
    throw InputError(name_, fmt::format("message {}", line_), got, expected);
  }
  /// Topics with their kinds, or where they are many the kinds with how many topics each has.
  [[nodiscard]] std::string list_left(const std::string& before) const {
    constexpr std::size_t kLongestList = 100;
    std::string topics, kinds;
    for (const auto& [kind, names] : left_) {
      for (const std::string& name : names) topics += (topics.empty() ? "" : ", ") + name + " (" + kind + ")";
      kinds += (kinds.empty() ? "" : ", ") + (names.size() == 1 ? kind : fmt::format("{} of {}", names.size(), kind));
    }
    if (topics.empty()) return "";
    return before + printable(topics.size() <= kLongestList ? topics : kinds, kLongestMessage / 2);
  }

  [[nodiscard]] std::string text_of(const Json& value) const {
    if (!value.is_string()) fail("a name that is no text", "a text");
    const auto text = value.get<std::string>();
    if (!is_printable(text)) fail("a name that is not printable", "a name");
    return text;
  }
  [[nodiscard]] static double number_of(const Json& value) { return value.is_number() ? value.get<double>() : kNaN; }

  void read_line(std::string_view line) {
    if (trim(line).empty()) return;
    const Json row = Json::parse(line, nullptr, false);
    if (!row.is_array() || row.size() < 3 || !row[0].is_string()) fail("a line that is none", "a message");
    const auto word = row[0].get<std::string>();
    const std::string topic = text_of(row[1]);
    if (word == "left") {
      left_[text_of(row[2])].insert(topic);
      return;
    }
    if (word == "said") return imported_.remarks.push_back(topic);
    if (!row[2].is_number_integer()) fail("no time", "a time in ns");
    const double time = 1e-9 * static_cast<double>(row[2].get<std::int64_t>());
    if (word == "joints" && row.size() == 7) return read_joints(topic, time, row);
    if (word == "wrench" && row.size() == 5) return read_wrench(topic, time, row[4]);
    if (word == "pose" && row.size() == 5) {
      pose_frames_[text_of(row[3])].insert(topic);
      if (const auto pose = read_pose(row[4])) poses_[topic].add(time, *pose);
      return;
    }
    if (word == "transform" && row.size() == 6) return read_transform(time, row);
    fail("a line that is none", "a message");
  }

  /// Nothing where a number is missing, or the rotation, which trackers leave at zero for a body that they lost.
  std::optional<Pose> read_pose(const Json& values) {
    if (!values.is_array() || values.size() != 7) fail("a pose without seven numbers", "position and quaternion");
    std::array<double, 7> v{};
    for (std::size_t k = 0; k < 7; ++k) v[k] = number_of(values[k]);
    if (!std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); })) return std::nullopt;
    const Vector3 p(v[0], v[1], v[2]);
    if (!(p.cwiseAbs().maxCoeff() <= 1000.0)) fail("a position beyond 1 km", "metres");
    if (v[3] == 0.0 && v[4] == 0.0 && v[5] == 0.0 && v[6] == 0.0) {
      ++without_rotation_;
      return std::nullopt;
    }
    const Quaternion quat = read_quaternion(v[6], v[3], v[4], v[5], name_, fmt::format("message {}", line_));
    return Pose{quat.toRotationMatrix(), p};
  }

  /// Order of the joints: as asked for, else the UR's from base to tool, else the message's.
  [[nodiscard]] std::vector<std::string> order_joints(const std::vector<std::string>& names) const {
    if (!hints_.joints.empty()) return hints_.joints;
    std::vector<std::string> ordered;
    for (const std::string_view joint : kUrJoints) {
      const auto found = std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.ends_with(joint); });
      if (found != names.end()) ordered.push_back(*found);
    }
    return ordered.size() == kUrJoints.size() ? ordered : names;
  }

  void read_joints(const std::string& topic, double time, const Json& row) {
    if (!row[3].is_array() || row[3].size() > kMostColumns / 4) fail("joints without names, or too many", "names");
    std::vector<std::string> names;
    for (const Json& joint : row[3]) names.push_back(text_of(joint));
    record::RobotLog& robot = imported_.recording.robot;
    if (joints_.empty()) {
      joint_topic_ = topic;
      joints_ = order_joints(names);
      if (joints_.empty()) return;
      for (std::size_t i = 0; i < joints_.size(); ++i) {
        robot.names.push_back(fmt::format("actual_q_{}", i));
        joint_list_ += (i == 0 ? "" : ", ") + joints_[i];
      }
      for (std::size_t i = 0; i < joints_.size(); ++i) robot.names.push_back(fmt::format("actual_qd_{}", i));
      robot.columns.resize(robot.names.size());
      imported_.remarks.push_back("joints, base to tool: " + printable(joint_list_, 200));
    }
    if (topic != joint_topic_) {
      left_["joints beside those of " + joint_topic_].insert(topic);
      return;
    }
    std::vector<double> values;
    for (const std::size_t part : {std::size_t{4}, std::size_t{5}}) {
      for (const std::string& joint : joints_) {
        const auto found = std::find(names.begin(), names.end(), joint);
        if (found == names.end()) return;  // a message of other joints on the same topic
        const auto at = static_cast<std::size_t>(found - names.begin());
        values.push_back(row[part].is_array() && at < row[part].size() ? number_of(row[part][at]) : kNaN);
      }
    }
    if (!robot.times.empty() && !(time > robot.times.back())) return;
    robot.times.push_back(time);
    for (std::size_t i = 0; i < values.size(); ++i) robot.columns[i].push_back(values[i]);
  }

  void read_wrench(const std::string& topic, double time, const Json& values) {
    if (!values.is_array() || values.size() != 6) fail("a wrench without six numbers", "force and torque");
    Vector6 v;
    for (std::size_t k = 0; k < 6; ++k) v[static_cast<int>(k)] = number_of(values[k]);
    if (!v.allFinite()) return;
    record::WrenchLog& log = wrenches_[topic];
    if (!log.times.empty() && !(time > log.times.back())) return;
    log.times.push_back(time);
    log.wrenches.push_back({v.head<3>(), v.tail<3>()});
  }

  void read_transform(double time, const Json& row) {
    const std::string parent = text_of(row[3]), child = text_of(row[4]);
    const auto pose = read_pose(row[5]);
    if (!pose || parent == child) return;
    if (!frames_.contains(child) && frames_.size() == kMostFrames) fail("more than 1000 frames", "fewer");
    frames_[child].parent = parent;  // of a frame that moves to another parent the last counts
    frames_[child].stream.add(time, *pose);
  }

  struct FrameOfBag {
    std::string parent;
    Stream stream;
  };

  /// The frames from `child` up to the root, or up to the fixed frame; empty where a circle is in the way or the
  /// fixed frame is not above.
  [[nodiscard]] std::vector<std::string> chain_of(const std::string& child) const {
    std::vector<std::string> chain = {child};
    while (chain.back() != hints_.fixed_frame) {
      const auto frame = frames_.find(chain.back());
      if (frame == frames_.end()) break;
      chain.push_back(frame->second.parent);
      if (chain.size() > kMostFrames) return {};
    }
    if (!hints_.fixed_frame.empty() && chain.back() != hints_.fixed_frame) return {};
    return chain;
  }

  /// Frames that move, in the root of their tree, at the times of their own messages.
  void follow_frames() {
    std::set<std::string> roots;
    for (const auto& [child, frame] : frames_) {
      if (frame.stream.times.size() < 2) continue;  // fixed
      const std::vector<std::string> chain = chain_of(child);
      if (chain.size() < 2) continue;
      roots.insert(chain.back());
      Stream in_root;
      for (std::size_t i = 0; i < frame.stream.times.size(); ++i) {
        Pose X;
        bool is_known = true;
        for (std::size_t k = 0; k + 1 < chain.size() && is_known; ++k) {
          const Stream& link = frames_.at(chain[k]).stream;
          const PoseSample sample = link.times.size() == 1
                                        ? Stream::sample(link.poses[0])
                                        : link.at(frame.stream.times[i], kPeriodsUntilLost * link.median_period());
          is_known = record::is_tracked(sample);
          if (is_known) X = sample.pose() * X;
        }
        if (is_known) in_root.add(frame.stream.times[i], X);
      }
      poses_[child] = std::move(in_root);
    }
    if (roots.size() > 1) {
      std::string names;
      for (const std::string& root : roots) names += (names.empty() ? "" : ", ") + root;
      throw InputError(name_, "--fixed-frame", "trees of frames with several roots: " + printable(names, 150),
                       "the one in which poses are wanted");
    }
    for (const std::string& root : roots)
      imported_.remarks.push_back("poses of frames are in '" + printable(root, 60) + "'");
  }

  /// "/vrpn_mocap/box1/pose" is box1.
  [[nodiscard]] static std::string body_of_topic(const std::string& topic) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin < topic.size();) {
      const std::size_t end = std::min(topic.find('/', begin), topic.size());
      if (end > begin) parts.push_back(topic.substr(begin, end - begin));
      begin = end + 1;
    }
    while (parts.size() > 1 && (parts.back() == "pose" || parts.back() == "pose_stamped")) parts.pop_back();
    return parts.empty() ? topic : parts.back();
  }

  void finish_bodies() {
    record::ArchiveRecording& recording = imported_.recording;
    std::erase_if(poses_, [](const auto& one) { return one.second.times.size() < 2; });
    if (!hints_.tool.empty()) take_tool();
    if (recording.robot.times.size() < 2) recording.robot = {};
    tell_pose_frames();
    if (poses_.empty()) return;
    const Stream* most = nullptr;
    for (const auto& [name, stream] : poses_)
      if (most == nullptr || stream.times.size() > most->times.size()) most = &stream;
    record::MotionCaptureLog& log = recording.motion_capture;
    log.times = most->times;
    log.sample_frequency = rate_of(log.times);
    for (const auto& [name, stream] : poses_) {
      record::BodyTrack track{body_name(hints_.names.contains(name) ? name : body_of_topic(name), hints_), {}};
      const double gap = kPeriodsUntilLost * stream.median_period();
      for (const double time : log.times) track.poses.push_back(stream.at(time, gap));
      if (std::any_of(track.poses.begin(), track.poses.end(), record::is_tracked))
        log.bodies.push_back(std::move(track));
    }
    order_bodies(log, name_);
  }

  /// Poses of topics are taken as they are, in whatever frame each has.
  void tell_pose_frames() {
    std::erase_if(pose_frames_, [](const auto& one) { return one.first.empty(); });
    if (pose_frames_.empty()) return;
    std::string frames;
    for (const auto& [frame, topics] : pose_frames_)
      frames +=
          fmt::format("{}'{}'{}", frames.empty() ? "" : ", ", frame,
                      pose_frames_.size() == 1 ? "" : " (" + *topics.begin() + (topics.size() > 1 ? ", ...)" : ")"));
    imported_.remarks.push_back("poses of topics are in " + printable(frames, 150) +
                                (pose_frames_.size() > 1 ? ": they stay so" : ""));
  }

  /// The tool on the clock of the joints; on its own where there are none.
  void take_tool() {
    const auto found = poses_.find(hints_.tool);
    if (found == poses_.end()) {
      std::vector<std::string> names;
      for (const auto& [name, stream] : poses_) names.push_back(name);
      const std::string_view nearest = find_nearest(hints_.tool, names);
      throw InputError(name_, "--tool", "'" + printable(hints_.tool, 60) + "', of which there are no poses",
                       nearest.empty() ? "a topic of poses or a frame that moves" : "'" + std::string(nearest) + "'");
    }
    record::RobotLog& robot = imported_.recording.robot;
    const Stream& stream = found->second;
    if (robot.times.size() < 2) robot = {stream.times, {}, {}, {}};
    for (const double time : robot.times)
      robot.tool.push_back(stream.at(time, kPeriodsUntilLost * stream.median_period()));
    poses_.erase(found);
  }

  void finish_wrench() {
    std::erase_if(wrenches_, [](const auto& one) { return one.second.times.size() < 2; });
    auto chosen = wrenches_.begin();
    if (!hints_.wrench.empty()) {
      chosen = wrenches_.find(hints_.wrench);
      if (chosen == wrenches_.end())
        throw InputError(
            name_, "--wrench", "'" + printable(hints_.wrench, 60) + "', which has no wrenches",
            wrenches_.empty() ? "nothing: the bag has none" : "'" + printable(wrenches_.begin()->first, 60) + "'");
    } else if (wrenches_.size() > 1) {
      std::string topics;
      for (const auto& [topic, log] : wrenches_) topics += (topics.empty() ? "" : ", ") + topic;
      throw InputError(name_, "--wrench", "several topics with wrenches: " + printable(topics, 150), "one of them");
    }
    if (chosen == wrenches_.end()) return;
    imported_.recording.force_torque = std::move(chosen->second);
    turn_wrenches(imported_.recording, hints_);
  }

  std::string_view rest_;
  std::string name_;
  const Hints& hints_;
  int line_ = 0;
  Imported imported_;
  std::map<std::string, Stream> poses_;  ///< by topic, or by frame
  std::map<std::string, FrameOfBag> frames_;
  std::map<std::string, record::WrenchLog> wrenches_;
  std::vector<std::string> joints_;
  std::string joint_topic_, joint_list_;
  std::map<std::string, std::set<std::string>> left_;         ///< topics by kind
  std::map<std::string, std::set<std::string>> pose_frames_;  ///< topics of poses by the frame of their headers
  std::size_t without_rotation_ = 0;
};

/// Runs Python on the program, what it says into `said`; its exit code, or -1 and why it did not start.
int run_python(const std::filesystem::path& program, const std::filesystem::path& bag,
               const std::filesystem::path& lines, const std::filesystem::path& said, std::string& trouble) {
  std::vector<std::string> words = {python_interpreter(), program.string(), bag.string(), lines.string()};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 2, said.c_str(), O_WRONLY | O_CREAT, 0600);
  pid_t process = -1;
  const int reason = ::posix_spawnp(&process, argv[0], &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  trouble = reason == 0 ? "" : std::strerror(reason);
  if (reason != 0) return -1;
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 2;
}

}  // namespace

Imported read_bag_lines(std::string_view lines, const std::string& name, const Hints& hints) {
  return BagReader(lines, name, hints).read();
}

Imported load_bag(const std::filesystem::path& path, const Hints& hints) {
  const std::string name = path.string();
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(name, "", "no such file", "MCAP, or a bag of ROS");
  const TemporaryFolder folder("snug-bag-");
  const std::filesystem::path lines = folder.path() / "lines", said = folder.path() / "said";
  write_file(folder.path() / "read_bag.py", kBagProgram);
  std::string trouble;
  const int code = run_python(folder.path() / "read_bag.py", std::filesystem::absolute(path), lines, said, trouble);
  if (code < 0)
    throw InputError(name, "", "'" + python_interpreter() + "' cannot be started: " + trouble,
                     "a Python 3, named by SNUG_PYTHON, which reads bags");
  std::string words = code == 0 ? "" : read_file(said, "what Python says");
  while (!words.empty() && words.back() == '\n') words.pop_back();
  if (code == 3)
    throw InputError(name, "", "a bag, and a Python (" + python_interpreter() + ") that has no reader for it",
                     "one that has, named by SNUG_PYTHON: python3 -m venv venv && venv/bin/pip install " + words +
                         "; then SNUG_PYTHON=venv/bin/python");
  if (code != 0)
    throw InputError(name, "", "a bag that cannot be read: " + printable_end(words, 200), "a bag that is whole");
  return read_bag_lines(read_file(lines, "messages", kLargestTable), name, hints);
}

}  // namespace snug::archive_import::internal
