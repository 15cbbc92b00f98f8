// DashboardLine: a line of the dashboard (port 29999), read.
#include "snug/ur/dashboard.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "snug/core/text.hpp"

namespace snug::ur {
namespace {

struct Words {
  std::string_view text;  ///< in small letters
  DashboardCommand command;
  bool has_argument = false;
};

constexpr std::array kCommands = {
    Words{"addtolog", DashboardCommand::AddToLog, true},
    Words{"brake release", DashboardCommand::BrakeRelease},
    Words{"clear operational mode", DashboardCommand::ClearOperationalMode},
    Words{"close popup", DashboardCommand::ClosePopup},
    Words{"close safety popup", DashboardCommand::CloseSafetyPopup},
    Words{"get loaded program", DashboardCommand::GetLoadedProgram},
    Words{"get operational mode", DashboardCommand::GetOperationalMode},
    Words{"get robot model", DashboardCommand::GetRobotModel},
    Words{"get serial number", DashboardCommand::GetSerialNumber},
    Words{"is in remote control", DashboardCommand::IsInRemoteControl},
    Words{"isprogramsaved", DashboardCommand::IsProgramSaved},
    Words{"load", DashboardCommand::Load, true},
    Words{"pause", DashboardCommand::Pause},
    Words{"play", DashboardCommand::Play},
    Words{"polyscopeversion", DashboardCommand::PolyscopeVersion},
    Words{"popup", DashboardCommand::Popup, true},
    Words{"power off", DashboardCommand::PowerOff},
    Words{"power on", DashboardCommand::PowerOn},
    Words{"programstate", DashboardCommand::ProgramState},
    Words{"quit", DashboardCommand::Quit},
    Words{"restart safety", DashboardCommand::RestartSafety},
    Words{"robotmode", DashboardCommand::RobotMode},
    Words{"running", DashboardCommand::Running},
    Words{"safetymode", DashboardCommand::SafetyMode},
    Words{"safetystatus", DashboardCommand::SafetyStatus},
    Words{"savelog", DashboardCommand::SaveLog},
    Words{"shutdown", DashboardCommand::Shutdown},
    Words{"stop", DashboardCommand::Stop},
    Words{"unlock protective stop", DashboardCommand::UnlockProtectiveStop},
    Words{"version", DashboardCommand::Version},
};

}  // namespace

DashboardLine parse_dashboard(std::string_view line) {
  const std::string_view text = trim(line);
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  for (const Words& known : kCommands) {
    if (lower == known.text) return {known.command, {}};
    if (!known.has_argument || !lower.starts_with(known.text) || lower[known.text.size()] != ' ') continue;
    return {known.command, std::string(trim(text.substr(known.text.size())))};
  }
  return {DashboardCommand::Unknown, std::string(text)};
}

}  // namespace snug::ur
