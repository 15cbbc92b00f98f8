// WatchedCell: a cell that another program serves over CLICK, as somebody sees it who only looks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/click/joint_link.hpp"

namespace snug::remote_plant {

/// Sizes, shapes and the rest of what does not move are the scenario's: the one that is served.
class WatchedCell {
 public:
  /// Connects to a CLICK address (tcp://HOST:PORT, ipc://PATH), beside its controller. Throws InputError when nobody
  /// answers there, and for a cell without the robot or without a box of the sequence.
  WatchedCell(model::Scenario scenario, const std::string& sequence, const std::string& endpoint, double patience,
              const std::optional<click::ClientKeys>& keys = {});

  [[nodiscard]] const cell::Simulation& simulation() const { return simulation_; }
  /// What is sensed now; empty, or why that cannot be known any more.
  [[nodiscard]] std::string look() { return link_.sense(); }
  /// s, simulated, of the last look.
  [[nodiscard]] double time() const { return link_.last().time; }
  /// The cell as it was then: where tool, links and boxes were, at rest.
  [[nodiscard]] cell::CellState state() const;

  /// A box that is in the cell, as its sensors say.
  struct Box {
    std::string id;
    Pose X_WP;
    Vector3 size = Vector3::Zero();  ///< m; the scenario's, where its sensors do not tell
  };
  /// In the order of the sequence.
  [[nodiscard]] std::vector<Box> boxes() const;

 private:
  [[nodiscard]] std::optional<Pose> find_box(std::size_t item) const;

  cell::Simulation simulation_;
  click::Client client_;
  click::JointLink link_;
  std::vector<std::string> names_;  ///< of the items' objects
};

}  // namespace snug::remote_plant
