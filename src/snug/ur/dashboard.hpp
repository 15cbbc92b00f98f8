// DashboardLine: a line of the dashboard (port 29999), read.
#pragma once

#include <string>
#include <string_view>

namespace snug::ur {

enum class DashboardCommand {
  Unknown,
  AddToLog,
  BrakeRelease,
  ClearOperationalMode,
  ClosePopup,
  CloseSafetyPopup,
  GetLoadedProgram,
  GetOperationalMode,
  GetRobotModel,
  GetSerialNumber,
  IsInRemoteControl,
  IsProgramSaved,
  Load,
  Pause,
  Play,
  PolyscopeVersion,
  Popup,
  PowerOff,
  PowerOn,
  ProgramState,
  Quit,
  RestartSafety,
  RobotMode,
  Running,
  SafetyMode,
  SafetyStatus,
  SaveLog,
  Shutdown,
  Stop,
  UnlockProtectiveStop,
  Version,
};

struct DashboardLine {
  DashboardCommand command = DashboardCommand::Unknown;
  std::string argument;  ///< what stands behind the words of the command, without blanks around it
  bool operator==(const DashboardLine&) const = default;
};

/// One line without its end. Case does not count in the command's words; blanks around the line do not count.
[[nodiscard]] DashboardLine parse_dashboard(std::string_view line);

}  // namespace snug::ur
