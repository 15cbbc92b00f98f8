// Scenario text: the text of a scenario with parts added or changed, so that what runs can be written down whole.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

#include "snug/model/scenario.hpp"

namespace snug::model::internal {

/// A tree as text; comments are lost.
[[nodiscard]] std::string text_of(const YAML::Node& root);

/// The text with the entries of `items` (lists parcel_types, parcels, sequences) behind its own. Comments are lost:
/// what is left is the same scenario. `why` becomes the first line, a comment.
[[nodiscard]] std::string text_with_items(const std::string& text, const YAML::Node& items, const std::string& why);

/// The text with these things of `container` in its entry of that name: inner_size, walls, holds_all; and it is the
/// target.
[[nodiscard]] std::string text_with_target(const std::string& text, const Container& container, const std::string& why);

/// A parcel type, a parcel with uniform density and a sequence, as a scenario has them.
[[nodiscard]] YAML::Node as_yaml(const ParcelType& type);
[[nodiscard]] YAML::Node as_yaml(const Scenario& scenario, const Parcel& parcel);
[[nodiscard]] YAML::Node as_yaml(const Sequence& sequence);

}  // namespace snug::model::internal
