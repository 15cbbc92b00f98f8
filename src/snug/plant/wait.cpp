// Waiting for one thing of a plant that does nothing else meanwhile.
#include "snug/plant/wait.hpp"

namespace snug::plant {

Feedback run(Plant& plant, const Motion& motion) {
  plant.start(motion);
  for (;;) {
    for (const Event& event : plant.advance()) {
      if (const auto* ended = get<MotionEnded>(event)) return ended->feedback;
    }
  }
}

bool bring_and_wait(Plant& plant, const model::ParcelId& item) {
  if (!plant.bring(item)) return false;
  for (;;) {
    for (const Event& event : plant.advance()) {
      if (const auto* arrived = get<ItemArrived>(event); arrived != nullptr && arrived->item == item) return true;
      if (get<FaultRaised>(event) != nullptr) return false;
    }
  }
}

perception::Observation observe(Plant& plant, std::span<const perception::Expectation> expected) {
  plant.perceive(expected);
  for (;;) {
    for (const Event& event : plant.advance()) {
      if (const auto* seen = get<Perceived>(event)) return seen->observation;
    }
  }
}

}  // namespace snug::plant
