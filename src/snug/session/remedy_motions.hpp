// Remedy motions: waypoints of what is done about a trouble, from what is believed and where the robot stands.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/planning/scene.hpp"
#include "snug/plant/plant.hpp"

namespace snug::session {

/// How a box hangs from the cup and how it is to stand.
struct Carried {
  model::ItemIndex item;
  skills::PlannedBox box;
  Matrix3 R_WP;  ///< put down like that
  Pose X_PS;     ///< lip on it
  std::optional<motion::Swing> swing;
};

/// Lets go where the tool is, then straight up over everything.
[[nodiscard]] std::vector<motion::Waypoint> plan_retreat(const planning::Scene& scene, const plant::Feedback& robot,
                                                         const std::string& id);
/// Presses on the box from above where it is believed to be, the vacuum off.
[[nodiscard]] std::vector<motion::Waypoint> plan_press_on(const planning::Scene& scene, model::ItemIndex item);
/// The held box straight up and to the flat surface where boxes are turned, which the cell has.
[[nodiscard]] std::vector<motion::Waypoint> plan_to_bench(const planning::Scene& scene, const plant::Feedback& robot,
                                                          const Carried& held);
/// The box back to the aligner: `held` as it hangs, or picked where it lies or leans.
[[nodiscard]] std::vector<motion::Waypoint> plan_return(const planning::Scene& scene, const plant::Feedback& robot,
                                                        model::ItemIndex item, const std::optional<Carried>& held);
/// The box picked where it lies or leans, and put on the flat surface where boxes are turned. Empty: the cell has none,
/// another box stands there, something stands on the box, or the tool does not reach it.
[[nodiscard]] std::vector<motion::Waypoint> plan_take_out(const planning::Scene& scene, const plant::Feedback& robot,
                                                          model::ItemIndex item);
/// Ways to put down what hangs from the cup where it can be picked again, the best first: at the aligner, or on the
/// flat surface where boxes are turned, where no other box stands; with the tool over it, or as it hangs; turned about
/// the vertical so that the arm reaches every waypoint. `X_PS`: lip on it. Empty: there is none.
[[nodiscard]] std::vector<std::vector<motion::Waypoint>> plan_put_aside(const planning::Scene& scene,
                                                                        const plant::Feedback& robot,
                                                                        model::ItemIndex item, const Pose& X_PS);
/// No box but this one stands at the aligner.
[[nodiscard]] bool is_aligner_free(const planning::Scene& scene, model::ItemIndex item);
/// The aligner is free, and it lies where it can be picked for that, elsewhere than at the aligner, and nothing stands
/// on it.
[[nodiscard]] bool can_return(const planning::Scene& scene, model::ItemIndex item);
/// The tool to its start.
[[nodiscard]] std::vector<motion::Waypoint> plan_home(const planning::Scene& scene, const plant::Feedback& robot);

}  // namespace snug::session
