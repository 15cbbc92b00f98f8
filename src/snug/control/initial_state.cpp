// Initial: where the demonstrator's controller begins, and which it leaves at once.
#include "snug/control/states.hpp"

namespace snug::control {
namespace {

class InitialState final : public State {
 public:
  [[nodiscard]] std::string_view name() const override { return "Initial"; }
  [[nodiscard]] Outcome run(StateContext&) const override { return Outcome::Ok; }
};

}  // namespace

std::unique_ptr<State> make_initial_state() { return std::make_unique<InitialState>(); }

}  // namespace snug::control
