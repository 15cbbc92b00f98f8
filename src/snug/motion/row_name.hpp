// RowName: which box a row of a program is for, by the row's name: written one way, read in ours and the
// demonstrator's.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace snug::motion {

/// Name of a row of our own programs: what it does, the whole id of the box, what tells it from others of its kind:
/// "PrePick(BOX027)_turn". A table of limits that names a box of the demonstrator ("PrePlace018") does not match it.
[[nodiscard]] std::string row_name(std::string_view kind, std::string_view box, std::string_view suffix = {});

/// How a box swings that hangs from the cup: its two longest periods, s, 0.01 to 9.99.
struct Swing {
  double slow = 0.0;
  double fast = 0.0;
  bool operator==(const Swing&) const = default;
};
/// The name of a row on whose way such a box hangs: "PrePlace(BOX027)~0.42+0.31". Fast motions leave nothing of these
/// swings: they are averaged over the slow one, and half of them comes half the fast one later.
[[nodiscard]] std::string with_swing(const std::string& row, const Swing& swing);
/// What with_swing has written; nothing for other names.
[[nodiscard]] std::optional<Swing> swing_of(std::string_view row) noexcept;

/// How well the row's name fits the box `id` when it is a row of this kind; 0: it is not for that box. Of several boxes
/// it is for the one that it fits best. After the kind stands the id in brackets, or bare, or, for ids of the
/// demonstrator's form BOX027, its number ("PrePick027", "PrePick_027", "PrePickBox027"), which counts less than a
/// whole id of the same length; a suffix behind a bare one begins with '_'.
[[nodiscard]] std::size_t names_box(std::string_view row, std::string_view kind, std::string_view id) noexcept;

}  // namespace snug::motion
