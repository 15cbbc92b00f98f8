// RestWatch: a box that falls, one that rocks, and boxes that rest.
#include "snug/cell/rest_watch.hpp"

#include <gtest/gtest.h>

#include "snug/cell/test/demonstrator.hpp"

namespace snug::cell {
namespace {

struct Falling : testing::Test {
  Falling() : simulation(demonstrator(), "1", {}), work(simulation.make_workspace()) {
    CellAnchor anchor;
    anchor.boxes.push_back({0, {Matrix3::Identity(), Vector3(0.0, 1.5, 0.5)}});
    state = simulation.take_up(anchor);
  }
  void advance(int ticks) {
    const motion::PreparedProgram still = simulation.prepare(
        {"still", {motion::make_waypoint(motion::MotionClass::Home, {}, state.controller.command.X_WE)}});
    for (int i = 0; i < ticks; ++i) {
      (void)simulation.advance(still, state, work);
      watch.follow(simulation, state);
    }
  }
  Simulation simulation;
  CellState state;
  CellWorkspace work;
  RestWatch watch{0.0};
};

TEST_F(Falling, ABoxIsAtRestATenthOfASecondAfterItMovedLast) {
  EXPECT_TRUE(watch.is_at_rest(simulation.time(state))) << "nothing was seen to move";
  advance(10);
  EXPECT_FALSE(watch.is_at_rest(simulation.time(state)));
  advance(500);  // it lies on the ground
  EXPECT_TRUE(watch.is_at_rest(simulation.time(state)));
}

TEST_F(Falling, AMomentInWhichABoxIsSlowIsNoRest) {
  advance(500);
  physics::BodyState& box = state.world.bodies[static_cast<std::size_t>(simulation.world().parcels[0].index)];
  box.velocity = Vector3(0.0, 0.0, 0.2);
  watch.follow(simulation, state);
  box.velocity = Vector3::Zero();  // where a box that rocks turns back
  watch.follow(simulation, state);
  EXPECT_FALSE(watch.is_at_rest(simulation.time(state)));
  advance(13);
  EXPECT_TRUE(watch.is_at_rest(simulation.time(state)));
}

}  // namespace
}  // namespace snug::cell
