// Element bodies: bodies under implicit force elements, each with its forces linear in its velocity at the end of the
// step.
#pragma once

#include "snug/physics/world.hpp"

namespace snug::physics::internal {

struct Scratch;

struct BodyForces {
  Matrix3 inertia_W = Matrix3::Identity();  ///< at the middle of the step
  Vector6 wrench = Vector6::Zero();
  Matrix6 stiffness = Matrix6::Zero();
  Matrix6 damping = Matrix6::Zero();
};

/// A body with elements in Newton's method: its forces at the middle of the step, linear in the velocity at its end.
struct ElementBody {
  int body = -1;
  BodyForces forces;                   ///< at `velocity`
  Vector6 velocity = Vector6::Zero();  ///< guess of the velocity at the end of the step
};

/// Fills work.carriers, once a step.
void place_carriers(const WorldInput& input, Scratch& work);
/// The bodies with elements of one island, each once.
void find_element_bodies(const WorldInput& input, const Scratch& work, int island, std::vector<ElementBody>& found);
/// Evaluates the forces at the body's present velocity. Returns by how much they miss what the last linearisation
/// predicted there, as a velocity.
double evaluate_body(const WorldModel& model, const WorldInput& input, const Scratch& work, ElementBody& element);
/// Sets the body's effective mass and its velocity without contacts (into work.u) from the last evaluation.
void linearize_body(const WorldModel& model, const WorldInput& input, Scratch& work, const ElementBody& element);

}  // namespace snug::physics::internal
