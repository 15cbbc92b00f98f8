// answer_dashboard: what the dashboard answers to a line, and what the line does.
#include "snug/served_ur/dashboard.hpp"

#include <fmt/format.h>

#include "snug/ur/dashboard.hpp"

namespace snug::served_ur {
namespace {

using ur::DashboardCommand;

constexpr std::string_view kInstallation = "installation default.installation";  // the only one

std::string version_of(const ur::ModelFacts& model) {
  return fmt::format("URSoftware {}.{}.{}.{} (Jan 01 2020)", model.version[0], model.version[1], model.version[2],
                     model.version[3]);
}

const char* state_of(ur::RuntimeState state) {
  return state == ur::RuntimeState::Playing ? "PLAYING" : state == ur::RuntimeState::Paused ? "PAUSED" : "STOPPED";
}

std::string ask(DashboardCommand command, const Controller& controller) {
  const ur::RobotData& data = controller.data();
  switch (command) {
    case DashboardCommand::GetLoadedProgram:
      return controller.loaded_program().empty() ? "No program loaded"
                                                 : "Loaded program: /programs/" + controller.loaded_program();
    case DashboardCommand::GetOperationalMode:
      return "NONE";
    case DashboardCommand::GetRobotModel:
      return controller.model().dashboard;
    case DashboardCommand::GetSerialNumber:
      return "2000000000";
    case DashboardCommand::IsInRemoteControl:
      return "true";
    case DashboardCommand::IsProgramSaved:
      return "true " + controller.loaded_program();
    case DashboardCommand::PolyscopeVersion:
    case DashboardCommand::Version:
      return version_of(controller.model());
    case DashboardCommand::ProgramState:
      return fmt::format("{} {}", state_of(data.runtime_state),
                         controller.program_name().empty() ? "<unnamed>" : controller.program_name());
    case DashboardCommand::RobotMode:
      return fmt::format("Robotmode: {}", name_of(data.robot_mode));
    case DashboardCommand::Running:
      return fmt::format("Program running: {}", data.is_program_running());
    case DashboardCommand::SafetyMode:
      return fmt::format("Safetymode: {}", name_of(data.safety_mode));
    case DashboardCommand::SafetyStatus:
      return fmt::format("Safetystatus: {}", name_of(data.safety_mode));
    default:
      return {};
  }
}

}  // namespace

std::string dashboard_greeting() { return "Connected: Universal Robots Dashboard Server"; }

DashboardAnswer answer_dashboard(std::string_view line, Controller& controller) {
  const ur::DashboardLine said = ur::parse_dashboard(line);
  switch (said.command) {
    case DashboardCommand::PowerOn:
      controller.power_on();
      return {"Powering on"};
    case DashboardCommand::PowerOff:
      controller.power_off();
      return {"Powering off"};
    case DashboardCommand::BrakeRelease:
      controller.release_brakes();
      return {"Brake releasing"};
    case DashboardCommand::UnlockProtectiveStop:
      if (!controller.unlock_protective_stop() && controller.data().safety_mode == ur::SafetyMode::ProtectiveStop)
        return {
            "Cannot unlock protective stop until 5s after occurrence. Always inspect cause of protective stop before "
            "unlocking"};
      return {"Protective stop releasing"};
    case DashboardCommand::RestartSafety:
      controller.restart_safety();
      return {"Restarting safety"};
    case DashboardCommand::ClosePopup:
      controller.close_popup();
      return {"closing popup"};
    case DashboardCommand::Stop:
      controller.stop_program();
      return {"Stopped"};
    case DashboardCommand::Pause:
      return {controller.pause_program() ? "Pausing program" : "Failed to execute: pause"};
    case DashboardCommand::Play:
      return {controller.play() ? "Starting program" : "Failed to execute: play"};
    case DashboardCommand::CloseSafetyPopup:
      return {"closing safety popup"};
    case DashboardCommand::Popup:
      return {"showing popup"};
    case DashboardCommand::SaveLog:
      return {"Log saved to disk"};
    case DashboardCommand::AddToLog:
      return {"Added log message"};
    case DashboardCommand::ClearOperationalMode:
      return {"No longer controlling the operational mode. Current operational mode: 'NONE'."};
    case DashboardCommand::Load:
      if (said.argument == kInstallation) return {"Loading installation: default.installation"};
      return {(controller.load_program(said.argument) ? "Loading program: " : "File not found: ") + said.argument};
    case DashboardCommand::Quit:
      return {"Disconnected", true};
    case DashboardCommand::Shutdown:
      return {"Shutting down", true, true};
    default:
      break;
  }
  const std::string answer = ask(said.command, controller);
  return {answer.empty() ? fmt::format("could not understand: '{}'", said.argument) : answer};
}

}  // namespace snug::served_ur
