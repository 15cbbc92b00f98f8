// assess: what a motion came to, by what is believed after it, as a function of the belief.
#include "snug/session/assessment.hpp"

#include <algorithm>

namespace snug::session {
namespace {

/// m, as it was seen, less what the observation may be off.
double moved(const planning::Scene& scene, model::ItemIndex item, const std::vector<std::optional<Pose>>& before) {
  const std::optional<Pose>& was = before[item.slot()];
  const std::optional<planning::BelievedBox>& box = scene.box(item);
  if (!was || !box || !box->was_seen) return 0.0;
  return std::max(0.0, (box->X_WP.p - was->p).norm() - planning::slack_of(*box));
}

/// It leans by more than the limit and did not before: moved, however little its middle was.
bool was_tipped(const planning::Scene& scene, model::ItemIndex item, const std::vector<std::optional<Pose>>& before) {
  const std::optional<Pose>& was = before[item.slot()];
  const std::optional<planning::BelievedBox>& box = scene.box(item);
  if (!was || !box || !box->was_seen || scene.locate(item) != planning::Location::Container) return false;
  const double limit = scene.cell.limits.tilt;
  return packing::lean_of(box->X_WP.R) > limit && packing::lean_of(was->R) <= limit;
}

}  // namespace

Trouble trouble_of(plant::EndReason reason) {
  switch (reason) {
    case plant::EndReason::Completed:
      return Trouble::None;
    case plant::EndReason::ForceGuard:
      return Trouble::ForceGuard;
    case plant::EndReason::HoldGuard:
      return Trouble::HoldGuard;
    case plant::EndReason::NoSeal:
      return Trouble::NoSeal;
    case plant::EndReason::VacuumLost:
      return Trouble::VacuumLost;
    case plant::EndReason::ProtectiveStop:
      return Trouble::ProtectiveStop;
    case plant::EndReason::Timeout:
      return Trouble::Timeout;
    case plant::EndReason::Cancelled:
      return Trouble::Cancelled;
    case plant::EndReason::Refused:
    case plant::EndReason::Fault:
      return Trouble::PlantFault;
  }
  return Trouble::PlantFault;
}

std::optional<model::ItemIndex> find_sticking_out(const planning::Scene& scene, const Agenda& agenda,
                                                  model::ItemIndex item) {
  const auto is_out = [&](model::ItemIndex one) {
    return !agenda.left_out.contains(one) && scene.is_seen_sticking_out(one);
  };
  for (const model::ItemIndex other : scene.belief.sent) {
    if (agenda.is_under_way(other) || !scene.box(other)) continue;
    if (scene.locate(other) == planning::Location::Container && is_out(other)) return other;
  }
  return is_out(item) ? std::optional(item) : std::nullopt;
}

std::optional<model::ItemIndex> find_moved(const planning::Scene& scene, const Agenda& agenda, model::ItemIndex item,
                                           const std::vector<std::optional<Pose>>& before) {
  std::optional<model::ItemIndex> highest;
  for (const model::ItemIndex other : scene.belief.sent) {
    if (other == item || agenda.is_under_way(other)) continue;
    const bool is_moved = moved(scene, other, before) > scene.cell.limits.displacement;
    if (!is_moved && !was_tipped(scene, other, before)) continue;
    if (!highest || scene.X_WP(other).p.z() > scene.X_WP(*highest).p.z()) highest = other;
  }
  return highest;
}

bool was_lifted(const planning::Scene& scene, model::ItemIndex item, const std::vector<std::optional<Pose>>& before) {
  const std::optional<Pose>& was = before[item.slot()];
  return was && scene.box(item) && scene.X_WP(item).p.z() > was->p.z() + scene.cell.limits.displacement;
}

Assessment assess(const planning::Scene& scene, const Agenda& agenda, model::ItemIndex item,
                  const packing::Placement& planned, const std::vector<std::optional<Pose>>& before) {
  if (!scene.box(item)) return {Trouble::Gone, {}};
  const settings::PlaceLimits& limits = scene.cell.limits;
  Assessment now;
  const Pose X_TP = scene.cell.layout.X_WT.inverse() * scene.X_WP(item);
  now.X_TP = X_TP;
  now.position_error = (X_TP.p - planned.X_TP.p).head<2>().norm();
  now.angle_error = angle_between(X_TP.R, planned.X_TP.R);
  for (const model::ItemIndex other : scene.belief.sent) {
    if (other != item) now.displacement = std::max(now.displacement, moved(scene, other, before));
  }
  const auto found = [&](Trouble trouble) {
    now.trouble = trouble;
    return now;
  };
  // Nothing outside the container is to be pressed on.
  if (scene.locate(item) != planning::Location::Container) return found(Trouble::OffPlace);
  const auto neighbour = find_moved(scene, agenda, item, before);
  const bool may_lie_on_it = neighbour && scene.X_WP(*neighbour).p.z() > scene.X_WP(item).p.z();
  const bool is_off_place = now.position_error > limits.position || now.angle_error > limits.tilt;
  if (may_lie_on_it && is_off_place) return found(Trouble::NeighbourMoved);
  if (scene.tilt_of(item) > limits.tilt) return found(Trouble::Leaning);
  if (find_sticking_out(scene, agenda, item)) return found(Trouble::SticksOut);
  if (is_off_place) return found(Trouble::OffPlace);
  return found(neighbour ? Trouble::NeighbourMoved : Trouble::None);
}

}  // namespace snug::session
