// Names that snug's server and its clients agree on beyond the protocol: switches, sensors, peers that only look.
#pragma once

#include <string_view>

namespace snug::click {

/// Switches of a box: it comes to the aligner when `feed` is switched on, turned by the quarter turns of the other two.
inline constexpr const char* kFeedEvent = "feed";
inline constexpr const char* kQuarterTurnEvent = "quarter_turn";
inline constexpr const char* kHalfTurnEvent = "half_turn";
/// Sensors: of the robot the tool frame E, and whether the cup holds something; of a box whether it is in the cell.
inline constexpr const char* kToolSensor = "tool";
inline constexpr const char* kHoldingSensor = "holding";
inline constexpr const char* kPresentSensor = "present";
/// For who packs the cell. Switches of the robot: its joints stand from now on, brakes closed; a protective stop is
/// released. They act when a Control names them on; one without values for the joints makes no step.
inline constexpr const char* kStandEvent = "stand";
inline constexpr const char* kAcknowledgeEvent = "acknowledge";
/// Sensors of the robot: whether it stopped for protection in the last step; pressure in the cup, gauge, as a force on
/// a square metre; the load on the tool, about Eo in E (Simulation::tool_load); what the robot's own controller
/// accelerates the tool by for an error of 1 m.
inline constexpr const char* kStoppedSensor = "stopped";
inline constexpr const char* kPressureSensor = "pressure";
/// The same along z of E, for clients that read no Force1D.
inline constexpr const char* kPressureForceSensor = "pressure_force";
inline constexpr const char* kLoadSensor = "load";
inline constexpr const char* kTrackingSensor = "tracking";
/// Sensors of a box: its axes Px, Py, Pz in W, to the last bit; its edges along them.
inline constexpr const char* kAxesSensor = "axes";
inline constexpr const char* kSizeSensor = "size";

/// Routing ids that begin so are those of peers that only look: they get their answers beside a controller.
inline constexpr std::string_view kWatcher = "watch";

}  // namespace snug::click
