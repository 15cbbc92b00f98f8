// Waypoint names: what a waypoint is for, as files say it: written one way, read in ours and the demonstrator's.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "snug/motion/waypoint.hpp"

namespace snug::motion {

/// How a file names the waypoint: its class, the whole id of its box in brackets, its variant, its swing, when it may
/// begin: "PrePlace(BOX027)_2~0.42+0.31", or "~0.42+0.31*0.70" at 0.7 of the tempo, "PrePick(BOX027)@7.512". A table of
/// limits that names a box of the demonstrator ("PrePlace018") does not match it. An item that is no id stands behind
/// the class as it is.
[[nodiscard]] std::string name_of(const Waypoint& waypoint);
/// A waypoint of that name, at the identity: the inverse of name_of. After the class stands the id in brackets (the
/// last one ends it, ids may have some), or bare as the demonstrator writes it. A swing may have a variant behind it.
/// Names that begin with no class are Other, all of them variant.
[[nodiscard]] Waypoint parse_waypoint_name(std::string_view name);
/// Whether something behind a '~' of the name is meant as a swing, a number or with a '+', and is none: "~nan+0",
/// "~0.42", "~0.42+0.31*2"; files may not have it.
[[nodiscard]] bool has_malformed_swing(const Waypoint& waypoint);
/// The same of an instant, a number behind the last '@': "@-1", "@nan", "@1e9".
[[nodiscard]] bool has_malformed_instant(const Waypoint& waypoint);
/// The same as parse_waypoint_name at a pose, with switches.
[[nodiscard]] Waypoint named_waypoint(std::string_view name, const Pose& X_WE, const IO& io = {});

/// `swing` rounded to what a file keeps. Its periods must be from 0.01 to 9.99 s, its pace from 0.01 to 1 (checked).
[[nodiscard]] Swing as_named(const Swing& swing);

/// `time`, from 0 to kLatestDeparture (checked), rounded to what a file keeps; none: at the start.
[[nodiscard]] std::optional<double> as_named(double time);

/// How well the waypoint's item fits the box `id`; 0: it is not for that box. Of several boxes it is for the one that
/// it fits best. What is no id itself is an id, or, for ids of the demonstrator's form BOX027, its number ("027",
/// "_027", "Box027"), which counts less than a whole id of the same length; a suffix behind it begins with '_'.
[[nodiscard]] std::size_t fit_of(const Waypoint& waypoint, std::string_view id) noexcept;

}  // namespace snug::motion
