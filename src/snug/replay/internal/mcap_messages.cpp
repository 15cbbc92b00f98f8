// Messages of one frame as JSON.
#include "snug/replay/internal/mcap_messages.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace snug::replay::internal {
namespace {

/// Of the wrench's, twist's or other message about `frame`.
Json header_json(std::uint64_t ns, std::string_view frame) { return {{"stamp", time_json(ns)}, {"frame_id", frame}}; }

// Levels of foxglove.Log.
constexpr int kInfo = 2, kWarning = 3;

int level_of(const std::string& kind) {
  static constexpr std::string_view kTroubles[] = {"lost", "no seal", "bend", "arm_contact", "protective_stop"};
  return std::find(std::begin(kTroubles), std::end(kTroubles), kind) != std::end(kTroubles) ? kWarning : kInfo;
}

}  // namespace

std::uint64_t to_ns(double seconds) {
  constexpr double kLongest = 9.0e9;  // s, 285 years: ns then fit into 63 bits
  return static_cast<std::uint64_t>(std::llround(1e9 * std::clamp(seconds, 0.0, kLongest)));
}

std::string to_text(const Json& message) { return message.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json time_json(std::uint64_t ns) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  return {{"sec", ns / kSecond}, {"nsec", ns % kSecond}};
}

Json as_json(const Vector3& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

Json as_json(const Quaternion& q) { return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}; }

Json as_json(const record::PoseSample& X) { return {{"position", as_json(X.p)}, {"orientation", as_json(X.quat)}}; }

Json transform_json(std::uint64_t ns, std::string_view parent, std::string_view child, const record::PoseSample& X) {
  return {{"timestamp", time_json(ns)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", as_json(X.p)},
          {"rotation", as_json(X.quat)}};
}

Json pose_json(std::uint64_t ns, std::string_view frame, const record::PoseSample& X) {
  return {{"timestamp", time_json(ns)}, {"frame_id", frame}, {"pose", as_json(X)}};
}

Json twist_json(std::uint64_t ns, std::string_view frame, const Twist& V) {
  return {{"header", header_json(ns, frame)},
          {"twist", {{"linear", as_json(V.linear)}, {"angular", as_json(V.angular)}}}};
}

Json wrench_json(std::uint64_t ns, std::string_view frame, const Wrench& F) {
  return {{"header", header_json(ns, frame)}, {"wrench", {{"force", as_json(F.force)}, {"torque", as_json(F.torque)}}}};
}

Json cup_json(std::uint64_t ns, const record::CupSample& cup, const record::RecordingHeader& header) {
  const bool holds = cup.attached_body >= 0;
  Json message = {{"timestamp", time_json(ns)},
                  {"vacuum", cup.vacuum_command},
                  {"blow_off", cup.blow_off_command},
                  {"pressure_gauge_pa", cup.pressure_gauge},
                  {"attached_body", holds ? header.bodies[static_cast<std::size_t>(cup.attached_body)].name : ""}};
  if (holds) {
    message["length_m"] = cup.length;
    message["bend_rad"] = cup.bend;
  }
  return message;
}

Json joints_json(std::uint64_t ns, const std::vector<std::string>& names,
                 const std::vector<record::JointSample>& joints) {
  Json message = {{"header", header_json(ns, "")}, {"name", names}};
  using Part = std::pair<const char*, double record::JointSample::*>;
  static constexpr Part kParts[] = {{"position", &record::JointSample::position},
                                    {"velocity", &record::JointSample::velocity},
                                    {"effort", &record::JointSample::torque}};
  for (const auto& [key, part] : kParts) {
    Json& values = message[key] = Json::array();
    for (const record::JointSample& joint : joints) values.push_back(joint.*part);
  }
  return message;
}

Json joint_states_json(std::uint64_t ns, const std::vector<std::string>& names,
                       const std::vector<record::JointSample>& joints) {
  Json states = Json::array();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    states.push_back({{"name", names[i]},
                      {"position", joints[i].position},
                      {"velocity", joints[i].velocity},
                      {"effort", joints[i].torque}});
  }
  return {{"timestamp", time_json(ns)}, {"joints", std::move(states)}};
}

Json solver_json(std::uint64_t ns, const record::Frame& frame) {
  static constexpr const char* kStatus[] = {"converged", "not converged", "nothing to solve", "failed"};
  return {{"timestamp", time_json(ns)},
          {"residual", frame.solver.residual},
          {"iterations", frame.solver.iterations},
          {"status", kStatus[static_cast<std::size_t>(frame.solver.status)]},
          {"contacts", frame.contacts.size()}};
}

Json log_json(std::uint64_t ns, const record::Event& event) {
  std::string text = event.kind;
  if (!event.body.empty()) text += " " + event.body;
  if (!event.text.empty()) text += ": " + event.text;
  return {{"timestamp", time_json(ns)},
          {"level", level_of(event.kind)},
          {"message", text},
          {"name", event.body},
          {"file", ""},
          {"line", 0}};
}

Json log_with_numbers_json(std::uint64_t ns, const record::Event& event) {
  Json message = log_json(ns, event);
  message["kind"] = event.kind;
  Json& numbers = message["numbers"] = Json::object();
  for (const auto& number : event.numbers) numbers[number.name] = number.value;
  return message;
}

Json event_json(std::uint64_t ns, const record::Event& event) {
  Json numbers = Json::array();
  for (const auto& number : event.numbers) numbers.push_back({{"name", number.name}, {"value", number.value}});
  return {{"timestamp", time_json(ns)}, {"kind", event.kind}, {"body", event.body}, {"numbers", std::move(numbers)}};
}

}  // namespace snug::replay::internal
