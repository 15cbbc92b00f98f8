// Placer: what becomes of a box that an action puts somewhere, in statics or executed by the tool.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "snug/environment/environment.hpp"

namespace snug::environment::internal {

struct Outcome {
  bool is_placed = false;
  std::string_view reason;    ///< why not; lives as long as the program
  double displacement = 0.0;  ///< m, of the box from its place
};

/// The items of an episode: a scenario with the sequence of that name.
struct Episode {
  const model::Scenario& scenario;
  const std::string& sequence;
  const Settings& settings;
};

/// The physical side of an episode.
class Placer {
 public:
  virtual ~Placer() = default;
  [[nodiscard]] virtual std::unique_ptr<Placer> clone() const = 0;
  /// Puts item `index` of the episode to a place; `boxes`: all others that stand there, in T.
  [[nodiscard]] virtual Outcome place(int index, const packing::Place& place,
                                      const std::vector<packing::PlacedBox>& boxes) = 0;
  /// X_TP of an item that is in the cell.
  [[nodiscard]] virtual Pose pose_of(int index) const = 0;
  /// Whether it rests inside the container, not above its rim.
  [[nodiscard]] virtual bool is_packed(int index) const = 0;
  [[nodiscard]] virtual double time() const = 0;  ///< s
  [[nodiscard]] virtual std::uint64_t hash() const = 0;
};

[[nodiscard]] std::unique_ptr<Placer> make_statics(const Episode& episode);
[[nodiscard]] std::unique_ptr<Placer> make_execution(const Episode& episode);

/// Tolerances are those of a run's result (cell/item_event_log.hpp). `size`: m, as measured.
[[nodiscard]] bool is_inside(const Vector3& size, const Pose& X_TP, const model::Container& container);
/// Compares where a box came to rest with where it was put.
[[nodiscard]] Outcome judge(const Settings& settings, const Pose& X_TP, const Pose& X_TP_meant, bool is_packed);

}  // namespace snug::environment::internal
