// RtdeLink: a controller at an address, as a plant drives it: RTDE both ways, a program through the primary port.
#pragma once

#include <optional>

#include "snug/remote_ur/compare_robot.hpp"
#include "snug/remote_ur/robot_link.hpp"
#include "snug/remote_ur/rtde_client.hpp"

namespace snug::remote_ur {

/// The controller at "ur://HOST" or "ur://HOST:N", where N is added to its ports as `snug serve --ur-port-offset N`
/// adds it. None: another kind of address. Throws InputError, about `option`, for words that begin so and are no such
/// address.
[[nodiscard]] std::optional<Endpoint> endpoint_of_ur(const std::string& address, const std::string& option = "--plant");
/// Nobody but this machine is there: 127.0.0.0/8, localhost.
[[nodiscard]] bool is_loopback_host(const std::string& host);
/// Throws InputError naming each finding that differs and what to set; TCP and payload do not count: packing sets them.
void refuse_what_differs(const std::vector<Finding>& findings, const std::string& address);

class RtdeLink final : public RobotLink {
 public:
  /// In lockstep a period is made in each exchange() and the clock stands still else: of served cells
  /// (ur::rtde::kLockstep). Throws InputError for a controller that is not there, lacks what packing needs, or whose
  /// inputs another client holds.
  explicit RtdeLink(const Endpoint& endpoint, bool is_in_lockstep = false);
  /// RTDE alone, over connections that `connect` gives: nothing can be started (tests).
  explicit RtdeLink(std::function<Connection()> connect);

  [[nodiscard]] std::string name() const override;
  [[nodiscard]] double period() const override { return is_e_series() ? 0.002 : 0.008; }
  [[nodiscard]] bool is_e_series() const override { return rtde_.version()[0] >= 5; }
  [[nodiscard]] std::string exchange(const RobotCommand& command, RobotSample& sample) override;
  [[nodiscard]] std::string start(const std::string& program) override;
  [[nodiscard]] std::string why_not() override;
  [[nodiscard]] std::string unlock() override;

 private:
  void expect_needed() const;

  Endpoint endpoint_;
  RtdeClient rtde_;
  std::optional<Connection> primary_;  ///< while a program is started
};

}  // namespace snug::remote_ur
