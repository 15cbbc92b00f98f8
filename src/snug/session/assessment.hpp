// assess: what a motion came to, by what is believed after it, as a function of the belief.
#pragma once

#include <optional>
#include <vector>

#include "snug/planning/scene.hpp"
#include "snug/session/agenda.hpp"

namespace snug::session {

struct Assessment {
  Trouble trouble = Trouble::None;
  std::optional<Pose> X_TP;     ///< of the item; none: it is gone, and nothing below is known
  double position_error = 0.0;  ///< m, level
  double angle_error = 0.0;     ///< rad
  double displacement = 0.0;    ///< m, of the other box that was moved farthest
};

/// `before`: where boxes were believed to be when the motion began. Boxes under way are nobody else's trouble.
[[nodiscard]] Assessment assess(const planning::Scene& scene, const Agenda& agenda, model::ItemIndex item,
                                const packing::Placement& planned, const std::vector<std::optional<Pose>>& before);

/// A box that stands over the rim or beyond a wall, another one first; none: none does.
[[nodiscard]] std::optional<model::ItemIndex> find_sticking_out(const planning::Scene& scene, const Agenda& agenda,
                                                                model::ItemIndex item);
/// Of the others that were moved beyond the limit, or tipped, the highest: it may lie on the rest; none: none was.
[[nodiscard]] std::optional<model::ItemIndex> find_moved(const planning::Scene& scene, const Agenda& agenda,
                                                         model::ItemIndex item,
                                                         const std::vector<std::optional<Pose>>& before);
/// Higher than it was by more than the limit of displacements: it lies on others.
[[nodiscard]] bool was_lifted(const planning::Scene& scene, model::ItemIndex item,
                              const std::vector<std::optional<Pose>>& before);
/// What the end of a motion alone says.
[[nodiscard]] Trouble trouble_of(plant::EndReason reason);

}  // namespace snug::session
