// CellWorld: a Scenario as bodies of the physics, with the names to find them again.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/physics/world.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::cell {

/// A link of the robot as a body: kinematic, or static when it is part of the base.
struct ArmBody {
  physics::BodyId body;
  int link = -1;  ///< of the ArmModel
};

/// A world and which of its bodies is what. Absent bodies have an invalid id.
struct CellWorld {
  physics::WorldModel model;
  physics::BodyId tool;                  ///< kinematic, frame E
  physics::BodyId container;             ///< the target container
  std::vector<ArmBody> arm;              ///< links with shapes that are not part of the tool; named robot/LINK
  std::vector<physics::BodyId> parcels;  ///< of the sequence's items, in its order; absent at the start
  std::vector<physics::BodyId> bodies;   ///< of Scenario::bodies, in their order
  std::vector<physics::BodyId> drops;    ///< boxes of the `drops` block, absent at the start
  std::vector<std::string> types;        ///< box type of each body of the world, or empty
};

struct WorldOptions {
  const model::Sequence* sequence = nullptr;  ///< whose boxes to add
  bool with_tool = false;                     ///< adds the tool's shapes as a kinematic body
  const robot::ArmModel* arm = nullptr;       ///< adds its links, at q
  robot::JointVector q;
};

/// Boxes to drop: which type and where over the container, drawn from the seed of the block.
struct DropPlan {
  struct Box {
    int type = 0;  ///< index into Scenario::parcel_types
    Vector3 p_TP_xy = Vector3::Zero();
    double yaw = 0.0;
  };
  std::vector<Box> boxes;
};
[[nodiscard]] DropPlan plan_drops(const model::Scenario& scenario);

/// Throws nothing: a loaded scenario is complete.
[[nodiscard]] CellWorld build_world(const model::Scenario& scenario, const WorldOptions& options);

/// The state at time 0: bodies with a later appears_at, parcels and drops are absent.
[[nodiscard]] physics::WorldState make_initial_state(const model::Scenario& scenario, const CellWorld& world);

[[nodiscard]] physics::BodyId find_body(const CellWorld& world, std::string_view name);
[[nodiscard]] const std::string& name_of(const CellWorld& world, physics::BodyId body);

}  // namespace snug::cell
