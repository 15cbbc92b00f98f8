// RemoteUr: a controller of Universal Robots and the cell around it, behind the interface of a plant.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/model/robot_io.hpp"
#include "snug/perception/perception.hpp"
#include "snug/plant/motion_runner.hpp"
#include "snug/remote_ur/robot_link.hpp"
#include "snug/served_ur/ur_arm.hpp"

namespace snug::remote_ur {

struct RemoteUrOptions {
  std::unique_ptr<RobotLink> link;
  std::unique_ptr<perception::Perception> perception;
  /// Where boxes are, for a perception that has to be told; what is wrong, or empty. None: it looks by itself.
  std::function<std::string(std::vector<perception::SceneBox>&)> boxes = {};
  /// How the joints are led to the waypoints: the tracking counts.
  cell::SimulationOptions motions;
  /// The robot goes on in time, in a thread of the plant; else it makes a period in each advance() (tests).
  bool is_in_time = true;
  double part_patience = 600.0;  ///< s, that a box may take to come to the aligner
  /// Nothing is switched and nothing is waited for, every waypoint is raised, the robot moves at a fraction of its
  /// speed.
  bool is_dry = false;
  std::function<bool()> is_interrupted = {};  ///< then the robot stops where it is
  int brought = 0;                            ///< items of the sequence that a session before this one has done with
  /// Items that came before and are not done with: they are somewhere in the cell, and have come as soon as they are
  /// asked for.
  std::vector<std::string> to_do = {};
};

/// Of dry runs.
inline constexpr double kDryHeight = 0.02;  ///< m, that waypoints are raised by
inline constexpr double kDrySpeed = 0.25;   ///< of the planned speeds

/// The scenario with a robot that is driven at half of its joints' speeds at most: what follow_script brings to rest,
/// and goes on from where commands come late.
[[nodiscard]] model::Scenario with_speed_to_follow(model::Scenario scenario);

/// snug's controller of the joints runs here and writes a target for each period of the robot; a program of ours on the
/// robot follows it (follow_script). What ends motions is what the robot's own sensors say: force, gauge or switch of
/// the vacuum. Time of the plant is that of motions; the robot's slider slows them. Where the robot stops by itself,
/// for protection or because targets stopped coming, the motion ends with ProtectiveStop. A box has arrived when the
/// input for it goes on (at once where none is wired); a box that was not used is taken away when the next is asked for
/// (robot.io, next_part), else by hand. One that is told to be in the cell when it is asked for has come already: a
/// session may go on where another ended. Outputs are taken over as they are.
class RemoteUr final : public plant::Plant {
 public:
  /// Starts the program on the robot; nothing moves. Throws InputError where that does not run, and as cell::CellArm
  /// and served_ur::UrArm for the scenario's robot.
  RemoteUr(const model::Scenario& scenario, const std::string& sequence, RemoteUrOptions options);
  ~RemoteUr() override;
  RemoteUr(const RemoteUr&) = delete;
  RemoteUr& operator=(const RemoteUr&) = delete;

  [[nodiscard]] plant::Description describe() const override;
  [[nodiscard]] plant::Feedback read() override;
  [[nodiscard]] bool is_moving() const override { return is_moving_; }
  void start(const plant::Motion& motion) override;
  [[nodiscard]] std::vector<plant::Event> advance() override;
  void cancel() override;
  [[nodiscard]] bool bring(const model::ParcelId& item) override;
  void perceive(std::span<const perception::Expectation> expected) override;
  void acknowledge() override;

  [[nodiscard]] bool was_brought(std::size_t item) const { return was_brought_[item]; }
  /// Where boxes were perceived last, for each item of the sequence; nothing of those that never were.
  [[nodiscard]] std::vector<std::optional<perception::SceneBox>> perceived();
  /// m, as the scenario has it.
  [[nodiscard]] Vector3 size_of(std::size_t item) const;
  /// Periods so far in which the robot had no new target.
  [[nodiscard]] int late_periods();
  /// Ends the program on the robot. Empty, or why the plant has failed.
  [[nodiscard]] std::string finish();

 private:
  /// What one period brought, for advance().
  struct Result {
    plant::Feedback feedback;
    std::vector<plant::Event> events;
  };
  enum class Wish { None, Start, Unlock };

  // Without the lock.
  void tick();
  void run_in_time();
  /// Until `is_so`, at most this many seconds of the robot; whether it is.
  bool wait_until(double seconds, const std::function<bool()>& is_so);
  [[nodiscard]] plant::Motion as_sent(const plant::Motion& motion) const;

  // With the lock.
  [[nodiscard]] RobotCommand make_command();
  void lead();
  void compute_tick();
  void brake();
  void take(const RobotSample& sample, const std::string& trouble);
  void step_motion();
  void watch_robot();
  void look_for_part();
  void ask_for_part();
  void follow_load(const std::vector<plant::Event>& events);
  void set_load(double mass, const Vector3& p_FCo);
  void load_item();
  [[nodiscard]] bool is_holding() const;
  void begin_braking();
  void end_motion();
  void stand();
  void fail(std::string why);
  void push_result();
  [[nodiscard]] bool is_ready() const;
  [[nodiscard]] std::string why_stopped() const;
  [[nodiscard]] double time() const { return static_cast<double>(moving_periods_) * period_; }
  [[nodiscard]] double pressure() const;
  [[nodiscard]] Wrench load_on_tool() const;
  [[nodiscard]] plant::TickReading reading() const;
  [[nodiscard]] plant::Feedback sensors() const;
  [[nodiscard]] plant::Feedback current() const;
  void cancel_motion();

  RemoteUrOptions options_;
  model::Scenario scenario_;  ///< arrivals fixed, as plants have them
  model::Sequence sequence_;
  model::RobotIo io_;
  robot::ArmModel model_;
  served_ur::UrArm ur_arm_;
  double period_;
  std::unique_ptr<cell::CellArm> arm_;
  std::unique_ptr<const cell::JointPace> pace_;
  std::vector<bool> was_brought_;

  std::mutex mutex_;  ///< of everything below; the link is the thread's alone, once that runs
  std::condition_variable news_;
  cell::ArmState state_;
  motion::ControllerState program_;
  control::JointControllerWork work_;
  motion::PreparedProgram plan_;  ///< of the motion under way
  plant::MotionRunner runner_;
  RobotSample sample_;
  RobotCommand command_;
  std::int32_t number_ = 0;  ///< of the program on the robot
  Wish wish_ = Wish::None;
  bool has_zeroed_ = false;   ///< the force sensor
  bool has_started_ = false;  ///< the program on the robot has been seen to run since it was sent
  bool ends_ = false;
  // The way from the last tick of the controller to the next, and how much of it is done.
  control::JointMotion from_, to_;
  double phase_ = 1.0;
  ur::Values6 q_{}, qd_{};  ///< rad, rad/s: what the robot was told last
  motion::IO switches_;
  int row_ = -1;
  bool is_waiting_ = false, is_stuck_ = false;
  bool is_braking_ = false;
  int braking_periods_ = 0;
  std::int64_t moving_periods_ = 0;
  bool is_stopped_ = false, is_stop_told_ = false;
  std::string stop_reason_;
  std::string failure_;                ///< why no motion can follow
  std::set<std::string> in_the_cell_;  ///< items, before they are asked for
  plant::Feedback feedback_;
  std::deque<model::ParcelId> awaited_;
  std::int64_t awaited_periods_ = 0;
  int asking_periods_ = 0;                                ///< for which the next box is still asked for
  bool part_is_new_ = true;                               ///< since the last box arrived the input was off
  std::vector<std::pair<std::string, Pose>> seen_boxes_;  ///< where they were perceived last
  std::deque<Result> results_;
  int late_before_ = 0;  ///< periods, of programs before this one

  bool is_moving_ = false;  ///< for who calls: MotionEnded has not come out of advance()
  plant::Feedback told_;    ///< what read() says: as of the last advance()
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace snug::remote_ur
