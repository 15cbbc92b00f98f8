// Messages of one frame as JSON. Internal to the module.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "snug/record/recording.hpp"

namespace snug::replay::internal {

using Json = nlohmann::ordered_json;

/// Name of the frame that everything else is in.
inline constexpr std::string_view kWorldFrame = "W";
inline constexpr std::string_view kToolFrame = "E";
inline constexpr std::string_view kLipFrame = "S";
inline constexpr std::string_view kFlangeFrame = "F";

/// s to ns, rounded; times below 0 count as 0.
[[nodiscard]] std::uint64_t to_ns(double seconds);

/// The text of a message. Numbers read back to the same double; those that are not finite become null.
[[nodiscard]] std::string to_text(const Json& message);

[[nodiscard]] Json time_json(std::uint64_t ns);           ///< {"sec":1,"nsec":2}
[[nodiscard]] Json as_json(const Vector3& v);             ///< {"x":1,"y":2,"z":3}
[[nodiscard]] Json as_json(const Quaternion& q);          ///< {"x":0,"y":0,"z":0,"w":1}
[[nodiscard]] Json as_json(const record::PoseSample& X);  ///< {"position":...,"orientation":...}

[[nodiscard]] Json transform_json(std::uint64_t ns, std::string_view parent, std::string_view child,
                                  const record::PoseSample& X);
[[nodiscard]] Json pose_json(std::uint64_t ns, std::string_view frame, const record::PoseSample& X);
[[nodiscard]] Json twist_json(std::uint64_t ns, std::string_view frame, const Twist& V);
[[nodiscard]] Json wrench_json(std::uint64_t ns, std::string_view frame, const Wrench& F);
[[nodiscard]] Json cup_json(std::uint64_t ns, const record::CupSample& cup, const record::RecordingHeader& header);
[[nodiscard]] Json joints_json(std::uint64_t ns, const std::vector<std::string>& names,
                               const std::vector<record::JointSample>& joints);
/// The same as foxglove.JointStates.
[[nodiscard]] Json joint_states_json(std::uint64_t ns, const std::vector<std::string>& names,
                                     const std::vector<record::JointSample>& joints);
[[nodiscard]] Json solver_json(std::uint64_t ns, const record::Frame& frame);
/// foxglove.Log.
[[nodiscard]] Json log_json(std::uint64_t ns, const record::Event& event);
/// The same with `kind` and `numbers`.
[[nodiscard]] Json log_with_numbers_json(std::uint64_t ns, const record::Event& event);
/// What foxglove.Log does not have fields for, as snug.Event.
[[nodiscard]] Json event_json(std::uint64_t ns, const record::Event& event);

}  // namespace snug::replay::internal
