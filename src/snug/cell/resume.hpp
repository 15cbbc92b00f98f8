// Resume: the bodies of a scene as a frame of a recording has them.
#pragma once

#include "snug/cell/world_builder.hpp"

namespace snug::cell {

/// Poses, twists and presence of the scenario's moving bodies and drops, and the time, from the recording's frame at or
/// before InitialState::time. A dynamic body whose recorded twist is zero to the last bit slept and sleeps on. Not in a
/// recording, so not restored: contact impulses to start the solver from, how long bodies have been slow, which of them
/// fell asleep together. Throws InputError when the recording cannot be read, has no such time or lacks a body.
void resume(const model::InitialState& from, const CellWorld& world, physics::WorldState& state);

}  // namespace snug::cell
