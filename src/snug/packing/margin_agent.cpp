// Agent margin: the state of the art of report section 5.1.2: margins all round, yaw only, nothing pushed.
#include <algorithm>
#include <array>
#include <utility>

#include "snug/packing/internal/agents.hpp"

namespace snug::packing::internal {

namespace {

/// Opinion of the margin agent: as for Policy, and where the box's two corners are, in parts of the container. Found by
/// chance search so that it packs as many boxes of sequences 1 to 5 as the system that it stands for, each within one
/// (docs/theory/packing.md).
constexpr Weights kWeights = {-0.25, -0.45, 0.25, -0.50, 0.03, 0.07, -0.03, -0.07, 0.33, -0.24};
constexpr std::array<double, 4> kPlaceWeights = {-0.19, 0.06, 0.26, 0.36};

double placing_cost(const Layout& layout, const Policy& policy, const Piece& piece, const CandidatePose& pose) {
  const Block me = Layout::block_at(piece, pose);
  const double x = layout.rules().size_x, y = layout.rules().size_y;
  return cost(layout, policy, piece, pose) + kPlaceWeights[0] * me.x1 / x + kPlaceWeights[1] * me.y1 / y +
         kPlaceWeights[2] * me.x2 / x + kPlaceWeights[3] * me.y2 / y;
}

class MarginAgent : public Agent {
 public:
  explicit MarginAgent(AgentInput input) : input_(std::move(input)) {}
  std::string_view name() const override { return name_of(AgentKind::Margin); }

  Expected<Decision, NoPlace> decide(const ContainerState& state, const Item& item) override {
    const Planning planning{state.inner_size, input_.settings, 0, input_.settings.margin, 0.0};
    const Choice choice = make_choice(planning, item);
    if (const auto no = refuse(planning, item, choice)) return tl::unexpected(*no);
    const Rules rules = make_rules(planning, {});
    const Layout layout = to_layout(planning, rules, state);
    CandidatePoseList list;
    Refusal worst = Refusal::None;
    layout.find_poses(choice.piece, list, &worst);
    std::vector<CandidatePose>& poses = list.poses;
    if (poses.empty()) return tl::unexpected(reason_of(worst));
    Policy policy = make_policy(planning, std::span<const Item>(&item, 1));
    policy.weights = kWeights;
    std::vector<std::pair<double, CandidatePose>> ordered;
    for (const CandidatePose& pose : poses)
      ordered.emplace_back(placing_cost(layout, policy, choice.piece, pose), pose);
    std::stable_sort(ordered.begin(), ordered.end(), [](const auto& l, const auto& r) { return l.first < r.first; });
    Decision decision;
    NoPlace reason = NoPlace::NoStablePlace;
    for (const auto& [cost_here, pose] : ordered) {
      if (static_cast<int>(decision.candidates.size()) >= input_.settings.max_candidates) break;
      auto candidate = place_item(planning, layout, item, choice, pose, input_.is_reachable);
      if (!candidate) {
        reason = candidate.error();
        continue;
      }
      candidate->score = -cost_here;
      decision.candidates.push_back(*candidate);
    }
    if (decision.candidates.empty()) return tl::unexpected(reason);
    return decision;
  }

 private:
  AgentInput input_;
};

}  // namespace

std::unique_ptr<Agent> make_margin_agent(AgentInput input) { return std::make_unique<MarginAgent>(std::move(input)); }

}  // namespace snug::packing::internal
