// Messages of one frame as JSON text.
#include "snug/replay/internal/mcap_messages.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

namespace snug::replay::internal {
namespace {

/// Of the wrench's, twist's or other message about `frame`.
void put_header(JsonText& out, std::uint64_t ns, std::string_view frame) {
  out.raw("{\"header\":{\"stamp\":").time(ns).raw(",\"frame_id\":").quoted(frame).raw("}");
}

void put_stamp(JsonText& out, std::uint64_t ns) { out.raw("{\"timestamp\":").time(ns); }

// Levels of foxglove.Log.
constexpr int kInfo = 2, kWarning = 3;

int level_of(const std::string& kind) {
  static constexpr std::string_view kTroubles[] = {"lost", "no seal", "bend", "arm_contact", "protective_stop"};
  return std::find(std::begin(kTroubles), std::end(kTroubles), kind) != std::end(kTroubles) ? kWarning : kInfo;
}

}  // namespace

JsonText& JsonText::raw(std::string_view text) {
  text_ += text;
  return *this;
}

JsonText& JsonText::number(double value) {
  if (!std::isfinite(value)) return raw("null");
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value);
  return raw({text, static_cast<std::size_t>(end.ptr - text)});
}

JsonText& JsonText::integer(std::int64_t value) {
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value);
  return raw({text, static_cast<std::size_t>(end.ptr - text)});
}

JsonText& JsonText::quoted(std::string_view text) {
  const bool is_plain =
      std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; });
  if (is_plain) return raw("\"").raw(text).raw("\"");
  return raw(nlohmann::json(std::string(text)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

JsonText& JsonText::time(std::uint64_t ns) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  raw("{\"sec\":").integer(static_cast<std::int64_t>(ns / kSecond));
  return raw(",\"nsec\":").integer(static_cast<std::int64_t>(ns % kSecond)).raw("}");
}

JsonText& JsonText::vector(const Vector3& v) {
  return raw("{\"x\":").number(v.x()).raw(",\"y\":").number(v.y()).raw(",\"z\":").number(v.z()).raw("}");
}

JsonText& JsonText::quaternion(const Quaternion& q) {
  raw("{\"x\":").number(q.x()).raw(",\"y\":").number(q.y());
  return raw(",\"z\":").number(q.z()).raw(",\"w\":").number(q.w()).raw("}");
}

JsonText& JsonText::pose(const record::PoseSample& X) {
  return raw("{\"position\":").vector(X.p).raw(",\"orientation\":").quaternion(X.quat).raw("}");
}

JsonText& JsonText::transform(std::uint64_t ns, std::string_view parent, std::string_view child,
                              const record::PoseSample& X) {
  put_stamp(*this, ns);
  raw(",\"parent_frame_id\":").quoted(parent).raw(",\"child_frame_id\":").quoted(child);
  return raw(",\"translation\":").vector(X.p).raw(",\"rotation\":").quaternion(X.quat).raw("}");
}

std::uint64_t to_ns(double seconds) {
  constexpr double kLongest = 9.0e9;  // s, 285 years: ns then fit into 63 bits
  return static_cast<std::uint64_t>(std::llround(1e9 * std::clamp(seconds, 0.0, kLongest)));
}

void write_pose(JsonText& out, std::uint64_t ns, std::string_view frame, const record::PoseSample& X) {
  put_stamp(out, ns);
  out.raw(",\"frame_id\":").quoted(frame).raw(",\"pose\":").pose(X).raw("}");
}

void write_twist(JsonText& out, std::uint64_t ns, std::string_view frame, const Twist& V) {
  put_header(out, ns, frame);
  out.raw(",\"twist\":{\"linear\":").vector(V.linear).raw(",\"angular\":").vector(V.angular).raw("}}");
}

void write_wrench(JsonText& out, std::uint64_t ns, std::string_view frame, const Wrench& F) {
  put_header(out, ns, frame);
  out.raw(",\"wrench\":{\"force\":").vector(F.force).raw(",\"torque\":").vector(F.torque).raw("}}");
}

void write_cup(JsonText& out, std::uint64_t ns, const record::CupSample& cup, const record::RecordingHeader& header) {
  put_stamp(out, ns);
  out.raw(",\"vacuum\":").boolean(cup.vacuum_command).raw(",\"blow_off\":").boolean(cup.blow_off_command);
  out.raw(",\"pressure_gauge_pa\":").number(cup.pressure_gauge);
  const bool holds = cup.attached_body >= 0;
  out.raw(",\"attached_body\":").quoted(holds ? header.bodies[static_cast<std::size_t>(cup.attached_body)].name : "");
  if (holds) out.raw(",\"length_m\":").number(cup.length).raw(",\"bend_rad\":").number(cup.bend);
  out.raw("}");
}

void write_joints(JsonText& out, std::uint64_t ns, const std::vector<std::string>& names,
                  const std::vector<record::JointSample>& joints) {
  put_header(out, ns, "");
  out.raw(",\"name\":[");
  for (std::size_t i = 0; i < names.size(); ++i) out.raw(i == 0 ? "" : ",").quoted(names[i]);
  out.raw("]");
  using Part = std::pair<std::string_view, double record::JointSample::*>;
  static constexpr Part kParts[] = {{"position", &record::JointSample::position},
                                    {"velocity", &record::JointSample::velocity},
                                    {"effort", &record::JointSample::torque}};
  for (const auto& [key, part] : kParts) {
    out.raw(",").quoted(key).raw(":[");
    for (std::size_t i = 0; i < joints.size(); ++i) out.raw(i == 0 ? "" : ",").number(joints[i].*part);
    out.raw("]");
  }
  out.raw("}");
}

void write_solver(JsonText& out, std::uint64_t ns, const record::Frame& frame) {
  static constexpr std::string_view kStatus[] = {"converged", "not converged", "nothing to solve", "failed"};
  put_stamp(out, ns);
  out.raw(",\"residual\":").number(frame.solver.residual).raw(",\"iterations\":").integer(frame.solver.iterations);
  out.raw(",\"status\":").quoted(kStatus[static_cast<std::size_t>(frame.solver.status)]);
  out.raw(",\"contacts\":").integer(static_cast<std::int64_t>(frame.contacts.size())).raw("}");
}

void write_event(JsonText& out, std::uint64_t ns, const record::Event& event) {
  put_stamp(out, ns);
  std::string message = event.kind;
  if (!event.body.empty()) message += " " + event.body;
  if (!event.text.empty()) message += ": " + event.text;
  out.raw(",\"level\":").integer(level_of(event.kind)).raw(",\"message\":").quoted(message);
  out.raw(",\"name\":").quoted(event.body).raw(",\"file\":\"\",\"line\":0,\"kind\":").quoted(event.kind);
  out.raw(",\"numbers\":{");
  for (std::size_t i = 0; i < event.numbers.size(); ++i) {
    out.raw(i == 0 ? "" : ",").quoted(event.numbers[i].name).raw(":").number(event.numbers[i].value);
  }
  out.raw("}}");
}

}  // namespace snug::replay::internal
