// Tracking: how the tool follows the reference of a program.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace snug::motion {

/// As the demonstrator's controller: the tool follows the LSPB reference as a critically damped second-order task
/// without feed-forward, behind it; every segment starts from the measured pose; a waypoint is reached when the error
/// is within its precision.
struct LaggedTracking {
  bool operator==(const LaggedTracking&) const = default;
};

/// The tool is on the LSPB reference; a waypoint is reached exactly, at the first tick after the segment's duration.
struct ExactTracking {
  bool operator==(const ExactTracking&) const = default;
};

/// Our own programs: the tool is on a reference of bounded jerk (PacedSegment); waypoints that touch nothing are
/// blended, those in contact and waits for the vacuum end by what is felt (FastSettings).
struct FastTracking {
  double tempo = 1.0;  ///< 0.1 .. 1: fraction of all speeds; accelerations go with its square
  bool operator==(const FastTracking&) const = default;
};

using Tracking = std::variant<LaggedTracking, ExactTracking, FastTracking>;

[[nodiscard]] constexpr bool is_lagged(const Tracking& tracking) noexcept { return tracking.index() == 0; }
[[nodiscard]] constexpr bool is_exact(const Tracking& tracking) noexcept { return tracking.index() == 1; }
[[nodiscard]] constexpr bool is_fast(const Tracking& tracking) noexcept { return tracking.index() == 2; }
/// 1 where the tracking has none.
[[nodiscard]] constexpr double tempo_of(const Tracking& tracking) noexcept {
  const FastTracking* fast = std::get_if<FastTracking>(&tracking);
  return fast != nullptr ? fast->tempo : 1.0;
}

/// "lagged", "exact", "fast": the word of the command line and of recordings.
[[nodiscard]] const char* name_of(const Tracking& tracking);
/// That of the word, at tempo 1. Throws InputError with `where` and the words that there are.
[[nodiscard]] Tracking tracking_of(std::string_view word, const std::string& where);
/// What a user asks for of a program that was made for `made_for`: the tracking of `word`, else fast where there is a
/// `tempo`, else that. Fast without a tempo has that of `made_for`, or 1. Throws as tracking_of.
[[nodiscard]] Tracking choose_tracking(const std::optional<std::string>& word, const std::optional<double>& tempo,
                                       const Tracking& made_for, const std::string& where);

}  // namespace snug::motion
