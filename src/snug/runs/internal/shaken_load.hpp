// ShakenLoad: a container with its load, in the frame of the container, and what its motions do to the boxes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snug/cell/world_builder.hpp"
#include "snug/model/scenario.hpp"
#include "snug/physics/world.hpp"
#include "snug/runs/internal/film.hpp"
#include "snug/runs/shake.hpp"

namespace snug::runs::internal {

inline constexpr double kSettleTime = 0.5;  ///< s, at rest before anything is driven
inline constexpr double kWindTime = 2.0;    ///< s, in which the tension of film rises; then it stays for kSettleTime

struct AllowedShift {
  double shift = 0.0;             ///< m, at any time
  std::vector<double> remaining;  ///< m, in the end, box by box
};

/// By options.limits; EUMOS 40509 goes by the height of the load.
[[nodiscard]] AllowedShift allowed_shift(const model::Scenario& scenario,
                                         const std::vector<model::PlacementEntry>& load, const ShakeOptions& options);

class ShakenLoad {
 public:
  /// `scenario` has one container, the target, and one sequence: the boxes of `load`.
  ShakenLoad(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
             const ShakeOptions& options);

  /// What stands by itself, then what the film makes of it; what the motions begin with.
  [[nodiscard]] std::vector<ShakeRun> settle();
  /// From where settle() ended.
  [[nodiscard]] ShakeRun shake(const ShakeMotion& motion);

 private:
  enum class FilmState { Off, Winding, Wound };

  [[nodiscard]] ShakeRun wind();
  [[nodiscard]] ShakeRun drive(const ShakeMotion& motion);
  void measure(double time, ShakeRun& run);
  void judge_end(double time, ShakeRun& run) const;

  [[nodiscard]] bool advance(const ShakeSample& sample);
  void push(const ShakeSample& now);
  void pull_film(double time);

  [[nodiscard]] bool is_at_rest() const { return quiet_steps_ >= steps_of(kQuietTime); }
  [[nodiscard]] bool rests_under(const ShakeSample& sample);
  [[nodiscard]] std::int64_t skip_rest(const ShakeMotion& motion, std::int64_t step, std::int64_t steps);
  /// Steps that take this long, two at least.
  [[nodiscard]] std::int64_t steps_of(double time) const;
  [[nodiscard]] std::vector<Pose> poses() const;

  static constexpr double kQuietTime = 0.020;  ///< s, below the speeds of sleep: then the load is at rest

  const ShakeOptions& options_;
  AllowedShift allowed_;
  cell::CellWorld world_;
  physics::Workspace work_;
  Pose X_WT_;
  Vector3 inner_;
  physics::WorldState state_, rested_;
  Film film_, rested_film_;
  FilmState film_state_ = FilmState::Off;
  bool counts_shift_ = true;  ///< false: of a motion that moves the load on purpose
  std::vector<Wrench> film_T_;
  std::vector<std::string> ids_;
  std::vector<bool> is_top_;
  std::vector<Pose> reference_;
  std::vector<physics::ExternalWrench> wrenches_;
  std::int64_t steps_ = 0;
  std::int64_t quiet_steps_ = 0, rested_steps_ = 0;  ///< since when all boxes have been slow; after settle()
  double tried_ = -1.0;                              ///< s, end of the piece of motion that was tried last
};

}  // namespace snug::runs::internal
