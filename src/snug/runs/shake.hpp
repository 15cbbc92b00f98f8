// shake: a container with its load, driven with accelerations: which boxes shift, tip or fall.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "snug/core/expected.hpp"
#include "snug/model/placements.hpp"
#include "snug/model/scenario.hpp"
#include "snug/runs/shake_profile.hpp"

namespace snug::runs {

/// What holds a load beside walls and friction, as simple models.
enum class LoadHold {
  None,
  Film,   ///< stretch film, wound around the load before it is driven: hoops under tension that shear
  Straps  ///< over the top: the boxes that carry no other are pressed down by 600 N together
};
[[nodiscard]] const char* name_of(LoadHold hold);

/// When a load holds, beside the tilt of its boxes.
enum class ShakeLimits {
  Boxes,      ///< no box moves by more than `shift` at any time
  Eumos40509  ///< of a load of height H, boxes may move by 10 % of H; in the end by 5 % of H and 60 mm at most, and
              ///< those whose middle is in the lowest 0.2 m by 40 mm
};
[[nodiscard]] const char* name_of(ShakeLimits limits);

struct ShakeOptions {
  LoadHold hold = LoadHold::None;
  ShakeLimits limits = ShakeLimits::Boxes;
  int film_layers = 4;                   ///< 1 to 40, each under 87.5 N per metre of height
  int draws = 4;                         ///< of friction, beside the scenario's own
  std::uint64_t seed = 1;                ///< of the draws
  bool all_frictions = false;            ///< every motion with each of them, also where one decides
  double shift = 0.020;                  ///< m, that a box may move at any time from where it stood
  double tilt = 0.105;                   ///< rad, that it may tip
  std::optional<double> time_step = {};  ///< s; absent: the scenario's times 2, or 4 where all is soft
  int threads = 1;                       ///< results do not depend on it
};

/// One box, over one motion.
struct ShakenBox {
  std::string id;
  double shift = 0.0;      ///< m, the largest
  double remaining = 0.0;  ///< m, in the end
  double tilt = 0.0;       ///< rad, the largest change of what is up
  bool fell = false;       ///< out of the container, or off the pallet
  double part = 0.0;       ///< of its limits, the largest
  bool operator==(const ShakenBox&) const = default;
};

/// One motion with one friction.
struct ShakeRun {
  std::string motion;     ///< of the profile; before any "at rest" and, with film, "wound", where shifts do not count
  double friction = 1.0;  ///< times the scenario's
  std::vector<ShakenBox> boxes;
  double worst = 0.0;            ///< largest shift or tilt over its limit; infinity where a box fell
  double worst_time = 0.0;       ///< s
  std::vector<Pose> worst_X_TP;  ///< of the boxes then
  std::int64_t steps = 0;        ///< that were simulated: a load at rest under forces that keep it there needs none
  bool is_sound = true;          ///< false: a step did not come to finite numbers, and counts as fallen
  bool operator==(const ShakeRun&) const = default;
};

struct ShakeResult {
  std::vector<std::string> boxes;
  std::vector<Vector3> sizes;  ///< m
  Vector3 inner_size = Vector3::Zero();
  double shift = 0.0;          ///< m, allowed at any time
  double remaining = 0.0;      ///< m, allowed in the end; infinite where only the shift counts
  int film_layers = 0;         ///< 0: no film
  std::vector<ShakeRun> runs;  ///< motion by motion, from the least friction on
  std::size_t worst = 0;       ///< of runs
  double seconds = 0.0;        ///< of motion, in all runs
  [[nodiscard]] bool holds() const { return runs.empty() || runs[worst].worst <= 1.0; }
};

/// The load at rest for half a second, film wound around it where it has some, then each motion of the profile from
/// there. In the frame of the container: what accelerates it acts on each box as a force the other way. A container
/// stays as it is, fixed on what carries it. Every motion is run with the least friction; then with the most, where the
/// load holds and moves by more than half a limit; then with those between, where it holds and comes near a limit.
/// While the load rests under forces that keep it at rest, no steps are taken. Throws InputError for a load without
/// boxes, a scenario without target and options out of range.
[[nodiscard]] ShakeResult shake(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
                                const std::vector<ShakeMotion>& profile, const ShakeOptions& options);

/// With as little film as holds the load, tried layer by layer from one on; if none of 1 to `most` layers does, what
/// came of the number of layers with which it came nearest. options.hold is film.
[[nodiscard]] ShakeResult shake_with_least_film(const model::Scenario& scenario,
                                                const std::vector<model::PlacementEntry>& load,
                                                const std::vector<ShakeMotion>& profile, ShakeOptions options,
                                                int most);

}  // namespace snug::runs
