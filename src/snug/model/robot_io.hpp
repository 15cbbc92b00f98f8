// RobotIo: at which outputs and inputs of the robot's controller gripper and cell are wired.
#pragma once

#include <optional>

#include "snug/model/scenario.hpp"

namespace snug::model {

enum class DigitalKind {
  Standard,
  Configurable,
  Tool,
};

/// A digital output or input of a controller of Universal Robots.
struct DigitalIo {
  DigitalKind kind = DigitalKind::Standard;
  int number = 0;           ///< of its kind: 0 .. 7, of the tool 0 .. 1
  bool active_low = false;  ///< low says yes

  /// In the words of bits that controllers show: 0 .. 7 standard, 8 .. 15 configurable, 16 and 17 tool.
  [[nodiscard]] int bit() const {
    return number + (kind == DigitalKind::Standard ? 0 : kind == DigitalKind::Configurable ? 8 : 16);
  }
  bool operator==(const DigitalIo&) const = default;
};

enum class AnalogKind {
  Standard,
  Tool,
};

/// An analog input that a pressure gauge is wired to; linear.
struct GaugeIo {
  AnalogKind kind = AnalogKind::Tool;
  int number = 0;                ///< of its kind: 0 .. 1
  double at_ambient = 0.0;       ///< V, or A where the input is set to a current
  double at_vacuum = 10.0;       ///< the same, at `pressure_gauge`
  double pressure_gauge = -1e5;  ///< Pa, below 0

  /// Pa, gauge, of a reading in V or A.
  [[nodiscard]] double pressure_of(double reading) const {
    return pressure_gauge * (reading - at_ambient) / (at_vacuum - at_ambient);
  }
  /// V or A of a pressure in Pa, gauge.
  [[nodiscard]] double reading_of(double pressure) const {
    return at_ambient + (at_vacuum - at_ambient) * pressure / pressure_gauge;
  }
  bool operator==(const GaugeIo&) const = default;
};

/// None: not wired.
struct RobotIo {
  DigitalIo vacuum;                                                                      ///< output: on, vacuum is made
  std::optional<DigitalIo> blow_off = DigitalIo{DigitalKind::Standard, 1, false};        ///< output
  std::optional<DigitalIo> vacuum_reached = DigitalIo{DigitalKind::Standard, 0, false};  ///< input
  std::optional<GaugeIo> vacuum_gauge = GaugeIo{};
  std::optional<DigitalIo> part_present = DigitalIo{DigitalKind::Standard, 1, false};  ///< input: a box at the aligner
  /// Output, switched on for a moment: what stands at the aligner is taken away, and the next box comes.
  std::optional<DigitalIo> next_part = DigitalIo{DigitalKind::Standard, 2, false};
  bool operator==(const RobotIo&) const = default;
};

/// Of the scenario's robot, by the scenario's text (`robot.io`), which loading has checked: nothing that is simulated
/// depends on it. The defaults where the text says nothing.
[[nodiscard]] RobotIo robot_io(const Scenario& scenario);

}  // namespace snug::model
