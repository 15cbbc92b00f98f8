// read_robot: what a UR controller says of itself and its robot, without moving or switching anything.
#include "snug/remote_ur/read_robot.hpp"

#include <algorithm>

#include "snug/core/text.hpp"
#include "snug/remote_ur/rtde_client.hpp"

namespace snug::remote_ur {
namespace {

constexpr int kDashboard = 29999, kPrimary = 30001;

void read_primary(const Endpoint& endpoint, RobotReport& report) {
  Connection connection(endpoint, kPrimary);
  connection.begin_wait();
  while (true) {
    const ur::NextPacket next = ur::next_packet(connection.received());
    if (next.is_broken) connection.fail("bytes that are not those of a primary port");
    if (!next.packet) {
      connection.wait();
      continue;
    }
    if (const auto state = ur::read_robot_state(*next.packet)) {
      report.state = *state;
      return;
    }
    connection.received().erase(0, next.packet->size());  // versions, messages, states that are not whole
  }
}

void read_rtde(const Endpoint& endpoint, RobotReport& report) {
  RtdeClient client(endpoint, {"actual_q", "payload", "payload_cog", "tool_analog_input0"}, 0.0);
  report.version = client.version();
  const RtdeValues values = client.receive();
  const auto find = [&](const char* name, std::size_t count) -> const std::vector<double>* {
    const auto found = values.find(name);
    return found != values.end() && found->second.size() == count ? &found->second : nullptr;
  };
  if (const auto* q = find("actual_q", 6)) std::ranges::copy(*q, report.q.begin());
  if (const auto* payload = find("payload", 1)) report.payload = payload->front();
  if (const auto* volts = find("tool_analog_input0", 1)) report.tool_voltage = volts->front();
  if (const auto* cog = find("payload_cog", 3)) report.payload_cog = {(*cog)[0], (*cog)[1], (*cog)[2]};
}

std::string next_line(Connection& connection) {
  connection.begin_wait();
  std::size_t end = 0;
  while ((end = connection.received().find('\n')) == std::string::npos) connection.wait();
  std::string line = printable(trim(std::string_view(connection.received()).substr(0, end)), 100);
  connection.received().erase(0, end + 1);
  return line;
}

void ask_dashboard(const Endpoint& endpoint, RobotReport& report) {
  Connection connection(endpoint, kDashboard);
  (void)next_line(connection);  // its greeting
  connection.send("get robot model\n");
  const std::string model = next_line(connection);
  if (model.starts_with("UR")) report.model = model;
  connection.send("is in remote control\n");
  const std::string remote = next_line(connection);
  if (remote == "true" || remote == "false") report.is_in_remote_control = remote == "true";
}

}  // namespace

RobotReport read_robot(const Endpoint& endpoint) {
  RobotReport report;
  read_primary(endpoint, report);
  read_rtde(endpoint, report);
  ask_dashboard(endpoint, report);
  return report;
}

}  // namespace snug::remote_ur
