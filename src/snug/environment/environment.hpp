// Environment: packing as a game of single placements, for those who learn: reset, step, look.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "snug/packing/place_finder.hpp"

namespace snug::environment {

/// What becomes of a box that is placed.
enum class Mode {
  Geometric,  ///< it is where it was lowered: boxes do not move
  Statics,    ///< it is set down there, at rest, and has to stay for `settle_time` under gravity, with contact
  Executed,   ///< the tool brings it from the aligner through the air, with cup and contact
};

/// What is the same in every episode. Lengths in m.
struct Settings {
  Mode mode = Mode::Geometric;
  /// Item sequence of the scenario; empty: every parcel of it, in an order drawn anew for each episode.
  std::string sequence;
  packing::PackingSettings packing{.max_flips = 1, .planned_interference = 0.0, .min_support = 0.6};
  double resolution = 0.01;  ///< edge of a cell of the height map
  int max_candidates = 64;
  int max_steps = 1000;      ///< an episode that has not ended then is truncated
  double settle_time = 0.5;  ///< s, Statics
  /// s, Statics and Executed: physics steps are as long as this allows, in whole parts of the controller's tick, and no
  /// shorter than the scenario's; 0: the scenario's. docs/python.md says what 4 ms change.
  double time_step = 0.004;
  bool varies = false;  ///< the cell is drawn anew for each episode, from the scenario's uncertainty
  /// When a box counts as placed: how far it may come to rest from where it was meant to, m and rad.
  double max_displacement = 0.020;
  double max_tilt = 0.10471975511965977;
};

/// What makes one environment of many its own.
struct Parameters {
  double size_offset = 0.0;     ///< m, on each edge of each box
  double friction_scale = 1.0;  ///< of each pair's coefficient
  double cup_scale = 1.0;       ///< of the cup's stiffness and damping
  double mass_scale = 1.0;      ///< of each box
};

/// Either a candidate of the last observation, or a place.
struct Action {
  int candidate = -1;       ///< index; -1: the place below
  int orientation = 0;      ///< index into orientations()
  double x = 0.0, y = 0.0;  ///< m, in T: middle of the box
};

struct Step {
  double reward = 0.0;        ///< change of the packed volume, part of the container's
  bool terminated = false;    ///< the last box was packed, one could not be, or the next has no place
  bool truncated = false;     ///< after max_steps
  std::string_view reason;    ///< why it ended; empty while it goes on
  double displacement = 0.0;  ///< m, of the box from where it was meant to come to rest
  bool is_placed = false;
};

/// Where observe() writes; empty spans are left out. Sizes as the functions of Environment say. Rows: see there.
struct ObservationView {
  std::span<float> height_map;  ///< rows() x columns(), m over the floor, row by row along Ty
  std::span<float> item;        ///< kItemNumbers
  std::span<float> boxes;       ///< most_boxes() x kBoxNumbers, zeros behind the last
  std::span<float> candidates;  ///< max_candidates x kCandidateNumbers, zeros behind the last
  std::span<std::int8_t> mask;  ///< max_candidates, 1: there is one
};

/// Size as it arrives along Ax, Ay, Az [m], mass [kg], upright only, nothing on it (0 or 1).
inline constexpr int kItemNumbers = 6;
/// Low corner and high corner in T [m], mass [kg].
inline constexpr int kBoxNumbers = 7;
/// Low corner in T, extents [m], support (0 .. 1), index of the orientation.
inline constexpr int kCandidateNumbers = 8;

/// One container that is packed again and again. Copies are snapshots: going on from one gives the same. Same seed,
/// same actions: same bytes. One thread at a time.
class Environment {
 public:
  /// Throws InputError for an unknown sequence, settings that cannot be, and a scenario that has no container
  /// (Executed: no aligner, no tool).
  Environment(const model::Scenario& scenario, const Settings& settings, const Parameters& parameters = {});
  Environment(const Environment& other);
  Environment& operator=(const Environment& other);
  Environment(Environment&&) noexcept;
  Environment& operator=(Environment&&) noexcept;
  ~Environment();

  /// A new episode; its items and what varies are drawn from the seed.
  void reset(std::uint64_t seed);
  /// Places the item that waits. An action that cannot be done ends the episode. After its end nothing happens.
  Step step(const Action& action);
  void observe(const ObservationView& view) const;

  [[nodiscard]] const Settings& settings() const;
  [[nodiscard]] int rows() const;
  [[nodiscard]] int columns() const;
  /// Items of an episode.
  [[nodiscard]] int most_boxes() const;
  /// Of an item that may be put on any side: what Action::orientation counts.
  [[nodiscard]] static const std::vector<packing::Orientation>& orientations();

  [[nodiscard]] const std::vector<packing::Item>& items() const;
  /// The next item's index; as many as items when none is left.
  [[nodiscard]] int next() const;
  [[nodiscard]] bool has_ended() const;
  [[nodiscard]] const std::vector<packing::Place>& candidates() const;
  /// As they stand (Geometric: as they were put).
  [[nodiscard]] const std::vector<packing::PlacedBox>& boxes() const;
  /// Percent of the container's inner volume.
  [[nodiscard]] double packed_percent() const;
  /// s, simulated in this episode; 0 in Geometric.
  [[nodiscard]] double time() const;
  [[nodiscard]] std::uint64_t hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace snug::environment
