// The readers of the two formats.
#pragma once

#include "snug/scene_import/internal/raw_scene.hpp"
#include "snug/scene_import/internal/xml.hpp"

namespace snug::scene_import::internal {

[[nodiscard]] RawScene read_mjcf(const Node& root, XmlFiles& files);
[[nodiscard]] RawScene read_sdf(const Node& root, XmlFiles& files);

}  // namespace snug::scene_import::internal
