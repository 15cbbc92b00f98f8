// Simulator: the answering side of CLICK: which message is answered by what, and what it does to the cell.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "snug/click/names.hpp"
#include "snug/served_cell/feeder.hpp"
#include "snug/served_cell/served_cell.hpp"

namespace snug::served_cell {

/// Frames beyond are answered by an Error without being read, bytes.
inline constexpr std::size_t kLargestFrame = std::size_t{1} << 20U;

struct SimulatorSettings {
  ServedCellSettings cell;
  /// Steps come from step() instead of from Controls; those set what the joints do from the next step on.
  bool is_async = false;
  /// Async: the cell runs from the first step() on, its joints at rest until there is a Control.
  bool runs_at_once = false;
  std::optional<double> batch;  ///< s, simulated, after which the simulator resets itself
  /// What is to be done with each run, from 1; asked for when it begins.
  std::function<runs::OutsideRunOptions(int run)> begin_run = {};
  std::function<void(int run, const runs::RunResult& result)> end_run = {};
};

/// What the simulator answered so far.
struct SimulatorCounts {
  std::int64_t steps = 0;
  std::int64_t replies = 0;
  std::int64_t errors = 0;  ///< replies that are Errors
  int runs = 0;             ///< begun
  bool operator==(const SimulatorCounts&) const = default;
};

/// No sockets, and no clock that steers: the same frames in the same order give the same answers and the same cell.
///
/// One controller at a time: the peer whose handshake was accepted where nobody controlled, or whose Control came where
/// nobody had commanded yet (a handshake is implied then), until it leaves. Others get handshakes and sensors, too, and
/// an Error for everything else. Between runs the cell is at time 0; a run begins with the first Control and ends with
/// a reset, an Error, the controller's leaving, or a failure of the cell; after a failure all Controls are answered by
/// an Error until there is a reset or a new handshake. In a plant (ServedCellSettings::is_plant) a protective stop ends
/// no run: it may be acknowledged.
class Simulator {
 public:
  using Peer = std::string;

  /// Throws as ServedCell. The simulation outlives the simulator.
  Simulator(const cell::Simulation& simulation, SimulatorSettings settings);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  /// The frame's answer; none where the protocol has none. Throws OutputError when a recording cannot be written.
  [[nodiscard]] std::optional<std::string> answer(const Peer& peer, std::string_view frame);
  /// Would this frame make the cell step? Then it may be kept until it is time.
  [[nodiscard]] bool is_step(const Peer& peer, std::string_view frame) const;
  [[nodiscard]] static bool is_control(std::string_view frame);
  [[nodiscard]] static bool is_handshake(std::string_view frame);
  /// A peer that says by its name that it only looks.
  [[nodiscard]] static bool is_watcher(const Peer& peer) { return peer.starts_with(click::kWatcher); }
  /// The peer is gone. True: it was the controller.
  bool leave(const Peer& peer, const std::string& why = "the controller left");
  /// The user resets: the controller's next message is answered so.
  void reset(const std::string& why);
  /// Ends the run, if there is one.
  void end(const std::string& why);

  /// Async: does the cell run?
  [[nodiscard]] bool is_running() const;
  /// Async: one step with what was commanded last; where that is older than `kPatience` the joints brake.
  void step();

  [[nodiscard]] const click::Handshake& handshake() const { return cell_.handshake(); }
  [[nodiscard]] bool has_controller() const { return controller_.has_value(); }
  [[nodiscard]] bool has_commanded() const { return has_commanded_; }
  [[nodiscard]] bool is_controller(const Peer& peer) const { return controller_ == peer; }
  [[nodiscard]] double time() const;
  [[nodiscard]] const SimulatorCounts& counts() const { return counts_; }
  /// Of the state that the cell is in.
  [[nodiscard]] std::uint64_t hash() const;
  /// s of the clock that the steps took, for reports.
  [[nodiscard]] double step_seconds() const { return step_seconds_; }

  /// s, simulated, after which a free-running cell no longer follows a controller that is silent.
  static constexpr double kPatience = 0.25;

 private:
  struct Reply {
    std::string frame;
    bool is_error = false;
  };
  [[nodiscard]] static Reply reply(const click::Message& message);
  [[nodiscard]] std::optional<Reply> respond(const Peer& peer, std::string_view frame);
  /// To a peer that looks: it never becomes the controller and changes nothing.
  [[nodiscard]] Reply show(const click::Message& message);
  [[nodiscard]] Reply shake_hands(const Peer& peer, const click::HandshakeInit& init);
  [[nodiscard]] Reply control(const click::Control& control);
  void begin_run();
  void advance(const cell::OutsideCommand& command);
  /// What of the order takes no time: a box comes, the robot stands, a stop is released.
  void take_at_once(const Order& order);
  void clear();
  void take_place(const Peer& peer);
  /// A Control of a peer without the place, where nobody has commanded.
  [[nodiscard]] Reply control_first(const Peer& peer, const click::Control& command);
  [[nodiscard]] Reply sense();
  [[nodiscard]] const cell::CellState& state() const;

  SimulatorSettings settings_;
  ServedCell cell_;
  const cell::CellState initial_;
  const cell::ArmReading initial_reading_;
  std::optional<Peer> controller_;
  bool has_commanded_ = false;             ///< the controller, since it has the place
  std::unique_ptr<runs::OutsideRun> run_;  ///< none before the first Control
  bool is_ended_ = false;                  ///< run_ is kept to be looked at
  std::string failure_;                    ///< why it ended by itself, or stopped
  bool is_reset_ = false;                  ///< by the simulator; the controller is still to be told
  Switches switches_;
  WrittenBodies written_;
  std::optional<Feeder> feeder_;
  bool knows_who_feeds_ = false;                 ///< the first Control of a run tells
  std::optional<cell::OutsideCommand> command_;  ///< async
  std::int64_t silent_steps_ = 0;                ///< since it came
  SimulatorCounts counts_;
  double step_seconds_ = 0.0;
};

}  // namespace snug::served_cell
