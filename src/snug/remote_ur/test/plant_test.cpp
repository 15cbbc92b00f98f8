// RemoteUr: the contract of plants on a served controller, and what robots do beside motions: stops, sliders, loads.
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/pick_length.hpp"
#include "snug/model/scenario_edit.hpp"
#include "snug/model/test/shortened.hpp"
#include "snug/plant/test/suite/plant_contract.hpp"
#include "snug/remote_ur/dry_run.hpp"
#include "snug/remote_ur/follow_script.hpp"
#include "snug/remote_ur/remote_ur.hpp"
#include "snug/remote_ur/rtde_link.hpp"
#include "snug/remote_ur/test/stepped_link.hpp"
#include "snug/served_ur/test/served.hpp"

namespace snug::remote_ur {
namespace {

using plant::EndReason;
using plant::PlantContract;
using test::SteppedLink;

const model::Scenario& scenario() {
  static const model::Scenario one = cell::with_fixed_arrivals(with_speed_to_follow(model::test::shortened(3)), "1");
  return one;
}
model::Scenario drawn() { return cell::draw_scenario(scenario(), "1", Rng(7).split("plant")); }

const plant::BoxAtAligner& box() {
  static const plant::BoxAtAligner one = {cell::arrival_pose(scenario(), scenario().sequences.front().items.front()),
                                          cup::pick_length(scenario().cup)};
  return one;
}
model::ParcelId first_box() { return model::ParcelId("BOX027"); }

/// The plant and the controller behind it.
struct Cell {
  explicit Cell(const model::Scenario& served = scenario(), bool is_dry = false, ur::Model model = ur::Model::Ur10,
                const model::Scenario& packed = scenario(), std::function<bool()> is_interrupted = {}) {
    auto owned = std::make_unique<SteppedLink>(served, "1", model);
    link = owned.get();
    RemoteUrOptions options;
    options.boxes = [this](std::vector<perception::SceneBox>& boxes) { return link->look(boxes); };
    options.link = std::move(owned);
    options.perception = perception::make_perception(perception::Kind::Exact, 1);
    options.motions.tracking = motion::FastTracking{};
    options.is_in_time = false;
    options.part_patience = 2.0;
    options.is_dry = is_dry;
    options.is_interrupted = std::move(is_interrupted);
    plant = std::make_unique<RemoteUr>(packed, "1", std::move(options));
  }
  [[nodiscard]] plant::Feedback go(std::vector<motion::Waypoint> waypoints, plant::Guards guards = {}) {
    return plant::run(*plant, {first_box(), std::move(waypoints), guards, {}});
  }
  [[nodiscard]] const ur::RobotData& data() const { return link->controller().data(); }

  SteppedLink* link = nullptr;
  std::unique_ptr<RemoteUr> plant;
};

plant::PlantCase plant_case(const std::string& name, const model::Scenario& served) {
  class Owner final : public plant::Plant {  // keeps what the plant's callbacks name
   public:
    explicit Owner(const model::Scenario& one) : cell_(one) {}
    [[nodiscard]] plant::Description describe() const override { return cell_.plant->describe(); }
    [[nodiscard]] plant::Feedback read() override { return cell_.plant->read(); }
    [[nodiscard]] bool is_moving() const override { return cell_.plant->is_moving(); }
    void start(const plant::Motion& motion) override { cell_.plant->start(motion); }
    [[nodiscard]] std::vector<plant::Event> advance() override { return cell_.plant->advance(); }
    void cancel() override { cell_.plant->cancel(); }
    [[nodiscard]] bool bring(const model::ParcelId& item) override { return cell_.plant->bring(item); }
    void perceive(std::span<const perception::Expectation> expected) override { cell_.plant->perceive(expected); }
    void acknowledge() override { cell_.plant->acknowledge(); }

   private:
    Cell cell_;
  };
  return box().plant_case(name, [served] { return std::make_unique<Owner>(served); });
}

INSTANTIATE_TEST_SUITE_P(RemoteUr, PlantContract,
                         testing::Values(plant_case("drawn", drawn()), plant_case("exact", scenario())),
                         [](const auto& one) { return one.param.name; });

TEST(RemoteUr, FollowsTheSlider) {
  Cell whole, half;
  half.link->controller().inputs().speed_slider_mask = 1;
  half.link->controller().inputs().speed_slider_fraction = 0.5;
  const plant::Feedback there = whole.go({box().over(0.35, "home", false)});
  const plant::Feedback later = half.go({box().over(0.35, "home", false)});
  ASSERT_EQ(later.end.reason, EndReason::Completed);
  EXPECT_NEAR(later.times[0].moving, 2.0 * there.times[0].moving, 0.05 * there.times[0].moving);
  // A tool below 3 mm/s stands; servoj follows 0.03 s late, twice that at half of the slider, which stretches it. What
  // the tool creeps in that time is left of the way.
  EXPECT_LT((later.X_WE.p - there.X_WE.p).norm(), 0.03 / 0.5 * 0.003);
}

TEST(RemoteUr, TellsTheRobotWhatItCarries) {
  Cell cell;
  const served_ur::UrArm arm(served_ur::test::demonstrator_cell());
  const double tool = arm.tool_load().mass;
  const double mass = model::find_parcel(scenario(), "BOX027")->inertia.mass;
  ASSERT_TRUE(plant::bring_and_wait(*cell.plant, first_box()));
  (void)plant::observe(*cell.plant, {});
  EXPECT_DOUBLE_EQ(cell.data().payload, 1e-4 * std::round(1e4 * tool)) << "as the program writes it";
  const plant::Feedback held = cell.go(box().pick());
  ASSERT_EQ(held.end.reason, EndReason::Completed) << describe(held.end, box().pick());
  EXPECT_NEAR(cell.data().payload, tool + mass, 1e-9);
  const double weight = 9.81 * mass;
  EXPECT_NEAR(held.F_E.force.norm(), weight, 0.05 * weight) << "the contract's load has the weight of the box";
  EXPECT_EQ(cell.go({box().over(0.06, "home", true), box().over(0.2, "home", false)}).end.reason, EndReason::Completed);
  EXPECT_NEAR(cell.data().payload, tool, 1e-9);
}

TEST(RemoteUr, StopsForProtectionAndGoesOnWhenAcknowledged) {
  Cell cell;
  ASSERT_TRUE(plant::bring_and_wait(*cell.plant, first_box()));
  const motion::Waypoint free = box().over(0.35, "home", false);
  ASSERT_EQ(cell.go({free}).end.reason, EndReason::Completed);
  const plant::Feedback stopped = cell.go({box().over(-0.08, "home", false)}, {std::nullopt, false});
  ASSERT_EQ(stopped.end.reason, EndReason::ProtectiveStop) << describe(stopped.end, {});
  EXPECT_NE(stopped.end.where.find("PROTECTIVE_STOP"), std::string::npos) << stopped.end.where;
  EXPECT_EQ(cell.go({free}).end.reason, EndReason::Refused);
  cell.plant->acknowledge();
  EXPECT_EQ(cell.data().safety_mode, ur::SafetyMode::Normal);
  const plant::Feedback out = cell.go({free}, {std::nullopt, false});
  EXPECT_EQ(out.end.reason, EndReason::Completed) << describe(out.end, {});
}

TEST(RemoteUr, AStopThatCameWhileItStoodIsTold) {
  Cell cell;
  ASSERT_EQ(cell.go({box().over(0.35, "home", false)}).end.reason, EndReason::Completed);
  cell.link->controller().stop_program();  // at the teach pendant
  for (int i = 0; i < 50; ++i) cell.link->controller().step();
  const plant::Feedback stopped = cell.go({box().over(0.25, "home", false)});
  EXPECT_EQ(stopped.end.reason, EndReason::ProtectiveStop);
  EXPECT_NE(stopped.end.where.find("program"), std::string::npos) << stopped.end.where;
  cell.plant->acknowledge();
  EXPECT_EQ(cell.go({box().over(0.25, "home", false)}).end.reason, EndReason::Completed);
}

/// Up to 90 ms without a command: the arm goes on as it went, then slows down, and comes to the same place.
TEST(RemoteUr, CommandsThatComeLateAreBridged) {
  const plant::Feedback there = Cell().go({box().over(0.35, "home", false)});
  for (const int lost : {1, 2, 4, 11}) {
    SCOPED_TRACE(lost);
    Cell cell;
    int periods = 0;
    double fastest_change = 0.0;
    ur::Values6 before = cell.data().actual_qd;
    cell.link->watch = [&] {
      if (++periods % 40 == 0) cell.link->lost = lost;
      const ur::Values6& now = cell.data().actual_qd;
      for (std::size_t j = 0; j < now.size(); ++j)
        fastest_change = std::max(fastest_change, std::abs(now[j] - before[j]) / 0.008);
      before = now;
    };
    const plant::Feedback fed = cell.go({box().over(0.35, "home", false)});
    ASSERT_EQ(fed.end.reason, EndReason::Completed) << describe(fed.end, {});
    EXPECT_LT((fed.X_WE.p - there.X_WE.p).norm(), 5e-4);
    EXPECT_GT(cell.plant->late_periods(), 0);
    EXPECT_LT(fastest_change, 60.0) << "rad/s^2";
  }
}

/// Registers hold nothing, or what another client left there: far targets, and that it ends.
TEST(RemoteUr, AProgramThatStartsBeforeItsFirstCommandHoldsStill) {
  SteppedLink link(scenario(), "1");
  const served_ur::UrArm arm(served_ur::test::demonstrator_cell());
  const ur::RobotData& data = link.controller().data();
  const ur::Values6 before = data.actual_q;
  for (const std::int32_t number : {7, 8}) {
    SCOPED_TRACE(number);
    (void)link.start(follow_script(arm, false, number));
    for (int i = 0; i < 8; ++i) link.controller().step();
    EXPECT_EQ(link.controller().program_error(), "");
    EXPECT_EQ(data.outputs.ints[kFirstRegister], script_word(number, ScriptState::Follows));
    for (std::size_t j = 0; j < before.size(); ++j) EXPECT_NEAR(data.actual_q[j], before[j], 1e-6);
    RobotSample sample;
    RobotCommand command;
    command.count = 100 * number;
    command.q = {before, before, before};
    for (int i = 0; i < 3; ++i, ++command.count) ASSERT_EQ(link.exchange(command, sample), "");
    EXPECT_EQ(sample.script, script_word(number, ScriptState::Follows));
    command.mode = RobotCommand::Mode::Ends;
    for (auto& q : command.q) q[0] += 1.0;
    for (int i = 0; i < 100 && sample.script != script_word(number, ScriptState::Ended); ++i)  // it brakes first
      ASSERT_EQ(link.exchange(command, sample), "");
    EXPECT_EQ(sample.script, script_word(number, ScriptState::Ended));
  }
}

TEST(RemoteUr, ASilentClientStopsTheRobotWithItsVacuumOn) {
  Cell cell;
  ASSERT_TRUE(plant::bring_and_wait(*cell.plant, first_box()));
  ASSERT_EQ(cell.go(box().pick()).end.reason, EndReason::Completed);
  for (const int begun : {3, 10, 30, 60}) {
    SCOPED_TRACE(begun);
    cell.plant->start({first_box(), {box().over(begun % 20 == 0 ? 0.3 : 0.5, "home", true)}, {}, {}});
    for (int i = 0; i < begun; ++i) (void)cell.plant->advance();
    served_ur::Controller& controller = cell.link->controller();
    for (int i = 0; i < 25; ++i) controller.step();  // 0.2 s
    EXPECT_EQ(cell.data().actual_qd, ur::Values6{});
    EXPECT_EQ(cell.data().digital_outputs & 1U, 1U) << "vacuum";
    EXPECT_EQ(cell.data().runtime_state, ur::RuntimeState::Stopped);
    EXPECT_EQ(cell.data().outputs.ints[kFirstRegister] % 10, static_cast<int>(ScriptState::Silent));
    plant::Feedback fed;  // it was frozen and comes back
    while (cell.plant->is_moving()) {
      for (const plant::Event& event : cell.plant->advance()) {
        if (const auto* ended = plant::get<plant::MotionEnded>(event)) fed = ended->feedback;
      }
    }
    EXPECT_EQ(fed.end.reason, EndReason::ProtectiveStop);
    EXPECT_NE(fed.end.where.find("too late"), std::string::npos) << fed.end.where;
    cell.plant->acknowledge();
    EXPECT_TRUE(cell.plant->read().io.vacuum);
  }
  EXPECT_EQ(cell.go({box().over(0.3, "home", true)}).end.reason, EndReason::Completed);
}

/// From the period in which the last command comes, at the highest speed that a joint is driven with: also where the
/// targets had been late and came back too far away, and at a slow slider.
TEST(RemoteUr, TheRobotStandsWithinAFifthOfASecondOfTheLastCommand) {
  for (const ur::Model kind : {ur::Model::Ur10, ur::Model::Ur10e}) {
    for (const auto& [comes_back_far, slider] : {std::pair{false, 1.0}, std::pair{true, 1.0}, std::pair{false, 0.25}}) {
      SCOPED_TRACE(testing::Message() << (kind == ur::Model::Ur10 ? "8 ms " : "2 ms ") << comes_back_far << slider);
      model::Scenario served = scenario();
      served.controller.tick = kind == ur::Model::Ur10 ? 0.008 : 0.002;
      SteppedLink link(served, "1", kind);
      const served_ur::UrArm arm(served_ur::test::demonstrator_cell());
      const ur::RobotData& data = link.controller().data();
      link.controller().inputs().speed_slider_mask = 1;
      link.controller().inputs().speed_slider_fraction = slider;
      (void)link.start(follow_script(arm, false, 3));
      RobotSample sample;
      RobotCommand command;
      command.mode = RobotCommand::Mode::Moves;
      command.q.fill(data.target_q);
      // A client leads as slowly as the slider says; the robot's servoj then lasts for several periods.
      const double fastest = slider * scenario().robot->velocity_fraction * arm.facts().joint_speed[5];
      double speed = 0.0;
      for (int steady = 0; steady < 8; steady += speed < fastest ? 0 : 1) {
        speed = std::min(fastest, speed + 10.0 * link.period());
        command.q = {command.q[0], command.q[0], command.q[1]};
        command.q[0][5] -= speed * link.period();
        ++command.count;
        ASSERT_EQ(link.exchange(command, sample), "");
      }
      ASSERT_NEAR(std::abs(data.target_qd[5]), fastest, 1e-6);
      ASSERT_NEAR(std::abs(data.actual_qd[5]), fastest, 0.02);
      if (comes_back_far) {
        for (int i = 0; i < 3; ++i) link.controller().step();
        for (auto& q : command.q) q[5] += 0.5;
        command.count += 4;
        ASSERT_EQ(link.exchange(command, sample), "");
      }
      const double before = data.timestamp;
      while (data.timestamp < before + 0.2 - 1e-9) link.controller().step();
      EXPECT_LT(std::abs(data.actual_qd[5]), 5e-3) << "rad/s";
      EXPECT_EQ(data.runtime_state, ur::RuntimeState::Stopped);
      EXPECT_EQ(data.outputs.ints[kFirstRegister], script_word(3, ScriptState::Silent));
      EXPECT_EQ(data.safety_mode, ur::SafetyMode::Normal);
    }
  }
}

TEST(RemoteUr, ARobotThatIsGoneIsAFaultAndNothingFollows) {
  Cell cell;
  ASSERT_TRUE(plant::bring_and_wait(*cell.plant, first_box()));
  cell.plant->start({first_box(), box().pick(), {}, {}});
  for (int i = 0; i < 20; ++i) (void)cell.plant->advance();
  cell.link->trouble = "the connection was closed";
  plant::Feedback fed;
  std::string story;
  while (cell.plant->is_moving()) {
    for (const plant::Event& event : cell.plant->advance()) {
      if (plant::get<plant::FaultRaised>(event) != nullptr) story += "f";
      if (const auto* ended = plant::get<plant::MotionEnded>(event)) {
        story += "e";
        fed = ended->feedback;
      }
    }
  }
  EXPECT_EQ(story, "fe");
  EXPECT_EQ(fed.end.reason, EndReason::Fault);
  EXPECT_EQ(fed.end.where, "the connection was closed");
  EXPECT_FALSE(cell.plant->bring(model::ParcelId(scenario().sequences.front().items[1].parcel)));
  EXPECT_EQ(cell.go(box().pick()).end.reason, EndReason::Refused);
  EXPECT_EQ(cell.plant->finish(), "the connection was closed");
}

/// While it stands and nobody asks for anything: who asks for a box then is told that the plant has failed.
TEST(RemoteUr, ARobotThatGoesWhileItStandsBringsNothingAndSaysWhy) {
  std::atomic<bool> is_gone = false;
  RemoteUrOptions options;
  auto owned = std::make_unique<SteppedLink>(scenario(), "1");
  owned->watch = [&is_gone, link = owned.get()] {
    if (is_gone) link->trouble = "the connection was closed";
  };
  options.link = std::move(owned);
  options.perception = perception::make_perception(perception::Kind::DeadReckoning, 1);
  options.motions.tracking = motion::FastTracking{};
  RemoteUr plant(scenario(), "1", std::move(options));
  is_gone = true;
  EXPECT_EQ(plant.finish(), "the connection was closed");
  EXPECT_FALSE(plant.bring(first_box()));
  EXPECT_EQ(plant.read().end.reason, EndReason::Fault) << "no end of the items";
  EXPECT_EQ(plant.read().end.where, "the connection was closed");
}

/// A client dies with a box in the cup; the next one takes the outputs as they are and has the box that came before.
TEST(RemoteUr, WhoComesAfterAnotherTakesOverWhatTheCupHolds) {
  Cell cell;
  ASSERT_TRUE(plant::bring_and_wait(*cell.plant, first_box()));
  ASSERT_EQ(cell.go(box().pick()).end.reason, EndReason::Completed);
  cell.plant->start({first_box(), {box().over(0.5, "home", true)}, {}, {}});
  for (int i = 0; i < 30; ++i) (void)cell.plant->advance();
  for (int i = 0; i < 40; ++i) cell.link->controller().step();  // nobody says a word
  RemoteUrOptions options;
  options.boxes = [&cell](std::vector<perception::SceneBox>& boxes) { return cell.link->look(boxes); };
  options.link = std::make_unique<test::SameLink>(*cell.link);
  options.perception = perception::make_perception(perception::Kind::Exact, 1);
  options.motions.tracking = motion::FastTracking{};
  options.is_in_time = false;
  options.to_do = {first_box().value};
  RemoteUr next(scenario(), "1", std::move(options));
  EXPECT_TRUE(next.read().io.vacuum);
  EXPECT_LT(next.read().pressure_gauge, -1e4);
  ASSERT_EQ(plant::observe(next, {}).seen.size(), 1U) << "it came before";
  const plant::Feedback up = plant::run(next, {first_box(), {box().over(0.3, "home", true)}, {}, {}});
  ASSERT_EQ(up.end.reason, EndReason::Completed) << describe(up.end, {});
  EXPECT_TRUE(up.io.vacuum);
  EXPECT_GT(cell.data().payload, served_ur::UrArm(served_ur::test::demonstrator_cell()).tool_load().mass + 0.01);
  EXPECT_EQ(plant::run(next, {first_box(), {box().over(0.06, "home", true), box().over(0.2, "home", false)}, {}, {}})
                .end.reason,
            EndReason::Completed);
  const auto asked = cell.link->controller().data().digital_outputs;
  ASSERT_TRUE(plant::bring_and_wait(next, first_box())) << "it has come already";
  EXPECT_EQ(cell.link->controller().data().digital_outputs, asked) << "no other box is asked for";
  EXPECT_EQ(plant::observe(next, {}).seen.size(), 1U);
  EXPECT_TRUE(plant::bring_and_wait(next, model::ParcelId(scenario().sequences.front().items[1].parcel)));
  EXPECT_EQ(next.finish(), "");
}

TEST(RemoteUr, WhoIsInterruptedWhileItWaitsForABoxIsTold) {
  const model::Scenario wired = model::with_values(scenario(), {{"robot.io.next_part", "none"}}, "test");
  bool is_interrupted = false;
  Cell cell(wired, false, ur::Model::Ur10, wired, [&is_interrupted] { return is_interrupted; });
  ASSERT_TRUE(plant::bring_and_wait(*cell.plant, first_box()));
  ASSERT_TRUE(cell.plant->bring(model::ParcelId(scenario().sequences.front().items[1].parcel)));
  is_interrupted = true;
  std::vector<plant::Event> events;
  for (int i = 0; i < 5 && events.empty(); ++i) events = cell.plant->advance();
  ASSERT_EQ(events.size(), 1U);
  ASSERT_NE(plant::get<plant::FaultRaised>(events[0]), nullptr);
  EXPECT_EQ(plant::get<plant::FaultRaised>(events[0])->reason, EndReason::Cancelled);
  EXPECT_EQ(cell.plant->finish(), "") << "the plant has not failed";
}

TEST(RemoteUr, InLockstepEachExchangeIsAPeriodAndTheClockWaits) {
  const served_ur::test::Served served;
  const Endpoint endpoint{"127.0.0.1", served.offset(), 20.0};
  RobotCommand command;
  std::vector<double> stamps;
  {
    RtdeLink link(endpoint, true);
    for (int i = 0; i < 20; ++i) {
      RobotSample sample;
      command.count = i;
      ASSERT_EQ(link.exchange(command, sample), "");
      stamps.push_back(sample.timestamp);
      if (i == 10) std::this_thread::sleep_for(std::chrono::milliseconds(40));
    }
  }
  for (std::size_t i = 1; i < stamps.size(); ++i) EXPECT_NEAR(stamps[i] - stamps[i - 1], 0.008, 1e-9);
  RtdeClient after(endpoint, {"timestamp"}, 0.0);
  const double first = after.receive().at("timestamp")[0];
  EXPECT_LT(first, after.receive().at("timestamp")[0]) << "in time again";
}

/// What a controller says, on every connection.
RtdeClient hear(const std::string& said, const std::vector<std::string>& outputs,
                const std::vector<std::string>& inputs = {}) {
  return RtdeClient(
      [&said] {
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
        EXPECT_EQ(::send(ends[1], said.data(), said.size(), MSG_NOSIGNAL), static_cast<ssize_t>(said.size()));
        ::shutdown(ends[1], SHUT_WR);
        static std::vector<Descriptor> kept;
        kept.emplace_back(ends[1]);
        return Connection(Descriptor(ends[0]), "controller", 1.0);
      },
      outputs, 0.0, inputs);
}

TEST(RemoteUr, ATypeThatAFieldCannotHaveIsRefused) {
  using ur::rtde::Frame;
  const auto frame = [](Frame type, const std::string& payload) { return ur::rtde::encode(type, payload); };
  const std::string hello = frame(Frame::Version, "\x01") + frame(Frame::ControllerVersion, std::string(16, '\0'));
  const std::string start = frame(Frame::Start, "\x01");
  EXPECT_NO_THROW((void)hear(hello +
                                 frame(Frame::Outputs,
                                       "\x01"
                                       "DOUBLE") +
                                 start,
                             {"timestamp"}));
  EXPECT_THROW((void)hear(hello +
                              frame(Frame::Outputs,
                                    "\x01"
                                    "UINT64") +
                              start,
                          {"timestamp"}),
               InputError);
  const std::string outputs = hello + frame(Frame::Outputs,
                                            "\x01"
                                            "DOUBLE");
  const std::vector<std::string> number = {"input_double_register_24"};
  EXPECT_NO_THROW((void)hear(outputs +
                                 frame(Frame::Inputs,
                                       "\x01"
                                       "DOUBLE") +
                                 start,
                             {"timestamp"}, number));
  EXPECT_THROW((void)hear(outputs +
                              frame(Frame::Inputs,
                                    "\x01"
                                    "UINT8") +
                              start,
                          {"timestamp"}, number),
               InputError)
      << "a target would not fit into a byte";
}

TEST(RemoteUr, ABoxThatIsNotUsedMakesRoomForTheNext) {
  Cell cell;
  const auto& items = scenario().sequences.front().items;
  for (const model::Item& item : items) EXPECT_TRUE(plant::bring_and_wait(*cell.plant, model::ParcelId(item.parcel)));
  const perception::Observation seen = plant::observe(*cell.plant, {});
  ASSERT_EQ(seen.seen.size(), 1U) << "the others were taken away";
  EXPECT_EQ(seen.seen[0].item, items.back().parcel);
  EXPECT_EQ(cell.go({box().over(0.4, "home", false)}).end.reason, EndReason::Completed);
  EXPECT_EQ(cell.data().digital_outputs, 0U) << "it asked for a moment";
}

TEST(RemoteUr, ABoxThatDoesNotComeIsAFault) {
  const model::Scenario wired = model::with_values(scenario(), {{"robot.io.next_part", "none"}}, "test");
  Cell cell(wired, false, ur::Model::Ur10, wired);
  ASSERT_TRUE(plant::bring_and_wait(*cell.plant, first_box()));
  // the first one still stands there: no new box
  EXPECT_FALSE(plant::bring_and_wait(*cell.plant, model::ParcelId(scenario().sequences.front().items[1].parcel)));
}

TEST(RemoteUr, IsWiredAsTheScenarioSays) {
  const model::Scenario wired =
      model::with_values(scenario(),
                         {{"robot.io.vacuum", "{kind: tool, number: 1, active_low: true}"},
                          {"robot.io.blow_off", "none"},
                          {"robot.io.vacuum_gauge", "{kind: standard, number: 1, at_ambient: 1.0, at_vacuum: 5.0}"},
                          {"robot.io.vacuum_reached", "{kind: configurable, number: 3, active_low: true}"},
                          {"robot.io.part_present", "{kind: configurable, number: 4}"}},
                         "test");
  Cell cell(wired, false, ur::Model::Ur10, wired);
  EXPECT_EQ(cell.data().digital_outputs >> 17U & 1U, 1U) << "off";
  EXPECT_NEAR(cell.data().analog_inputs[1], 1.0, 1e-12);
  ASSERT_TRUE(plant::bring_and_wait(*cell.plant, first_box()));
  EXPECT_EQ(cell.data().digital_inputs >> 11U & 3U, 3U) << "no vacuum (low says yes), a box";
  const plant::Feedback held = cell.go(box().pick());
  ASSERT_EQ(held.end.reason, EndReason::Completed) << describe(held.end, box().pick());
  EXPECT_LT(held.pressure_gauge, -1e4);
  EXPECT_GT(cell.data().analog_inputs[1], 1.5);
  EXPECT_EQ(cell.data().digital_outputs >> 17U & 1U, 0U) << "on";
  EXPECT_EQ(cell.data().digital_inputs >> 11U & 1U, 0U) << "the vacuum is reached";
}

TEST(RemoteUr, ASwitchStandsInForAGauge) {
  const model::Scenario wired = model::with_values(scenario(), {{"robot.io.vacuum_gauge", "none"}}, "test");
  Cell cell(wired, false, ur::Model::Ur10, wired);
  ASSERT_TRUE(plant::bring_and_wait(*cell.plant, first_box()));
  EXPECT_EQ(cell.go(box().pick()).end.reason, EndReason::Completed);
  motion::Waypoint sucking = box().over(0.35, "home", true);
  Cell empty(wired, false, ur::Model::Ur10, wired);
  EXPECT_EQ(empty.go({sucking, sucking}).end.reason, EndReason::NoSeal);
  const model::Scenario blind =
      model::with_values(scenario(), {{"robot.io.vacuum_gauge", "none"}, {"robot.io.vacuum_reached", "none"}}, "test");
  EXPECT_THROW(Cell(blind, false, ur::Model::Ur10, blind), InputError);
}

TEST(RemoteUr, ADryRunSwitchesNothingAndStaysAbove) {
  Cell cell(scenario(), true);
  double lowest = 10.0;
  std::uint64_t outputs = 0;
  cell.link->watch = [&] { outputs |= cell.data().digital_outputs; };
  cell.plant->start({first_box(), box().pick(), {30.0, true, 2.0}, {}});
  plant::Feedback fed;
  while (cell.plant->is_moving()) {
    for (const plant::Event& event : cell.plant->advance()) {
      if (const auto* ended = plant::get<plant::MotionEnded>(event)) fed = ended->feedback;
    }
    lowest = std::min(lowest, cell.plant->read().X_WE.p.z());
  }
  ASSERT_EQ(fed.end.reason, EndReason::Completed) << describe(fed.end, box().pick());
  EXPECT_EQ(outputs, 0U);
  EXPECT_GE(lowest, box().pick()[1].X_WE.p.z() + kDryHeight - 1e-3);
  const plant::Feedback fast = Cell().go({box().pick().front()});
  const plant::Feedback slow = Cell(scenario(), true).go({box().pick().front()});
  EXPECT_GT(slow.times[0].moving, 3.0 * fast.times[0].moving);
}

TEST(RemoteUr, InADryRunARobotMakesEachMotionBeforeTheSimulatedPlant) {
  Cell packed, robot(scenario(), true);
  DryRun both(*packed.plant, *robot.plant);
  ASSERT_TRUE(plant::bring_and_wait(both, first_box()));
  const plant::Feedback held = plant::run(both, {first_box(), box().pick(), {150.0, true, 0.0}, {}});
  EXPECT_EQ(held.end.reason, EndReason::Completed) << describe(held.end, box().pick());
  EXPECT_LT(held.pressure_gauge, -1e4) << "the simulated plant's";
  EXPECT_EQ(held, both.read());
  EXPECT_NEAR(robot.plant->read().X_WE.p.z(), held.X_WE.p.z() + kDryHeight, 2e-3);
  both.start({first_box(), {box().over(0.4, "home", true)}, {}, {}});
  for (int i = 0; i < 20; ++i) (void)both.advance();
  both.cancel();
  std::vector<plant::Event> events;
  while (both.is_moving()) {
    for (const plant::Event& event : both.advance()) events.push_back(event);
  }
  ASSERT_EQ(events.size(), 1U) << "no fault";
  const auto* cancelled = plant::get<plant::MotionEnded>(events.front());
  ASSERT_NE(cancelled, nullptr);
  EXPECT_EQ(cancelled->feedback.end.reason, EndReason::Cancelled);
  EXPECT_EQ(cancelled->feedback.X_WE, held.X_WE) << "the simulated plant did not move";
  robot.link->controller().stop_program();
  for (int i = 0; i < 50; ++i) robot.link->controller().step();
  const plant::Feedback stopped = plant::run(both, {first_box(), {box().over(0.4, "home", true)}, {}, {}});
  EXPECT_EQ(stopped.end.reason, EndReason::Fault);
  EXPECT_EQ(stopped.end.where.find("dry run: protective stop"), 0U) << stopped.end.where;
  EXPECT_EQ(stopped.X_WE, held.X_WE) << "the simulated plant did not move";
}

TEST(RemoteUr, AnESeriesGetsTargetsBetweenTheTicks) {
  model::Scenario served = scenario();
  served.controller.tick = 0.002;
  Cell cell(served, false, ur::Model::Ur10e);
  double fastest_change = 0.0;
  ur::Values6 before = cell.data().target_qd;
  cell.link->watch = [&] {
    for (std::size_t j = 0; j < before.size(); ++j)
      fastest_change = std::max(fastest_change, std::abs(cell.data().target_qd[j] - before[j]) / 0.002);
    before = cell.data().target_qd;
  };
  ASSERT_TRUE(plant::bring_and_wait(*cell.plant, first_box()));
  const plant::Feedback held = cell.go(box().pick());
  EXPECT_EQ(held.end.reason, EndReason::Completed) << describe(held.end, box().pick());
  EXPECT_LT(fastest_change, 1.5 * scenario().robot->max_joint_acceleration) << "rad/s^2: no steps of 8 ms";
}

TEST(RemoteUr, ThroughSocketsInTime) {
  const served_ur::test::Served served;
  RemoteUrOptions options;
  options.link = std::make_unique<RtdeLink>(Endpoint{"127.0.0.1", served.offset(), 20.0});
  options.perception = perception::make_perception(perception::Kind::DeadReckoning, 1);
  options.motions.tracking = motion::FastTracking{};
  const model::Scenario& whole = served_ur::test::demonstrator_cell().scenario();
  RemoteUr plant(whole, "1", std::move(options));
  const Endpoint there_too{"127.0.0.1", served.offset(), 20.0};
  EXPECT_THROW((RtdeLink(there_too)), InputError) << "its inputs are held";
  EXPECT_THROW(RtdeClient(there_too, {"timestamp"}, 0.0, {"no_such_input"}), InputError);
  const motion::Waypoint there = box().over(0.35, "home", false);
  const plant::Feedback fed = plant::run(plant, {{}, {there}, {}, {}});
  EXPECT_EQ(fed.end.reason, EndReason::Completed) << describe(fed.end, {});
  EXPECT_LT((fed.X_WE.p - there.X_WE.p).norm(), 1e-3);
  plant.start({{}, {box().over(0.2, "home", false)}, {}, {}});
  (void)plant.advance();
  plant.cancel();
  EndReason reason = EndReason::Completed;
  while (plant.is_moving()) {
    for (const plant::Event& event : plant.advance()) {
      if (const auto* ended = plant::get<plant::MotionEnded>(event)) reason = ended->feedback.end.reason;
    }
  }
  EXPECT_EQ(reason, EndReason::Cancelled);
  EXPECT_EQ(plant.finish(), "");
}

TEST(RemoteUr, AddressesOfControllers) {
  EXPECT_EQ(endpoint_of_ur("click://127.0.0.1:5555"), std::nullopt);
  EXPECT_EQ(endpoint_of_ur("ur://192.168.0.10")->host, "192.168.0.10");
  EXPECT_EQ(endpoint_of_ur("ur://127.0.0.1:1200")->port_offset, 1200);
  for (const char* bad : {"ur://", "ur://:5", "ur://a:", "ur://a:x", "ur://a:-1", "ur://a:99999", "ur://a:1b"})
    EXPECT_THROW((void)endpoint_of_ur(bad), InputError) << bad;
  for (const char* here : {"127.0.0.1", "127.1.2.3", "localhost"}) EXPECT_TRUE(is_loopback_host(here)) << here;
  for (const char* there : {"192.168.0.10", "0.0.0.0", "10.127.0.1", "robot", ""})
    EXPECT_FALSE(is_loopback_host(there)) << there;
}

TEST(RemoteUr, WhatDiffersIsRefusedBeforeAnythingMoves) {
  refuse_what_differs({{"TCP", Verdict::Differs, "", "", ""}, {"payload", Verdict::Differs, "", "", ""}}, "ur://a");
  try {
    refuse_what_differs({{"kinematics", Verdict::Differs, "off by 3 mm", "at most 1 mm", "name the URDF"}}, "ur://a");
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("off by 3 mm"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace snug::remote_ur
