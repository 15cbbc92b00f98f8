// ItemEventLog: what became of every box: picked, flipped, re-picked, placed, lost; the answer of a run.
#include "snug/cell/item_event_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "snug/cell/aligner_feed.hpp"

namespace snug::cell {
namespace {

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

int item_of(const CellWorld& world, int body) {
  for (std::size_t i = 0; i < world.parcels.size(); ++i) {
    if (world.parcels[i].index == body) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace

const char* name_of(BoxState state) {
  switch (state) {
    case BoxState::Waiting:
      return "waiting";
    case BoxState::Held:
      return "held";
    case BoxState::Packed:
      return "packed";
    case BoxState::Outside:
      return "outside";
    case BoxState::Dropped:
      return "dropped";
    case BoxState::Lost:
      return "lost";
  }
  return "";
}

ContainerFit fit_in(const Vector3& inner_size, const Vector3& box_size, const Pose& X_TP) {
  const Vector3 reach = 0.5 * (X_TP.R.cwiseAbs() * box_size);
  const Vector3 beyond = X_TP.p.cwiseAbs() + reach - 0.5 * inner_size;
  ContainerFit fit;
  fit.outside = std::max({0.0, beyond.x(), beyond.y()});
  fit.above_rim = std::max(0.0, X_TP.p.z() + reach.z() - inner_size.z());
  fit.is_in = fit.outside <= kPackedBeyondWall && fit.above_rim <= kPackedAboveRim && X_TP.p.z() > 0.0;
  return fit;
}

ItemEventLog::ItemEventLog(const model::Scenario& scenario, const model::Sequence& sequence)
    : items_(sequence.items.size()) {
  for (const model::Item& item : sequence.items) {
    ids_.push_back(item.parcel);
    sizes_.push_back(model::collision_size(scenario, *model::find_parcel(scenario, item.parcel)));
  }
  if (const model::Container* container = model::find_container(scenario, scenario.target)) {
    X_WT_ = container->X_WT;
    inner_size_ = container->inner_size;
  }
}

void ItemEventLog::log(double time, std::string kind, int item, std::string text,
                       std::vector<record::EventNumber> numbers) {
  events_.push_back({time, std::move(kind), item >= 0 ? ids_[static_cast<std::size_t>(item)] : std::string(),
                     std::move(text), std::move(numbers)});
}

void ItemEventLog::box_appeared(int item, double time) {
  items_[static_cast<std::size_t>(item)].has_appeared = true;
  log(time, "appear", item, "stands at the aligner");
}

void ItemEventLog::box_was_placed(int item) {
  Item& one = items_[static_cast<std::size_t>(item)];
  one.has_appeared = one.was_held = one.over_container = true;
}

void ItemEventLog::box_removed(int item, double time) {
  items_[static_cast<std::size_t>(item)].was_removed = true;
  log(time, "removed", item, "taken away from the aligner to make room for the next box");
}

void ItemEventLog::body_lost(record::Event event) {
  for (std::size_t i = 0; i < ids_.size(); ++i) items_[i].was_lost |= ids_[i] == event.body;
  note(std::move(event));
}

void ItemEventLog::add_seal(int item, const GripperEvent& event, double time, const Matrix3& R_WP, const Matrix3& R_WE,
                            const std::string& waypoint) {
  Item& box = items_[static_cast<std::size_t>(item)];
  const int up = vertical_axis(R_WP);
  const double offset = event.offset_P.norm();
  const std::vector<record::EventNumber> numbers{{"offset_x_mm", 1e3 * (R_WP * event.offset_P).x()},
                                                 {"offset_y_mm", 1e3 * (R_WP * event.offset_P).y()},
                                                 {"length_mm", 1e3 * event.length},
                                                 {"tilt_deg", degrees(event.angle)}};
  if (box.seals > 0 && up != box.up_at_seal) {
    log(time, "flip", item,
        fmt::format("now {} up, was {} up{}", axis_letter(up), axis_letter(box.up_at_seal),
                    up == box.up_intended ? "" : ", not as intended"));
  }
  const bool is_repick = box.was_set_down;
  log(time,
      is_repick       ? "repick"
      : box.seals > 0 ? "reseal"
                      : "seal",
      item, fmt::format("{}: sealed {:.1f} mm from the middle of the face", waypoint, 1e3 * offset), numbers);
  if (is_repick) {
    repicks_.push_back({ids_[static_cast<std::size_t>(item)], offset, axis_letter(box.up_at_seal), axis_letter(up),
                        axis_letter(box.up_intended)});
  }
  ++box.seals;
  box.was_held = true;
  box.was_set_down = false;
  box.up_at_seal = up;
  box.R_EP = R_WE.transpose() * R_WP;
}

void ItemEventLog::add_release(int item, const GripperEvent& event, double time, const Pose& X_WE, const Pose& X_WP) {
  Item& box = items_[static_cast<std::size_t>(item)];
  box.up_intended = vertical_axis(X_WE.R * box.R_EP);
  const Vector3 p_TP = X_WT_.inverse() * X_WP.p;
  box.over_container = std::abs(p_TP.x()) < 0.5 * inner_size_.x() && std::abs(p_TP.y()) < 0.5 * inner_size_.y();
  if (event.kind == GripperEvent::Kind::HoldLost) {
    log(time, "lost", item, cup::describe(event.loss), {{"bend_deg", degrees(event.angle)}});
  } else {
    box.was_set_down = true;
    log(time, "release", item, box.over_container ? "over the container" : "outside the container");
  }
}

void ItemEventLog::add(const GripperEvent& event, double time, const CellWorld& world, const physics::WorldState& state,
                       const Pose& X_WE, const std::string& waypoint) {
  const int item = event.body >= 0 ? item_of(world, event.body) : -1;
  switch (event.kind) {
    case GripperEvent::Kind::NoSeal:
      log(time, "no seal", item, fmt::format("{}: {}", waypoint, cup::describe(event.no_seal.reason)),
          {{"gap_mm", 1e3 * event.no_seal.gap},
           {"tilt_deg", degrees(event.no_seal.tilt)},
           {"overhang_mm", 1e3 * event.no_seal.overhang}});
      return;
    case GripperEvent::Kind::BendWarning:
      log(time, "bend", item, "cup bent beyond the range of its law", {{"bend_deg", degrees(event.angle)}});
      return;
    case GripperEvent::Kind::CupsHold:
      log(time, "cups", item, fmt::format("{} of {} cups hold it: {}", event.holding, event.of, event.cups),
          {{"holding", static_cast<double>(event.holding)}});
      return;
    case GripperEvent::Kind::CupLost:
      log(time, "cup lost", item,
          fmt::format("cup {} {}; {} hold it still", event.cups, cup::describe(event.loss), event.holding),
          {{"holding", static_cast<double>(event.holding)}});
      return;
    case GripperEvent::Kind::TwoBoxes:
      log(time, "two boxes", item, fmt::format("cups {} hold this box beside another", event.cups));
      return;
    case GripperEvent::Kind::Seal: {
      const Pose X_WP = physics::pose_of(world.model, state, physics::BodyId{event.body});
      add_seal(item, event, time, X_WP.R, X_WE.R, waypoint);
      return;
    }
    case GripperEvent::Kind::HoldLost:
    case GripperEvent::Kind::Released:
      add_release(item, event, time, X_WE, physics::pose_of(world.model, state, physics::BodyId{event.body}));
      return;
  }
}

std::vector<BoxResult> ItemEventLog::results(const CellWorld& world, const physics::WorldState& state,
                                             int held_body) const {
  std::vector<BoxResult> results;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const Item& item = items_[i];
    if (!item.has_appeared) continue;
    BoxResult result;
    result.id = ids_[i];
    const physics::BodyId body = world.parcels[i];
    const Pose X_WP = physics::pose_of(world.model, state, body);
    result.X_TP = X_WT_.inverse() * X_WP;
    result.up = axis_letter(vertical_axis(X_WP.R));
    const ContainerFit fit = fit_in(inner_size_, sizes_[i], result.X_TP);
    result.outside = fit.outside;
    result.above_rim = fit.above_rim;
    if (item.was_lost) {
      result.state = BoxState::Lost;
    } else if (body.index == held_body) {
      result.state = BoxState::Held;
    } else if (!item.was_held || item.was_removed) {
      result.state = BoxState::Waiting;
    } else if (fit.is_in) {
      result.state = BoxState::Packed;
    } else {
      result.state = item.over_container ? BoxState::Outside : BoxState::Dropped;
    }
    for (const record::Event& event : events_) {
      if (event.body == result.id) result.events.push_back(event);
    }
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace snug::cell
