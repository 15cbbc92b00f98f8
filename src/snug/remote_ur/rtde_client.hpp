// RtdeClient: a client of a controller's real-time data exchange (port 30004), version 2.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "snug/remote_ur/connection.hpp"
#include "snug/ur/rtde.hpp"

namespace snug::remote_ur {

/// Numbers of a data package by the names of the outputs; vectors have three or six.
using RtdeValues = std::map<std::string, std::vector<double>, std::less<>>;

/// Throws as Connection.
class RtdeClient {
 public:
  /// Connects, agrees on the version and asks for `outputs` at `frequency` (Hz; 0: the controller's most). Those that
  /// the controller does not know are left out: older software has fewer. `inputs`: what send() sets; one that the
  /// controller does not know, or that another client holds, is a failure.
  RtdeClient(const Endpoint& endpoint, const std::vector<std::string>& outputs, double frequency,
             const std::vector<std::string>& inputs = {});
  /// `connect`: called once, and again where the controller does not know an output.
  RtdeClient(std::function<Connection()> connect, const std::vector<std::string>& outputs, double frequency,
             const std::vector<std::string>& inputs = {});

  /// Major, minor, bugfix, build.
  [[nodiscard]] const std::array<std::uint32_t, 4>& version() const { return version_; }
  [[nodiscard]] const std::vector<std::string>& unknown() const { return unknown_; }
  /// The next data package.
  [[nodiscard]] RtdeValues receive();
  /// A number for each of the inputs.
  void send(std::span<const double> values);

 private:
  struct Output {
    std::string name;
    char kind = 'd';  ///< of each number: d double, i int32, u uint32, q uint64, b byte
    std::size_t count = 1;
  };
  void connect();
  [[nodiscard]] std::string await(ur::rtde::Frame type);
  [[nodiscard]] std::string ask(ur::rtde::Frame type, std::string_view payload);
  [[nodiscard]] std::vector<std::string> set_up(const std::vector<std::string>& names, double frequency);
  void set_up_inputs(const std::vector<std::string>& names);

  std::function<Connection()> connect_;
  std::optional<Connection> connection_;
  std::array<std::uint32_t, 4> version_{};
  std::vector<std::string> unknown_;
  std::vector<Output> outputs_;
  std::vector<char> input_kinds_;  ///< as Output::kind
  std::uint8_t recipe_ = 0, input_recipe_ = 0;
};

}  // namespace snug::remote_ur
