// ParcelId, ItemIndex: which box is meant, by its name and by its place in a sequence, as types.
#pragma once

#include <compare>
#include <cstddef>
#include <string>
#include <utility>

namespace snug::model {

/// Name of a parcel of the scenario, such as BOX027: what files, protocols and people use.
struct ParcelId {
  std::string value;
  ParcelId() = default;
  explicit ParcelId(std::string name) : value(std::move(name)) {}
  [[nodiscard]] bool empty() const { return value.empty(); }
  auto operator<=>(const ParcelId&) const = default;
};

/// Place of an item in the sequence that is packed, from 0: what programs use. A name is looked up once, where it comes
/// in.
struct ItemIndex {
  int value = -1;
  constexpr ItemIndex() = default;
  constexpr explicit ItemIndex(int index) : value(index) {}
  constexpr explicit ItemIndex(std::size_t index) : value(static_cast<int>(index)) {}
  [[nodiscard]] constexpr bool is_valid() const { return value >= 0; }
  /// Of a vector with an entry for each item of the sequence. The index is valid.
  [[nodiscard]] constexpr std::size_t slot() const { return static_cast<std::size_t>(value); }
  auto operator<=>(const ItemIndex&) const = default;
};

}  // namespace snug::model
