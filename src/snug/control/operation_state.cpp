// Operation: the program, row by row: motion says where the tool should be, the joints follow.
#include "snug/control/states.hpp"

namespace snug::control {
namespace {

class OperationState final : public State {
 public:
  [[nodiscard]] std::string_view name() const override { return "Operation"; }

  void configure(const StateSettings& settings) override { patience_ = settings.patience; }

  void start(StateContext& context) const override {
    context.machine.program = motion::make_controller_state(context.machine.tool.X_WE);
  }

  [[nodiscard]] Outcome run(StateContext& context) const override {
    motion::ControllerState& program = context.machine.program;
    const bool is_exact = !motion::is_lagged(context.plan.settings.tracking);
    motion::ControllerOutput& out = context.tick.program;
    out = motion::tick(context.plan, context.machine.tool, program);
    context.follow(is_exact ? ToolTarget{out.tool.X_WE, true, out.tool.V_WE}
                            : ToolTarget{out.X_WE_reference, false, {}});
    // The point model's own tool is where the joints put it: the next tick goes on from there.
    if (!is_exact) program.command = context.machine.tool;
    out.tool = context.machine.tool;
    if (out.finished_now) return Outcome::Ok;
    return is_stuck(context) ? Outcome::Stuck : Outcome::GoesOn;
  }

 private:
  /// Not there long after the reference was.
  [[nodiscard]] bool is_stuck(const StateContext& context) const {
    const motion::ControllerState& program = context.machine.program;
    if (program.phase != motion::ControllerPhase::Moving) return false;
    const double elapsed = static_cast<double>(program.phase_ticks) * context.plan.settings.tick;
    const bool is_fast = motion::is_fast(context.plan.settings.tracking);
    return elapsed > (is_fast ? program.paced.duration() : program.segment.duration()) + patience_;
  }

  double patience_ = 10.0;
};

}  // namespace

std::unique_ptr<State> make_operation_state() { return std::make_unique<OperationState>(); }

}  // namespace snug::control
