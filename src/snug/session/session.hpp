// Session: packs a plant, item after item: perceive, decide, rehearse, send, perceive, recover.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "snug/session/operator.hpp"
#include "snug/session/resume.hpp"

namespace snug::session {

/// What the caller of a run decides. By what rules is the scenario's.
struct SessionOptions {
  std::string agent = packing::name_of(packing::AgentKind::ContactAware);
  packing::Ask ask = {};  ///< decides in its place, if set (packing/remote_agent.hpp); `agent` is then its name
  packing::DecisionRun decision;
  int threads = 1;           ///< results do not depend on it
  int samples = 8;           ///< sampled worlds in which every motion is rehearsed beside the nominal one; 0: none
  std::optional<int> skips;  ///< in the place of the scenario's (settings::RecoverySettings)
  /// What may follow an item; absent: the other boxes of the order, in any order.
  std::optional<packing::FutureModel> future;
  cell::SimulationOptions simulation{.tracking = motion::FastTracking{}};  ///< of rollouts
  std::function<bool()> is_interrupted;  ///< asked before every item; true ends the session; may be empty
  OperatorSource operator_orders;        ///< what who operates says so far; empty: nobody is asked
  EventSink log;                         ///< told of every event when it happens; may be empty
  /// Goes on from here: the events are told again, their items do not come again. The plant has to be as they say.
  std::optional<ResumePoint> resume;
  /// With `resume`: the robot stands where it was, and may hold a box. That is put down first, a tool that
  /// holds nothing straight up.
  bool takes_over = false;
  /// Folder that gets a file of every belief that is decided on (planning/belief_json.hpp), before it is decided on.
  std::optional<std::filesystem::path> save_beliefs;
};

/// Called after every item.
using Progress = std::function<void(const SessionResult& so_far, int item, int items)>;

/// Packs a sequence. Agents that re-arrange or know the sequence (manual, offline) make their plan first, and its boxes
/// are brought in its order. Throws InputError for an unknown sequence, agent, or a scenario that cannot be packed, and
/// what the plant throws, and for a point that is of another sequence or plant; whatever is planned ahead then has
/// ended.
[[nodiscard]] SessionResult pack(const model::Scenario& scenario, const std::string& sequence,
                                 const SessionOptions& options, plant::Plant& plant, const Progress& progress = {});

}  // namespace snug::session
