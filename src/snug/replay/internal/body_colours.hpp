// Colours of what is drawn for other programs: those of the page of viewer/ in its light theme, near enough. Internal
// to the module.
#pragma once

#include "snug/record/recording.hpp"
#include "snug/robot/visuals.hpp"

namespace snug::replay::internal {

inline constexpr robot::Rgba kStill = {0.62, 0.64, 0.66, 1.0};
inline constexpr robot::Rgba kSeeThrough = {0.62, 0.64, 0.66, 0.25};
inline constexpr robot::Rgba kMover = {0.25, 0.28, 0.32, 1.0};
inline constexpr robot::Rgba kParcel = {0.82, 0.66, 0.44, 1.0};
inline constexpr robot::Rgba kCupFree = {0.35, 0.35, 0.4, 1.0};
inline constexpr robot::Rgba kCupHolds = {0.0, 0.45, 0.70, 1.0};

/// Of a body without a look of its own; one can see into the container.
inline robot::Rgba body_colour(const record::BodyInfo& body, bool is_container) {
  if (body.kind == record::BodyKind::Dynamic) return kParcel;
  if (is_container) return kSeeThrough;
  return body.kind == record::BodyKind::Static ? kStill : kMover;
}

}  // namespace snug::replay::internal
