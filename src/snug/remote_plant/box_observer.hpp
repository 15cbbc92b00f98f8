// BoxObserver: where the boxes of a cell are that another program serves, for somebody who only looks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/click/client.hpp"
#include "snug/model/scenario.hpp"
#include "snug/perception/perception.hpp"

namespace snug::remote_plant {

/// m, of the object `name`, as its sensor says; else `otherwise`.
[[nodiscard]] Vector3 sensed_size(const click::Sensor& sensed, const std::string& name, const Vector3& otherwise);
/// Nothing where the box is not in the cell, or does not tell where.
[[nodiscard]] std::optional<perception::SceneBox> sensed_box(const click::Sensor& sensed, const std::string& name,
                                                             const std::string& item, const Vector3& size);

/// The boxes of a sequence through the sensors of their objects.
class BoxObserver {
 public:
  /// Connects to a CLICK address (tcp://HOST:PORT, ipc://PATH) beside whoever drives the cell. Throws InputError when
  /// nobody answers there, and for a cell without a box of the sequence.
  BoxObserver(const model::Scenario& scenario, const std::string& sequence, const std::string& endpoint,
              double patience);

  /// What is sensed now; empty, or why that cannot be known any more.
  [[nodiscard]] std::string look();
  /// At the last look, for each item of the sequence; nothing of those that are not in the cell.
  [[nodiscard]] std::vector<std::optional<perception::SceneBox>> boxes() const;
  /// m, as the sensors say, or the scenario where they do not.
  [[nodiscard]] Vector3 size_of(std::size_t item) const;

 private:
  struct Item {
    std::string id, name;  ///< of the box, of its object
    Vector3 size;          ///< m, of the scenario
  };
  std::vector<Item> items_;
  click::Client client_;
  click::Sensor last_;
};

}  // namespace snug::remote_plant
