// What a UR controller says of itself and what of it does not fit, as text: lines for people, JSON for programs.
#include "snug/remote_ur/report_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace snug::remote_ur {
namespace {

const char* verdict_word(Verdict verdict) {
  return verdict == Verdict::Fits ? "fits" : verdict == Verdict::Differs ? "differs" : "unknown";
}

std::string software_text(const RobotReport& robot) {
  return fmt::format("{}.{}.{}.{}", robot.version[0], robot.version[1], robot.version[2], robot.version[3]);
}

/// "0, 1" of the bits that are on; "none".
std::string bits_text(std::uint32_t bits) {
  std::string text;
  for (unsigned bit = 0; bit < 32; ++bit)
    if (((bits >> bit) & 1U) != 0) text += fmt::format("{}{}", text.empty() ? "" : ", ", bit);
  return text.empty() ? "none" : text;
}

/// "vacuum             standard output 0: off"
std::string signal_line(const char* name, const std::optional<model::DigitalIo>& io, const char* what,
                        std::uint32_t bits) {
  constexpr std::array kKinds = {"standard", "configurable", "tool"};
  if (!io) return fmt::format("{:18} not wired\n", name);
  const bool is_on = (((bits >> io->bit()) & 1U) != 0) != io->active_low;
  return fmt::format("{:18} {} {} {}: {}{}\n", name, kKinds[static_cast<std::size_t>(io->kind)], what, io->number,
                     is_on ? "on" : "off", io->active_low ? " (active low)" : "");
}

/// What the scenario's `robot.io` calls them.
std::string signals_text(const RobotReport& robot, const model::RobotIo& io) {
  std::string text = signal_line("vacuum", io.vacuum, "output", robot.state.digital_outputs) +
                     signal_line("blow-off", io.blow_off, "output", robot.state.digital_outputs) +
                     signal_line("next part", io.next_part, "output", robot.state.digital_outputs) +
                     signal_line("vacuum reached", io.vacuum_reached, "input", robot.state.digital_inputs) +
                     signal_line("part present", io.part_present, "input", robot.state.digital_inputs);
  const auto& gauge = io.vacuum_gauge;
  if (gauge && gauge->kind == model::AnalogKind::Tool && gauge->number == 0 && robot.tool_voltage)
    text += fmt::format("{:18} {:.1f} kPa\n", "vacuum gauge", 1e-3 * gauge->pressure_of(*robot.tool_voltage) + 0.0);
  return text;
}

}  // namespace

bool fits(const std::vector<Finding>& findings) {
  return std::ranges::count(findings, Verdict::Differs, &Finding::verdict) == 0;
}

std::string format_text(const RobotReport& robot, const std::vector<Finding>& findings, const model::RobotIo& io) {
  std::string text = fmt::format("model              {}, software {}\n", robot.model.empty() ? "not told" : robot.model,
                                 software_text(robot));
  text += fmt::format("outputs that are on {}\n", bits_text(robot.state.digital_outputs));
  text += fmt::format("inputs that are on  {}\n", bits_text(robot.state.digital_inputs));
  if (robot.tool_voltage) text += fmt::format("tool analog input 0 {:.2f} V\n", *robot.tool_voltage);
  text += signals_text(robot, io) + "\n";
  for (const Finding& finding : findings) {
    text += fmt::format("{:8} {:15} {}", verdict_word(finding.verdict), finding.what, finding.robot);
    if (finding.verdict != Verdict::Fits)
      text += fmt::format("; needed: {}\n{:25}{}", finding.expected, "", finding.remedy);
    text += "\n";
  }
  return text;
}

std::string format_json(const RobotReport& robot, const std::vector<Finding>& findings) {
  nlohmann::ordered_json json = {{"fits", fits(findings)},
                                 {"model", robot.model},
                                 {"version", software_text(robot)},
                                 {"robot_mode", ur::robot_mode_name(robot.state.robot_mode)},
                                 {"safety_mode", ur::safety_mode_name(robot.state.safety_mode)},
                                 {"digital_inputs", robot.state.digital_inputs},
                                 {"digital_outputs", robot.state.digital_outputs},
                                 {"joints", robot.q},
                                 {"findings", nlohmann::ordered_json::array()}};
  for (const Finding& finding : findings)
    json["findings"].push_back({{"what", finding.what},
                                {"verdict", verdict_word(finding.verdict)},
                                {"robot", finding.robot},
                                {"expected", finding.expected},
                                {"remedy", finding.remedy}});
  return json.dump() + "\n";
}

}  // namespace snug::remote_ur
