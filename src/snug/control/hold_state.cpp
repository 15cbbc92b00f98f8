// Hold: the robot stands where it came to rest.
#include "snug/control/states.hpp"

namespace snug::control {
namespace {

class HoldState final : public State {
 public:
  [[nodiscard]] std::string_view name() const override { return "Hold"; }
  [[nodiscard]] Outcome run(StateContext& context) const override {
    context.stand();
    return Outcome::GoesOn;
  }
};

}  // namespace

std::unique_ptr<State> make_hold_state() { return std::make_unique<HoldState>(); }

}  // namespace snug::control
