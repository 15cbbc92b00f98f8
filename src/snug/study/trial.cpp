// Trial: a session and the plant it packs, put together, and scored by what is true of the plant.
#include "snug/study/witness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "snug/plant/sent_program.hpp"
#include "snug/study/recorded_plant.hpp"

namespace snug::study {

std::vector<std::string> counted_boxes(const std::vector<cell::BoxResult>& boxes,
                                       const session::SessionResult& session) {
  std::vector<std::string> counted;
  for (const cell::BoxResult& box : boxes) {
    const bool is_rejected = std::ranges::any_of(session.items, [&](const session::ItemReport& item) {
      return item.id == box.id && item.end == session::ItemEnd::Rejected;
    });
    if (box.state == cell::BoxState::Packed && !is_rejected) counted.push_back(box.id);
  }
  return counted;
}

namespace {

bool was_taken_out(const cell::BoxResult& box, const session::SessionResult& session) {
  return std::ranges::any_of(session.items, [&](const session::ItemReport& item) {
    return item.id == box.id && item.end == session::ItemEnd::TakenOut;
  });
}

class Scorer {
 public:
  Scorer(const model::Scenario& scenario, const settings::PlaceLimits& limits, const Witness& witness)
      : scenario_(scenario),
        container_(*model::find_container(scenario, scenario.target)),
        limits_(limits),
        witness_(witness),
        before_(witness.poses()) {}

  void add(const session::ItemReport& report, Trial& trial) {
    TrueItem item;
    item.id = report.id;
    item.was_sent = !report.sends.empty();
    if (witness_.motion && item.was_sent) item.motion = witness_.motion();
    const TruePoses now = witness_.poses();
    if (item.was_sent) judge(report, now, item);
    for (std::size_t i = 0; i < report.sends.size(); ++i) {
      const bool is_last = i + 1 == report.sends.size();
      item.succeeded.push_back(is_last && item.is_as_planned && report.sends[i].trouble == session::Trouble::None);
    }
    before_ = now;
    trial.items.push_back(std::move(item));
  }

  void count(Trial& trial) const {
    trial.boxes = witness_.boxes();
    trial.executed_boxes = trial.boxes_lost = trial.items_sent = trial.items_as_planned = 0;
    const std::vector<std::string> packed = counted_boxes(trial.boxes, trial.session);
    for (const cell::BoxResult& box : trial.boxes) {
      const bool is_where_it_should = box.state == cell::BoxState::Packed || box.state == cell::BoxState::Waiting;
      if (!is_where_it_should && !was_taken_out(box, trial.session)) ++trial.boxes_lost;
    }
    trial.executed_boxes = static_cast<int>(packed.size());
    trial.executed_percent = model::compute_filling_degree_percent(scenario_, container_, packed);
    for (const TrueItem& item : trial.items) {
      trial.items_sent += item.was_sent ? 1 : 0;
      trial.items_as_planned += item.is_as_planned ? 1 : 0;
    }
    trial.recoveries = session::recovery_count(trial.session);
    count_time(trial);
    if (witness_.hash) trial.state_hash = witness_.hash();
  }

 private:
  static void count_time(Trial& trial) {
    const double duration = trial.session.duration;
    trial.boxes_per_hour = duration > 0.0 ? 3600.0 * trial.executed_boxes / duration : 0.0;
    double waited = 0.0;
    for (const session::ItemReport& item : trial.session.items) waited += item.planning_wait;
    trial.boxes_per_hour_with_planning = duration > 0.0 ? 3600.0 * trial.executed_boxes / (duration + waited) : 0.0;
    double seconds = 0.0;
    int count = 0;
    for (const session::ItemReport& item : trial.session.items) {
      const bool is_plain = item.end == session::ItemEnd::Placed && item.sends.size() == 1 && item.recoveries.empty();
      if (!is_plain || item.reorientation != skills::Reorientation::None) continue;
      seconds += item.seconds.total();
      ++count;
    }
    trial.unturned_cycle = count > 0 ? seconds / count : 0.0;
  }

  [[nodiscard]] bool is_in(std::size_t i, const Pose& X_WP) const {
    return cell::fit_in(container_.inner_size, witness_.size_of(i), in_container(X_WP)).is_in;
  }

  [[nodiscard]] Pose in_container(const Pose& X_WP) const { return container_.X_WT.inverse() * X_WP; }
  [[nodiscard]] double off_place(const Pose& X_TP, const packing::Placement& planned) const {
    return (X_TP.p - planned.X_TP.p).head<2>().norm();
  }

  void judge(const session::ItemReport& report, const TruePoses& now, TrueItem& item) const {
    const auto own = static_cast<std::size_t>(std::ranges::find(witness_.items, report.id) - witness_.items.begin());
    bool others_stay = true;
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (i == own || !before_[i] || !is_in(i, *before_[i])) continue;
      others_stay = others_stay && now[i] && is_in(i, *now[i]);
      if (!now[i]) continue;
      const auto moved = std::ranges::find(report.made_room.rbegin(), report.made_room.rend(), witness_.items[i],
                                           &packing::Placement::item);
      if (moved != report.made_room.rend())
        item.displacement = std::max(item.displacement, off_place(in_container(*now[i]), *moved));
      else
        item.displacement = std::max(item.displacement, (now[i]->p - before_[i]->p).norm());
    }
    if (!now[own]) return;
    const Pose X_TP = in_container(*now[own]);
    const packing::Placement& planned = report.sends.back().planned;
    item.position_error = off_place(X_TP, planned);
    item.angle_error = angle_between(X_TP.R, planned.X_TP.R);
    item.is_as_planned = is_in(own, *now[own]) && item.position_error <= limits_.position &&
                         item.angle_error <= limits_.tilt && others_stay && item.displacement <= limits_.displacement;
  }

  const model::Scenario& scenario_;
  const model::Container& container_;
  settings::PlaceLimits limits_;
  const Witness& witness_;
  TruePoses before_;
};

}  // namespace

Witness truth_of(const simulated_plant::SimulatedPlant& plant) {
  Witness truth;
  for (const model::Item& item : plant.simulation().sequence().items) truth.items.push_back(item.parcel);
  truth.poses = [&plant] {
    TruePoses poses;
    const cell::CellWorld& world = plant.simulation().world();
    for (const physics::BodyId body : world.parcels) {
      const bool is_there = plant.state().world.bodies[static_cast<std::size_t>(body.index)].is_present;
      poses.push_back(is_there ? std::optional<Pose>(physics::pose_of(world.model, plant.state().world, body))
                               : std::nullopt);
    }
    return poses;
  };
  truth.size_of = [&plant](std::size_t item) {
    const model::Scenario& drawn = plant.simulation().scenario();
    const std::string& id = plant.simulation().sequence().items[item].parcel;
    return model::collision_size(drawn, *model::find_parcel(drawn, id));
  };
  truth.boxes = [&plant] { return plant.boxes(); };
  truth.hash = [&plant] { return plant.simulation().hash(plant.state()); };
  truth.motion = [&plant] { return plant.motion_truth(); };
  return truth;
}

Trial run_trial(const model::Scenario& scenario, const std::string& sequence, const session::SessionOptions& session,
                plant::Plant& plant, const Witness& witness, const TrialProgress& progress) {
  Trial trial;
  trial.seed = session.decision.seed;
  Scorer scorer(scenario, scenario.place_limits, witness);
  const auto after_item = [&](const session::SessionResult& so_far, int item, int items) {
    trial.session = so_far;
    scorer.add(so_far.items.back(), trial);
    scorer.count(trial);
    if (progress) progress(trial, item, items);
  };
  trial.session = session::pack(scenario, sequence, session, plant, after_item);
  scorer.count(trial);
  return trial;
}

namespace {

/// What the session has to say goes into the recording when an item is done. `Recording`: of a simulated plant, or a
/// RecordedPlant.
template <class Recording>
class RecordedSession {
 public:
  explicit RecordedSession(Recording& recording) : recording_(recording) {}

  void note(const session::SessionResult& so_far) {
    for (const record::Event& event : events_of(so_far)) {
      if (std::ranges::find(noted_, event) != noted_.end()) continue;
      noted_.push_back(event);
      recording_.note(event);
    }
  }
  /// `more`: what else the recording's end asks for.
  void close(const Trial& trial, const TrialFiles& files, auto... more) {
    const session::SessionResult& result = trial.session;
    if (result.program.waypoints.empty()) return;  // no file
    note(result);
    const bool is_interrupted = result.stop_reason == session::StopReason::Interrupted;
    (void)recording_.close({warnings_of(result), result.stopped, is_interrupted, files.describe}, std::move(more)...);
  }

 private:
  Recording& recording_;
  std::vector<record::Event> noted_;
};

}  // namespace

Trial run_trial(const model::Scenario& scenario, const std::string& sequence, const session::SessionOptions& session,
                const simulated_plant::SimulatedPlantOptions& options, const TrialProgress& progress,
                const TrialFiles& files) {
  simulated_plant::SimulatedPlant plant(scenario, sequence, options);
  std::optional<simulated_plant::LiveRecording> recording;
  std::optional<RecordedSession<simulated_plant::LiveRecording>> recorded;
  if (files.recording) recorded.emplace(recording.emplace(plant, scenario, *files.recording));
  std::optional<plant::SentProgram> sent;
  if (files.program != nullptr)
    sent.emplace(plant, *files.program, session.simulation.tracking, session.simulation.robot);
  const auto after_item = [&](const Trial& so_far, int item, int items) {
    if (recorded) recorded->note(so_far.session);
    if (progress) progress(so_far, item, items);
  };
  plant::Plant& packed = sent ? static_cast<plant::Plant&>(*sent) : plant;
  Trial trial = run_trial(scenario, sequence, session, packed, truth_of(plant), after_item);
  if (sent) sent->finish();
  if (recorded) recorded->close(trial, files);
  trial.plant_seed = options.seed;
  trial.plant = options;
  trial.objects = plant.objects();
  return trial;
}

Trial run_trial(const model::Scenario& scenario, const std::string& sequence, const session::SessionOptions& session,
                plant::Plant& plant, const Witness& witness, const TrialProgress& progress, const TrialFiles& files) {
  std::optional<RecordedPlant> recording;
  std::optional<RecordedSession<RecordedPlant>> recorded;
  if (files.recording)
    recorded.emplace(recording.emplace(plant, scenario, sequence, session.simulation, *files.recording));
  plant::Plant& seen = recording ? static_cast<plant::Plant&>(*recording) : plant;
  std::optional<plant::SentProgram> sent;
  if (files.program != nullptr)
    sent.emplace(seen, *files.program, session.simulation.tracking, session.simulation.robot);
  plant::Plant& packed = sent ? static_cast<plant::Plant&>(*sent) : seen;
  const auto after_item = [&](const Trial& so_far, int item, int items) {
    if (recorded) recorded->note(so_far.session);
    if (progress) progress(so_far, item, items);
  };
  Trial trial = run_trial(scenario, sequence, session, packed, witness, after_item);
  if (sent) sent->finish();
  if (recorded) recorded->close(trial, files, trial.boxes);
  return trial;
}

std::vector<record::Event> events_of(const session::SessionResult& result) {
  std::vector<record::Event> events;
  for (const session::ItemReport& item : result.items) {
    if (item.sends.empty() && !item.is_packed()) {
      events.push_back({item.done, "refused", item.id, session::describe(item), {}});
    }
    if (!item.made_room.empty()) events.push_back({item.begin, "room", item.id, session::describe_room(item), {}});
    for (const session::Send& send : item.sends) {
      const Vector3 p = 1e3 * send.planned.X_TP.p;
      events.push_back({send.time,
                        "send",
                        item.id,
                        fmt::format("planned at ({:.0f}, {:.0f}, {:.0f}) mm, success expected {:.0f} %", p.x(), p.y(),
                                    p.z(), 100.0 * send.predicted_success),
                        {{"predicted_success", send.predicted_success}}});
    }
    for (const session::OperatorStep& step : item.operator_steps) {
      events.push_back({step.time, "operator", item.id, session::describe(step), {}});
    }
    for (const session::Recovery& recovery : item.recoveries) {
      std::string text = fmt::format("{}: {}", session::name_of(recovery.trouble), session::name_of(recovery.remedy));
      if (!recovery.detail.empty()) text += " (" + recovery.detail + ")";
      events.push_back({recovery.time, "recovery", item.id, std::move(text), {}});
    }
  }
  for (const session::ObstacleReport& one : result.obstacles) {
    events.push_back({one.seen,
                      "obstacle",
                      fmt::format("obstacle {}", one.number),
                      session::describe(one),
                      {{"height", one.high_T.z()}}});
    if (one.gone) events.push_back({*one.gone, "obstacle", fmt::format("obstacle {}", one.number), "it is gone", {}});
  }
  std::ranges::stable_sort(events, {}, &record::Event::time);
  return events;
}

std::vector<std::string> warnings_of(const session::SessionResult& result) {
  std::vector<std::string> warnings;
  if (result.failure) warnings.push_back(result.failure.text);
  for (const session::ItemReport& item : result.items) {
    if (!item.sends.empty() && !item.is_packed()) warnings.push_back(item.id + " " + session::describe(item));
  }
  return warnings;
}

simulated_plant::LiveRecordingOptions recording_of(const simulated_plant::SimulatedPlantOptions& plant,
                                                   const std::string& agent, const std::string& version,
                                                   OutputFile& file, const std::string& address) {
  const std::string& robot = plant.simulation.robot;
  simulated_plant::LiveRecordingOptions recording;
  recording.file = &file;
  recording.version = version;
  nlohmann::ordered_json settings{{"cup", "phases"},
                                  {"controller", motion::name_of(plant.simulation.tracking)},
                                  {"corrections", "none"},
                                  {"robot", robot.empty() ? "none" : robot}};
  if (address.empty())
    settings["plant_seed"] = plant.seed;
  else
    settings["plant"] = address;
  settings["agent"] = agent;
  recording.settings_json = settings.dump();
  return recording;
}

simulated_plant::TakenUp take_up(const session::ResumePoint& point) {
  simulated_plant::TakenUp begin{point.time, point.item_count(), {}};
  for (const session::event::Standing& box : point.boxes) {
    const std::vector<model::ParcelId>& items = point.started().items;
    begin.boxes.emplace_back(items[box.item.slot()], box.X_WP);
  }
  return begin;
}

}  // namespace snug::study
