// McapExport: which message goes where and when.
#include "snug/replay/mcap_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/model/scenario.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/replay/internal/mcap_messages.hpp"
#include "snug/replay/internal/mcap_scene.hpp"
#include "snug/replay/internal/protobuf_messages.hpp"
#include "snug/replay/internal/recorded_scenario.hpp"
#include "snug/replay/internal/robot_frames.hpp"
#include "snug/replay/internal/robot_look.hpp"
#include "snug/replay/mcap_schemas.hpp"
#include "snug/robot/link_tree.hpp"

namespace snug::replay {
namespace {

using internal::Json;

/// Of the robot: viewers of MCAP run on graphics cards.
constexpr std::size_t kMostTriangles = 200'000;

/// The file and what its messages are encoded with.
struct McapSink {
  McapWriter& writer;
  internal::ProtobufMessages* protobuf;  ///< null: JSON
};

/// One topic: times grow strictly, whatever the recording's rounding and coincidences. A message that there is as JSON
/// only is JSON in every file.
class Topic {
 public:
  Topic(McapSink sink, const std::string& name, McapSchema schema)
      : writer_(sink.writer),
        protobuf_(sink.protobuf),
        type_(protobuf_ != nullptr ? protobuf_name(schema) : ""),
        id_(type_.empty()
                ? writer_.add_channel(name, schema_name(schema), schema_text(schema), McapEncoding::Json)
                : writer_.add_channel(name, type_, protobuf_->descriptors_of(type_), McapEncoding::Protobuf)) {}
  void write(std::uint64_t ns, const Json& message) {
    last_ = last_ ? std::max(ns, *last_ + 1) : ns;
    writer_.write(id_, *last_, type_.empty() ? internal::to_text(message) : protobuf_->encode(type_, message));
  }

 private:
  McapWriter& writer_;
  internal::ProtobufMessages* protobuf_;
  std::string type_;  ///< of protocol buffers; empty: JSON
  std::uint16_t id_;
  std::optional<std::uint64_t> last_;
};

std::vector<std::string> row_names(const record::RecordingHeader& header) {
  std::vector<std::string> names;
  try {
    if (header.program_text.empty()) return names;
    for (const auto& waypoint : motion::parse_program(header.program_text, header.program_name).waypoints) {
      names.push_back(motion::name_of(waypoint));
    }
  } catch (const InputError&) {  // of another version of the format: the rows then have numbers only
    names.clear();
  }
  return names;
}

class Exporter {
 public:
  Exporter(McapSink sink, const record::RecordingHeader& header, const RobotDescription& robot);
  void add(const record::Frame& frame);
  void add(const record::Event& event);

 private:
  void write_static_frames(std::uint64_t ns, const record::Frame& frame);
  void write_moving_frames(std::uint64_t ns, const record::Frame& frame);
  void write_tool(std::uint64_t ns, const record::Frame& frame);
  void write_scene(std::uint64_t ns, const record::Frame& frame);
  void write_program(std::uint64_t ns, int row);
  /// The URDF and how its links look: once, each fixed to the frame of its link.
  void write_robot(std::uint64_t ns);

  const bool is_json_;
  const record::RecordingHeader& header_;
  const RobotDescription& robot_;
  std::optional<model::Scenario> scenario_;
  std::vector<std::string> row_names_;
  Topic tf_static_, tf_, scene_, cup_scene_, events_, program_;
  Topic tool_pose_, tool_command_, tool_twist_, cup_state_, cup_wrench_, flange_wrench_, solver_;
  std::optional<Topic> joints_, event_data_, description_, robot_scene_;
  std::vector<internal::LinkLook> looks_;
  internal::RobotFrames robot_frames_;
  bool is_first_ = true;
  std::vector<bool> present_;
  std::optional<record::CupSample> drawn_cup_;
  int row_ = -1;
};

Exporter::Exporter(McapSink sink, const record::RecordingHeader& header, const RobotDescription& robot)
    : is_json_(sink.protobuf == nullptr),
      header_(header),
      robot_(robot),
      scenario_(internal::scenario_of(header)),
      row_names_(row_names(header)),
      tf_static_(sink, "/tf_static", McapSchema::FrameTransforms),
      tf_(sink, "/tf", McapSchema::FrameTransforms),
      scene_(sink, "/scene", McapSchema::SceneUpdate),
      cup_scene_(sink, "/cup/scene", McapSchema::SceneUpdate),
      events_(sink, "/events", McapSchema::Log),
      program_(sink, "/program", McapSchema::ProgramState),
      tool_pose_(sink, "/tool/pose", McapSchema::PoseInFrame),
      tool_command_(sink, "/tool/pose_command", McapSchema::PoseInFrame),
      tool_twist_(sink, "/tool/twist", McapSchema::TwistStamped),
      cup_state_(sink, "/cup/state", McapSchema::CupState),
      cup_wrench_(sink, "/cup/wrench", McapSchema::WrenchStamped),
      flange_wrench_(sink, "/flange/wrench", McapSchema::WrenchStamped),
      solver_(sink, "/solver", McapSchema::SolverState) {
  if (!header.joints.empty())
    joints_.emplace(sink, "/joint_states", is_json_ ? McapSchema::JointState : McapSchema::JointStates);
  if (!is_json_) event_data_.emplace(sink, "/events/data", McapSchema::Event);
  if (robot.urdf.empty()) return;
  description_.emplace(sink, "/robot_description", McapSchema::String);
  looks_ = internal::find_looks(header, robot, kMostTriangles);
  if (!looks_.empty()) robot_scene_.emplace(sink, "/robot/scene", McapSchema::SceneUpdate);
}

void Exporter::write_robot(std::uint64_t ns) {
  if (description_) description_->write(ns, {{"data", robot::embed_meshes(robot_.urdf, robot_.meshes)}});
  if (robot_scene_) robot_scene_->write(ns, internal::robot_message(ns, header_, looks_));
}

void Exporter::write_static_frames(std::uint64_t ns, const record::Frame& frame) {
  Json transforms = Json::array();
  robot_frames_ = internal::RobotFrames(header_, robot_.urdf, frame);
  const auto put = [&](std::string_view parent, const std::string& name, const record::PoseSample& X) {
    transforms.push_back(internal::transform_json(ns, parent, name, X));
  };
  for (const internal::LinkFrame& link : robot_frames_.still()) put(link.parent, link.child, link.X_PC);
  for (std::size_t i = 0; i < header_.bodies.size(); ++i) {
    if (header_.bodies[i].kind == record::BodyKind::Static)
      put(internal::kWorldFrame, header_.bodies[i].name, frame.bodies[i].X_WB);
  }
  if (scenario_) {
    for (const model::Frame& fixed : scenario_->frames) {
      const bool is_taken = record::find_body(header_, fixed.name) >= 0 || fixed.name == internal::kWorldFrame ||
                            fixed.name == internal::kToolFrame || fixed.name == internal::kLipFrame ||
                            fixed.name == internal::kFlangeFrame || robot_frames_.has(fixed.name);
      put(internal::kWorldFrame, is_taken ? "frame/" + fixed.name : fixed.name, record::PoseSample(fixed.X_WF));
    }
  }
  // Without a robot its flange is where the tool is; of a robot the recording does not tell where it is.
  if (header_.joints.empty()) put(internal::kToolFrame, std::string(internal::kFlangeFrame), {});
  if (!transforms.empty()) tf_static_.write(ns, {{"transforms", std::move(transforms)}});
}

void Exporter::write_moving_frames(std::uint64_t ns, const record::Frame& frame) {
  Json transforms = Json::array();
  const auto put = [&](std::string_view parent, std::string_view child, const record::PoseSample& X) {
    transforms.push_back(internal::transform_json(ns, parent, child, X));
  };
  if (!robot_frames_.has(internal::kToolFrame)) put(internal::kWorldFrame, internal::kToolFrame, frame.X_WE);
  for (const internal::LinkFrame& link : robot_frames_.moving(frame)) put(link.parent, link.child, link.X_PC);
  if (frame.cup.attached_body >= 0) put(internal::kToolFrame, internal::kLipFrame, frame.cup.X_ES);
  for (std::size_t i = 0; i < header_.bodies.size(); ++i) {
    if (header_.bodies[i].kind == record::BodyKind::Static || !frame.bodies[i].present) continue;
    put(internal::kWorldFrame, header_.bodies[i].name, frame.bodies[i].X_WB);
  }
  tf_.write(ns, {{"transforms", std::move(transforms)}});
}

void Exporter::write_tool(std::uint64_t ns, const record::Frame& frame) {
  tool_pose_.write(ns, internal::pose_json(ns, internal::kWorldFrame, frame.X_WE));
  tool_command_.write(ns, internal::pose_json(ns, internal::kWorldFrame, frame.X_WE_command));
  tool_twist_.write(ns, internal::twist_json(ns, internal::kWorldFrame, frame.V_WE));
  cup_state_.write(ns, internal::cup_json(ns, frame.cup, header_));
  cup_wrench_.write(ns, internal::wrench_json(ns, internal::kLipFrame, frame.cup.F_PSo_S));
  flange_wrench_.write(ns, internal::wrench_json(ns, internal::kFlangeFrame, frame.F_flange));
  solver_.write(ns, internal::solver_json(ns, frame));
  if (joints_) {
    joints_->write(ns, is_json_ ? internal::joints_json(ns, header_.joints, frame.joints)
                                : internal::joint_states_json(ns, header_.joints, frame.joints));
  }
}

void Exporter::write_scene(std::uint64_t ns, const record::Frame& frame) {
  std::vector<bool> present;
  for (const record::BodySample& body : frame.bodies) present.push_back(body.present);
  if (is_first_ || present != present_) scene_.write(ns, internal::scene_message(ns, header_, frame, looks_));
  present_ = std::move(present);
  if (!scenario_ || !scenario_->tool) return;
  const auto looks_alike = [](const record::CupSample& a, const record::CupSample& b) {
    if ((a.attached_body >= 0) != (b.attached_body >= 0)) return false;
    return a.attached_body < 0 || a.X_ES == b.X_ES;
  };
  if (drawn_cup_ && looks_alike(*drawn_cup_, frame.cup)) return;
  const internal::CupLook look = {scenario_->cup.lip_radius, scenario_->cup.free_length};
  cup_scene_.write(ns, internal::cup_message(ns, look, frame.cup));
  drawn_cup_ = frame.cup;
}

void Exporter::write_program(std::uint64_t ns, int row) {
  if (!is_first_ && row == row_) return;
  row_ = row;
  const bool is_named = row >= 0 && static_cast<std::size_t>(row) < row_names_.size();
  program_.write(ns, {{"timestamp", internal::time_json(ns)},
                      {"row", row},
                      {"name", is_named ? row_names_[static_cast<std::size_t>(row)] : ""}});
}

void Exporter::add(const record::Frame& frame) {
  const std::uint64_t ns = internal::to_ns(frame.time);
  if (is_first_) {
    write_static_frames(ns, frame);
    write_robot(ns);
  }
  write_moving_frames(ns, frame);
  write_scene(ns, frame);
  write_program(ns, frame.program_row);
  write_tool(ns, frame);
  is_first_ = false;
}

void Exporter::add(const record::Event& event) {
  const std::uint64_t ns = internal::to_ns(event.time);
  events_.write(ns, is_json_ ? internal::log_with_numbers_json(ns, event) : internal::log_json(ns, event));
  if (event_data_) event_data_->write(ns, internal::event_json(ns, event));
}

std::vector<record::Event> events_within(const std::vector<record::Event>& all, double from, double to) {
  std::vector<record::Event> events;
  for (const record::Event& event : all) {
    if (event.time >= from && event.time <= to) events.push_back(event);
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const record::Event& a, const record::Event& b) { return a.time < b.time; });
  return events;
}

void attach_sources(McapWriter& writer, const record::RecordingReader& reader, const std::string& name,
                    const RobotDescription& robot) {
  const record::RecordingHeader& header = reader.header();
  writer.add_metadata("snug", {{"recording", name},
                               {"snug_version", header.version},
                               {"seed", std::to_string(header.seed)},
                               {"sequence", header.sequence},
                               {"program_name", header.program_name},
                               {"settings", header.settings},
                               {"complete", reader.is_complete() ? "true" : "false"},
                               {"interrupted", reader.is_interrupted() ? "true" : "false"}});
  if (!header.scenario_text.empty()) writer.attach("scenario.yaml", "application/yaml", header.scenario_text);
  if (!header.program_text.empty()) writer.attach("program.csv", "text/csv", header.program_text);
  if (!robot.urdf.empty()) writer.attach("robot.urdf", "application/xml", robot.urdf);
  for (const robot::MeshFile& mesh : robot.meshes) {
    writer.attach(mesh.name, "application/octet-stream", mesh.bytes);
  }
  if (!reader.result().empty()) writer.attach("result.json", "application/json", reader.result());
}

}  // namespace

McapTotals export_mcap(record::RecordingReader& reader, const std::string& name, const Selection& selection,
                       OutputFile file, const McapSettings& settings, const RobotDescription& robot) {
  const std::vector<std::size_t> frames = select_frames(reader, name, selection);
  McapWriter writer(std::move(file), settings);
  std::optional<internal::ProtobufMessages> protobuf;
  if (settings.encoding == McapEncoding::Protobuf) protobuf.emplace();
  Exporter exporter({writer, protobuf ? &*protobuf : nullptr}, reader.header(), robot);
  const bool is_whole = selection == Selection{};
  const std::vector<double>& times = reader.times();
  const std::vector<record::Event> events =
      is_whole ? events_within(reader.events(), -1e300, 1e300)
               : events_within(reader.events(), times[frames.front()], times[frames.back()]);
  std::size_t next = 0;
  record::Frame frame;
  for (const std::size_t index : frames) {
    reader.read_frame(index, frame);
    for (; next < events.size() && events[next].time <= frame.time; ++next) exporter.add(events[next]);
    exporter.add(frame);
  }
  for (; next < events.size(); ++next) exporter.add(events[next]);
  attach_sources(writer, reader, name, robot);
  writer.close();
  return {writer.size(), writer.message_count(), frames.size()};
}

std::string to_text(const McapTotals& totals) {
  return fmt::format("{} frames, {} messages, {:.2f} MB", totals.frames, totals.messages,
                     static_cast<double>(totals.bytes) / 1e6);
}

}  // namespace snug::replay
