// RemotePlant: the contract of plants through a socket, and what is said where there is no such plant.
#include "snug/remote_plant/remote_plant.hpp"
#include "snug/core/test/scratch_folder.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <thread>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/pick_length.hpp"
#include "snug/model/test/shortened.hpp"
#include "snug/plant/test/suite/plant_contract.hpp"
#include "snug/remote_plant/box_observer.hpp"
#include "snug/remote_plant/watched_cell.hpp"
#include "snug/served_cell/observer_port.hpp"
#include "snug/served_cell/server.hpp"

namespace snug::remote_plant {
namespace {

using plant::PlantContract;

const model::Scenario& scenario() {
  static const model::Scenario one = cell::with_fixed_arrivals(model::test::shortened(3), "1");
  return one;
}

model::Scenario drawn() { return cell::draw_scenario(scenario(), "1", Rng(7).split("plant")); }

/// A cell that is served in a thread of its own.
class Served {
 public:
  explicit Served(const model::Scenario& cell, bool is_plant = true)
      : simulation_(cell, "1", {motion::LaggedTracking{}, cup::CupMode::Phases, "ur10"}),
        simulator_(simulation_, settings_of(is_plant)),
        server_(simulator_, server_settings()) {
    thread_ = std::thread([this] { server_.run(); });
  }
  ~Served() { stop(); }
  void stop() {
    server_.stop();
    if (thread_.joinable()) thread_.join();
    simulator_.end("the server was stopped");
  }
  [[nodiscard]] std::string address() const { return "click+" + server_.endpoint(); }
  [[nodiscard]] const std::vector<runs::RunResult>& runs() const { return runs_; }

 private:
  served_cell::SimulatorSettings settings_of(bool is_plant) {
    served_cell::SimulatorSettings settings;
    settings.cell.is_plant = is_plant;
    settings.end_run = [this](int, const runs::RunResult& result) { runs_.push_back(result); };
    return settings;
  }
  static served_cell::ServerSettings server_settings() {
    static int count = 0;
    served_cell::ServerSettings settings;
    settings.endpoint = "ipc://" + (std::filesystem::temp_directory_path() /
                                    ("snug_remote_" + std::to_string(::getpid()) + "_" + std::to_string(++count)))
                                       .string();
    return settings;
  }
  cell::Simulation simulation_;
  std::vector<runs::RunResult> runs_;
  served_cell::Simulator simulator_;
  served_cell::Server server_;
  std::thread thread_;
};

RemotePlantOptions at(const std::string& address, double patience = 20.0) {
  RemotePlantOptions options;
  options.address = address;
  options.patience = patience;
  return options;
}

/// The plant with its server.
class WithServer final : public plant::Plant {
 public:
  explicit WithServer(bool is_plant)
      : served_(is_plant ? drawn() : scenario(), is_plant), plant_(scenario(), "1", at(served_.address())) {}
  [[nodiscard]] plant::Description describe() const override { return plant_.describe(); }
  [[nodiscard]] plant::Feedback read() override { return plant_.read(); }
  [[nodiscard]] bool is_moving() const override { return plant_.is_moving(); }
  void start(const plant::Motion& motion) override { plant_.start(motion); }
  [[nodiscard]] std::vector<plant::Event> advance() override { return plant_.advance(); }
  void cancel() override { plant_.cancel(); }
  [[nodiscard]] bool bring(const model::ParcelId& item) override { return plant_.bring(item); }
  void perceive(std::span<const perception::Expectation> expected) override { plant_.perceive(expected); }
  void acknowledge() override { plant_.acknowledge(); }

 private:
  Served served_;
  RemotePlant plant_;
};

const plant::BoxAtAligner& box() {
  static const plant::BoxAtAligner one = [] {
    const model::Scenario fixed = scenario();
    return plant::BoxAtAligner{cell::arrival_pose(fixed, fixed.sequences.front().items.front()),
                               cup::pick_length(fixed.cup)};
  }();
  return one;
}

plant::PlantCase plant_case(const std::string& name, bool is_plant) {
  return box().plant_case(name, [is_plant] { return std::make_unique<WithServer>(is_plant); });
}

INSTANTIATE_TEST_SUITE_P(Remote, PlantContract,
                         testing::Values(plant_case("drawn", true), plant_case("any_cell", false)),
                         [](const auto& one) { return one.param.name; });

TEST(RemotePlant, SeesBoxesToTheLastBitAndAsLargeAsTheyAre) {
  const model::Scenario cell = drawn();
  Served served(cell);
  RemotePlant plant(scenario(), "1", at(served.address()));
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  const perception::Observation seen = plant::observe(plant, {});
  ASSERT_EQ(seen.seen.size(), 1U);
  EXPECT_EQ(seen.seen[0].size, model::collision_size(cell, *model::find_parcel(cell, "BOX027")));
  // The cell keeps quaternions: as a pose that was set in one is read from it.
  const Pose X_WP = cell::arrival_pose(cell, cell.sequences.front().items.front());
  EXPECT_EQ(seen.seen[0].X_WP.R, Quaternion(X_WP.R).normalized().toRotationMatrix());
  EXPECT_EQ(seen.time, 0.0) << "bringing takes no time";
}

TEST(RemotePlant, TakesTheRobotsLagFromTheServedCell) {
  motion::Program there{"there", {box().over(0.35, "home", false)}};
  std::vector<double> times;
  for (const double factor : {1.0, 1.3}) {
    model::Scenario cell = scenario();
    cell.controller.task_stiffness *= factor;
    Served served(cell);
    RemotePlant plant(scenario(), "1", at(served.address()));
    times.push_back(plant::run(plant, {{}, there.waypoints, {}}).time);
  }
  EXPECT_LT(times[1], times[0]) << "a stiffer task is there earlier";
}

TEST(RemotePlant, APeerThatDiesIsAFaultAndNothingFollows) {
  Served served(drawn());
  RemotePlant plant(scenario(), "1", at(served.address(), 0.3));
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  served.stop();
  const plant::Feedback fed = plant::run(plant, {model::ParcelId("BOX027"), box().pick(), {}});
  EXPECT_EQ(fed.end.reason, plant::EndReason::Fault);
  EXPECT_NE(fed.end.where.find("nobody answers within 0.3 s"), std::string::npos) << fed.end.where;
  EXPECT_FALSE(plant::bring_and_wait(plant, model::ParcelId("BOX028")));
  const perception::Observation seen = plant::observe(plant, std::vector<perception::Expectation>{{"BOX027", {}, {}}});
  EXPECT_TRUE(seen.seen.empty());
  EXPECT_EQ(seen.not_seen.size(), 1U);
  EXPECT_TRUE(seen.missing.empty()) << "nobody looked";
  EXPECT_EQ(plant::run(plant, {model::ParcelId("BOX027"), box().pick(), {}}).end.reason, plant::EndReason::Refused);
  ASSERT_EQ(served.runs().size(), 1U) << "the run has its result";
}

TEST(RemotePlant, APeerThatDiesIsSaidOnceAlsoWhileTheRobotStands) {
  Served served(drawn());
  RemotePlant plant(scenario(), "1", at(served.address(), 0.3));
  served.stop();
  EXPECT_FALSE(plant.bring(model::ParcelId("BOX027")));
  plant.perceive({});
  std::string story;
  for (int i = 0; i < 3; ++i) {
    for (const plant::Event& event : plant.advance()) {
      story += plant::get<plant::FaultRaised>(event) != nullptr ? "f"
               : plant::get<plant::Perceived>(event) != nullptr ? "p"
                                                                : "?";
    }
  }
  EXPECT_EQ(story, "fp");
}

TEST(RemotePlant, WhatIsNoSuchPlantIsRefused) {
  const auto message = [](const std::string& address, const model::Scenario& packed) -> std::string {
    try {
      RemotePlant plant(packed, "1", at(address, 0.2));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  for (const char* address :
       {"", "click://", "click://host", "click://:5555", "tcp://127.0.0.1:5555", "click+ipc://"}) {
    EXPECT_NE(message(address, scenario()).find("click://HOST:PORT"), std::string::npos) << address;
  }
  const snug::test::ScratchFolder folder;
  const std::string nobody = "click+ipc://" + (folder / "nobody_is_there").string();
  EXPECT_NE(message(nobody, scenario()).find("nobody answers"), std::string::npos);
  Served served(drawn());
  model::Scenario more = scenario();
  more.sequences.front().items =
      model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml").sequences.front().items;
  EXPECT_NE(message(served.address(), more).find("it has no object 'box0"), std::string::npos);
  model::Scenario slow = scenario();
  slow.controller.tick = 0.016;
  EXPECT_NE(message(served.address(), slow).find("the simulator steps by 0.008 s"), std::string::npos);
}

TEST(RemotePlant, EndsTheRunWhenAsked) {
  Served served(drawn());
  RemotePlant plant(scenario(), "1", at(served.address()));
  (void)plant::run(plant, {{}, {box().over(0.35, "home", false)}, {}});
  EXPECT_EQ(plant.finish(), "");
  ASSERT_EQ(served.runs().size(), 1U);
  EXPECT_EQ(served.runs()[0].ended_by, "reset by the controller");
}

TEST(WatchedCell, SeesWhatTheControllerDoesAndChangesNothing) {
  Served served(drawn());
  const std::string endpoint = served.address().substr(std::string("click+").size());
  RemotePlant plant(scenario(), "1", at(served.address()));
  WatchedCell cell(scenario(), "1", endpoint, 20.0);
  EXPECT_EQ(cell.time(), 0.0);
  EXPECT_EQ(cell.state().world.step_index, 0);
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId(scenario().sequences.front().items.front().parcel)));
  const plant::Feedback feedback = plant::run(plant, {model::ParcelId("pick"), box().pick(), {}});
  EXPECT_EQ(feedback.end.reason, plant::EndReason::Completed) << feedback.end.where;
  ASSERT_EQ(cell.look(), "");
  EXPECT_EQ(cell.time(), feedback.time) << "looking made no step";
  const cell::CellState state = cell.state();
  EXPECT_NEAR(cell.simulation().time(state), feedback.time, 1e-9);
  EXPECT_EQ(state.arm->machine.tool.X_WE, feedback.X_WE);
  const auto box = plant.boxes().front();
  ASSERT_TRUE(box.has_value());
  const cell::CellWorld& world = cell.simulation().world();
  EXPECT_TRUE(physics::pose_of(world.model, state.world, world.parcels.front()).p.isApprox(box->X_WP.p, 1e-9));
  EXPECT_FALSE(state.world.bodies[static_cast<std::size_t>(world.parcels[1].index)].is_present);
  EXPECT_EQ(plant.finish(), "");
  ASSERT_EQ(cell.look(), "");
  EXPECT_EQ(cell.time(), 0.0) << "a reset";
  served.stop();
  ASSERT_EQ(served.runs().size(), 1u);
  EXPECT_EQ(served.runs().front().ended_by, "reset by the controller") << "not by the one that looked";
}

TEST(BoxObserver, SeesTheBoxesOfACellThatSomethingElseDrives) {
  const model::Scenario plant_cell = drawn();
  const cell::Simulation simulation(plant_cell, "1", {motion::LaggedTracking{}, cup::CupMode::Phases, "ur10"});
  cell::CellState state = simulation.make_state();
  ASSERT_TRUE(simulation.feed(0, 0, state));
  const cell::ArmReading reading = simulation.read_still(state);
  const snug::test::ScratchFolder folder;
  served_cell::ObserverPort port(simulation, "ipc://" + (folder / "boxes").string());
  std::atomic<bool> is_over = false;
  std::thread answers([&] {
    while (!is_over) {
      port.answer(state, reading, Wrench{});
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  {
    BoxObserver observer(scenario(), "1", port.endpoint(), 20.0);
    ASSERT_EQ(observer.look(), "");
    const auto boxes = observer.boxes();
    ASSERT_TRUE(boxes.at(0).has_value());
    EXPECT_FALSE(boxes.at(1).has_value()) << "it has not come";
    const physics::BodyId body = simulation.world().parcels.front();
    EXPECT_EQ(boxes[0]->X_WP.p, physics::pose_of(simulation.world().model, state.world, body).p);
    EXPECT_EQ(observer.size_of(0), model::collision_size(plant_cell, *model::find_parcel(plant_cell, "BOX027")));
    model::Scenario more = scenario();
    more.sequences.front().items =
        model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml").sequences.front().items;
    EXPECT_THROW(BoxObserver(more, "1", port.endpoint(), 20.0), InputError) << "boxes that are not served";
    click::Client driver(port.endpoint(), 20.0);
    ASSERT_TRUE(driver.shake_hands());
    EXPECT_FALSE(driver.control({})) << "nobody drives the cell from there";
  }
  is_over = true;
  answers.join();
  EXPECT_THROW(BoxObserver(scenario(), "1", port.endpoint(), 0.05), InputError) << "nobody answers";
  EXPECT_THROW(served_cell::ObserverPort(simulation, "tcp://0.0.0.0:*"), InputError) << "others could reach it";
  EXPECT_THROW(served_cell::ObserverPort(simulation, "nowhere"), InputError);
}

TEST(WatchedCell, SaysWhereThereIsNone) {
  EXPECT_THROW(WatchedCell(scenario(), "1", "ipc:///no/such/socket", 0.05), InputError);
  model::Scenario more = scenario();
  model::Sequence& sequence = more.sequences.front();
  for (const model::Parcel& parcel : more.parcels) {
    const bool is_in = std::ranges::find(sequence.items, parcel.id, &model::Item::parcel) != sequence.items.end();
    if (!is_in) sequence.items.emplace_back().parcel = parcel.id;
  }
  Served served(scenario());
  const std::string endpoint = served.address().substr(std::string("click+").size());
  EXPECT_THROW(WatchedCell(more, "1", endpoint, 5.0), InputError) << "boxes that are not served";
}

}  // namespace
}  // namespace snug::remote_plant
