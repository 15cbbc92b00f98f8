// ObserverPort: an address at which CLICK observers see a cell that something else drives.
#pragma once

#include <memory>
#include <string>

#include "snug/served_cell/served_cell.hpp"

namespace snug::served_cell {

/// Answers handshakes and requests for sensors, as a plant's (ServedCellSettings::is_plant), whoever asks; a Control or
/// a Reset is answered by an Error and changes nothing.
class ObserverPort {
 public:
  /// Binds tcp://HOST:PORT of this machine (port * is any that is free) or ipc://PATH; the simulation outlives the
  /// port. Throws InputError for an address that cannot be had or that other machines can reach.
  ObserverPort(const cell::Simulation& simulation, const std::string& endpoint);
  ~ObserverPort();
  ObserverPort(const ObserverPort&) = delete;
  ObserverPort& operator=(const ObserverPort&) = delete;

  /// The address as it was bound.
  [[nodiscard]] const std::string& endpoint() const;
  /// Answers what was asked since the last time, by the cell as it is now. Never waits. `load`: on the tool.
  void answer(const cell::CellState& state, const cell::ArmReading& reading, const Wrench& load);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::served_cell
