// Scenario text: the text of a scenario with parts added or changed, so that what runs can be written down whole.
#pragma once

#include <yaml-cpp/yaml.h>

#include <map>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"

namespace snug::model::internal {

/// A tree as text; comments are lost.
[[nodiscard]] std::string text_of(const YAML::Node& root);
/// A changed tree as text; comments at its beginning say why, and why it was changed before.
[[nodiscard]] std::string text_of(const YAML::Node& root, const std::string& text, const std::string& why);

/// The text with the entries of `items` (lists parcel_types, parcels, sequences) behind its own. Comments are lost:
/// what is left is the same scenario. `why` becomes the first line, a comment.
[[nodiscard]] std::string text_with_items(const std::string& text, const YAML::Node& items, const std::string& why);

/// Key of a list, and entries for it.
using NewEntries = std::map<std::string, std::vector<std::string>>;
/// The same of entries that are text already.
[[nodiscard]] std::string text_with_entries(const std::string& text, const NewEntries& entries, const std::string& why);

/// The text with these things of `container` in its entry of that name: inner_size, walls, holds_all; and it is the
/// target.
[[nodiscard]] std::string text_with_target(const std::string& text, const Container& container, const std::string& why);

/// A parcel type, a parcel with uniform density and a sequence, as an entry in a scenario's list of such.
[[nodiscard]] std::string entry_of(const ParcelType& type);
[[nodiscard]] std::string entry_of(const Scenario& scenario, const Parcel& parcel);
[[nodiscard]] std::string entry_of(const Sequence& sequence);

}  // namespace snug::model::internal
