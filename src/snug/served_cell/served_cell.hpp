// ServedCell: the simulated cell in the words of CLICK: its objects, what they sense, what a command to them means.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "snug/click/message.hpp"
#include "snug/click/rpy.hpp"
#include "snug/runs/outside_run.hpp"

namespace snug::served_cell {

struct ServedCellSettings {
  std::string robot_object = {};                                           ///< empty: the name of the scenario's robot
  std::vector<control::DriveKind> controls = {control::DriveKind::Speed};  ///< of all joints, or one for each
  std::string force_sensor = "UR10FTSensor";  ///< as the demonstrator's controller calls it
  std::string vacuum_event = "vacuum";        ///< switch of the robot
  std::string blow_off_event = "blow_off";
  click::RpyOrder rpy;
  bool velocities = false;    ///< boxes tell their velocities, too
  bool joint_forces = false;  ///< joints tell the forces in them
  /// The cell is a plant that is packed: boxes tell their axes and sizes, the robot how it tracks.
  bool is_plant = false;
};

/// Switches as they stand.
struct Switches {
  bool vacuum = false, blow_off = false;
  struct Box {
    bool feed = false, quarter_turn = false, half_turn = false;
    bool operator==(const Box&) const = default;
  };
  std::vector<Box> boxes;  ///< one for each item of the sequence
  bool operator==(const Switches&) const = default;
};

/// What a Control asks for.
struct Order {
  cell::OutsideCommand command;
  Switches switches;           ///< after it
  int item = -1;               ///< that is to come to the aligner, -1: none
  int quarter = 0;             ///< turned by so many quarter turns
  bool names_feeding = false;  ///< it names a switch of a box: the controller brings the boxes itself
  bool moves_joints = false;   ///< it has values for them: one step
  bool stands = false;         ///< the joints stand, before that step
  bool acknowledges = false;   ///< a protective stop is released
};

/// What was written of each body last: while it does not move its bytes stay what they are.
struct WrittenBodies {
  using State = std::array<double, 14>;  ///< all that its sensors depend on
  struct Body {
    State state{};
    std::string bytes;
  };
  std::vector<Body> bodies;
};

class ServedCell {
 public:
  /// The simulation has a robot (checked) and outlives the served cell. Throws InputError for controls that do not fit
  /// its joints, and for two objects, switches or sensors of one name.
  ServedCell(const cell::Simulation& simulation, const ServedCellSettings& settings);

  [[nodiscard]] const cell::Simulation& simulation() const { return simulation_; }
  [[nodiscard]] const click::Handshake& handshake() const { return handshake_; }
  [[nodiscard]] Switches make_switches() const;

  /// What the command means, given how the switches stand and where the boxes are; or why it means nothing: an unknown
  /// object or switch, another number of values than joints, a value that is not finite, a list of another type than
  /// the handshake gave, a box that cannot come, no values though neither a box is to come nor the robot to stand.
  /// Changes nothing.
  [[nodiscard]] Expected<Order, std::string> understand(const click::Control& control, const Switches& switches,
                                                        const cell::CellState& state) const;
  /// All joints brake and stand.
  [[nodiscard]] cell::OutsideCommand stand(const cup::CupCommand& cup) const;
  /// `load`: on the tool, Simulation::tool_load.
  [[nodiscard]] click::Sensor sense(const cell::CellState& state, const cell::ArmReading& reading,
                                    const Wrench& load) const;
  /// encode(sense(...)), with less work. `written` is of this cell, or empty.
  [[nodiscard]] std::string write_sensor(const cell::CellState& state, const cell::ArmReading& reading,
                                         const Wrench& load, WrittenBodies& written) const;

 private:
  struct Body {
    std::string name;
    physics::BodyId id;
    int item = -1;                   ///< of the sequence, or -1
    Vector3 size = Vector3::Zero();  ///< m, of an item
  };
  void describe_robot(const ServedCellSettings& settings);
  void describe_bodies(const ServedCellSettings& settings);
  [[nodiscard]] std::string take_joints(const click::ObjectControl& object, cell::OutsideCommand& command) const;
  [[nodiscard]] std::string take_events(const std::string& name, const click::ObjectControl& object,
                                        Order& order) const;
  [[nodiscard]] std::string take_feeding(const Switches& before, const cell::CellState& state, Order& order) const;
  [[nodiscard]] click::ObjectSensors sense_robot(const cell::CellState& state, const cell::ArmReading& reading,
                                                 const Wrench& load) const;
  [[nodiscard]] click::ObjectSensors sense_body(const Body& body, const cell::CellState& state) const;
  /// The bytes of a body as the state has it; written again only where it moved.
  [[nodiscard]] const std::string& write_body(const Body& body, const cell::CellState& state,
                                              WrittenBodies::Body& written) const;
  [[nodiscard]] const Body* find_body(std::string_view name) const;

  const cell::Simulation& simulation_;
  ServedCellSettings settings_;
  std::vector<control::DriveKind> kinds_;  ///< one for each joint
  std::vector<Body> bodies_;  ///< boxes of the sequence and others that move by themselves, in the order of names
  click::Handshake handshake_;
};

}  // namespace snug::served_cell
