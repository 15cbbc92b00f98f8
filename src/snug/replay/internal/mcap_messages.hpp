// Messages of one frame as JSON text: they are many, so they are put together by hand. Internal to the module.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "snug/record/recording.hpp"

namespace snug::replay::internal {

/// Name of the frame that everything else is in.
inline constexpr std::string_view kWorldFrame = "W";
inline constexpr std::string_view kToolFrame = "E";
inline constexpr std::string_view kLipFrame = "S";
inline constexpr std::string_view kFlangeFrame = "F";

/// Collects the text of one message. Numbers read back to the same double; those that are not finite become null.
class JsonText {
 public:
  void clear() { text_.clear(); }
  [[nodiscard]] const std::string& str() const { return text_; }
  /// As it is: keys, brackets and commas.
  JsonText& raw(std::string_view text);
  JsonText& number(double value);
  JsonText& integer(std::int64_t value);
  JsonText& boolean(bool value) { return raw(value ? "true" : "false"); }
  JsonText& quoted(std::string_view text);
  JsonText& time(std::uint64_t ns);             ///< {"sec":1,"nsec":2}
  JsonText& vector(const Vector3& v);           ///< {"x":1,"y":2,"z":3}
  JsonText& quaternion(const Quaternion& q);    ///< {"x":0,"y":0,"z":0,"w":1}
  JsonText& pose(const record::PoseSample& X);  ///< {"position":...,"orientation":...}
  JsonText& transform(std::uint64_t ns, std::string_view parent, std::string_view child, const record::PoseSample& X);

 private:
  std::string text_;
};

/// s to ns, rounded; times below 0 count as 0.
[[nodiscard]] std::uint64_t to_ns(double seconds);

void write_pose(JsonText& out, std::uint64_t ns, std::string_view frame, const record::PoseSample& X);
void write_twist(JsonText& out, std::uint64_t ns, std::string_view frame, const Twist& V);
void write_wrench(JsonText& out, std::uint64_t ns, std::string_view frame, const Wrench& F);
void write_cup(JsonText& out, std::uint64_t ns, const record::CupSample& cup, const record::RecordingHeader& header);
void write_joints(JsonText& out, std::uint64_t ns, const std::vector<std::string>& names,
                  const std::vector<record::JointSample>& joints);
void write_solver(JsonText& out, std::uint64_t ns, const record::Frame& frame);
void write_event(JsonText& out, std::uint64_t ns, const record::Event& event);

}  // namespace snug::replay::internal
