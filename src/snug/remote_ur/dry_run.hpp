// DryRun: a plant that is packed, and a robot elsewhere that makes each motion before it, in the air.
#pragma once

#include <optional>

#include "snug/plant/event.hpp"

namespace snug::remote_ur {

/// Each motion is made by `robot` first and by `packed` then; everything else is `packed` alone. Where the robot does
/// not come to the end of a motion, the motion is a Fault that says why, and no motion follows; one that is cancelled
/// is Cancelled.
class DryRun final : public plant::Plant {
 public:
  /// Neither is owned.
  DryRun(plant::Plant& packed, plant::Plant& robot) : packed_(packed), robot_(robot) {}

  [[nodiscard]] plant::Description describe() const override { return robot_.describe(); }
  [[nodiscard]] plant::Feedback read() override { return packed_.read(); }
  [[nodiscard]] bool is_moving() const override { return motion_.has_value() || packed_.is_moving(); }
  void start(const plant::Motion& motion) override;
  [[nodiscard]] std::vector<plant::Event> advance() override;
  void cancel() override;
  [[nodiscard]] bool bring(const model::ParcelId& item) override { return packed_.bring(item); }
  void perceive(std::span<const perception::Expectation> expected) override { packed_.perceive(expected); }
  void acknowledge() override;

 private:
  plant::Plant& packed_;
  plant::Plant& robot_;
  std::optional<plant::Motion> motion_;  ///< while the robot makes it
};

}  // namespace snug::remote_ur
