// Beliefs for tests: two items of the demonstrator, one in the container, one at the aligner.
#pragma once

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/rng.hpp"
#include "snug/model/test/shortened.hpp"
#include "snug/planning/belief_snapshot.hpp"

namespace snug::planning::test {

/// Nothing was seen yet; the second item stands at the aligner.
inline BeliefSnapshot first_belief(int samples = 2) {
  BeliefSnapshot belief;
  belief.scenario = model::test::shortened(2);
  belief.sequence = "1";
  belief.seed = 5;
  belief.simulation.tracking = motion::FastTracking{};
  belief.agent.name = packing::name_of(packing::AgentKind::Margin);
  belief.agent.future = packing::make_future_model(belief.scenario);
  belief.worlds = draw_worlds(belief.scenario, belief.sequence, belief.seed, samples);
  const model::Sequence& sequence = *model::find_sequence(belief.nominal(), belief.sequence);
  belief.items = packing::make_items(belief.nominal(), sequence);
  belief.boxes.resize(2);
  belief.skips_left = 2;
  belief.robot.X_WE = belief.scenario.controller.X_WE_start;
  for (World& world : belief.worlds) {
    const model::Item& item = model::find_sequence(world.scenario, belief.sequence)->items[1];
    world.X_WP[1] = cell::arrival_pose(world.scenario, item);
  }
  belief.boxes[1] = BelievedBox{*belief.worlds[0].X_WP[1], Matrix6::Identity() * 1e-6, true};
  return belief;
}

/// Everything in it that can be set.
inline BeliefSnapshot random_belief(std::uint64_t seed) {
  Rng rng(seed);
  BeliefSnapshot belief = first_belief(3);
  const Pose X_WT = model::find_container(belief.scenario, belief.scenario.target)->X_WT;
  const Pose X_WP = X_WT * Pose{Matrix3::Identity(), Vector3(rng.uniform(-0.05, 0.05), rng.uniform(-0.1, 0.1), 0.05)};
  belief.boxes[0] = BelievedBox{X_WP, Matrix6::Identity() * rng.uniform(), rng.uniform() < 0.5};
  belief.sent.emplace_back(0);
  belief.failed.push_back({model::ItemIndex(1),
                           {belief.items[1].id, {Matrix3::Identity(), Vector3(rng.uniform(), 0.1, 0.05)}, {}, 0},
                           skills::InsertionSkill::Tilted,
                           skills::Reorientation::Pivot,
                           rng.uniform() < 0.5});
  belief.next = model::ItemIndex(0);
  belief.obstacles = {{Vector3(0.0, 0.0, 0.0), Vector3(rng.uniform(0.01, 0.1), 0.1, 0.1)}};
  belief.obstacle_bodies = belief.obstacles;
  belief.robot.q = {rng.normal(), rng.normal()};
  belief.robot.io.vacuum = rng.uniform() < 0.5;
  belief.stiffenings = rng.index(3);
  for (World& world : belief.worlds) {
    world.X_WP[0] = X_WP;
    world.X_WP[0]->p.x() += 0.01 * rng.normal();
    auto& parcels = world.scenario.parcels;
    parcels[static_cast<std::size_t>(rng.index(static_cast<int>(parcels.size())))].size.x() += 0.001 * rng.uniform();
    if (&world != belief.worlds.data()) world.weight = rng.uniform(0.5, 1.5);
    set_obstacles(belief, world);
    stiffen(belief.scenario.belief, 0, belief.stiffenings, world);
  }
  if (seed % 2 == 0) {
    belief.chosen.resize(2);
    belief.chosen[1] = packing::Placement{belief.items[1].id, {Matrix3::Identity(), Vector3(0.0, 0.1, 0.05)}, {}, 0};
  }
  return belief;
}

}  // namespace snug::planning::test
