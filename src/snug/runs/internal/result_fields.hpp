// The keys of a result, once: archives write them, read them, or make types of them.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "snug/runs/result.hpp"

namespace snug::runs::internal {

/// A number that is written in other units: `per` times what is stored.
struct Scaled {
  double& value;
  double per;
};
/// Counted from 1 in files, from 0 here.
struct FromOne {
  int& value;
};
/// One letter.
struct Letter {
  char& value;
};
/// 16 hexadecimal digits.
struct Hash {
  std::uint64_t& value;
};
/// Two texts that are written as a list.
struct Pair {
  std::string &first, &second;
};
/// Written for readers' convenience; not read, others say the same.
struct Derived {
  double value;
};
/// Left out when it is empty.
struct IfAny {
  std::string& text;
};

inline constexpr double kMm = 1.0e3;  // per metre

constexpr auto all_of(cell::BoxState) {
  return std::array{cell::BoxState::Waiting, cell::BoxState::Held,    cell::BoxState::Packed,
                    cell::BoxState::Outside, cell::BoxState::Dropped, cell::BoxState::Lost};
}
constexpr auto all_of(cell::StopCause) {
  return std::array{cell::StopCause::JointTorque, cell::StopCause::JointSpeed,   cell::StopCause::JointRange,
                    cell::StopCause::SensorForce, cell::StopCause::SensorTorque, cell::StopCause::TrackingError,
                    cell::StopCause::Stuck};
}
constexpr auto all_of(cell::FailureKind) {
  return std::array{cell::FailureKind::None,        cell::FailureKind::TooManyPairs,   cell::FailureKind::NotFinite,
                    cell::FailureKind::LostBody,    cell::FailureKind::ProtectiveStop, cell::FailureKind::TooLong,
                    cell::FailureKind::ContactDepth};
}

constexpr const char* type_name(const record::Event&) { return "ResultEvent"; }
constexpr const char* type_name(const cell::BoxResult&) { return "BoxResult"; }
constexpr const char* type_name(const BodyResult&) { return "BodyResult"; }
constexpr const char* type_name(const cell::Repick&) { return "Repick"; }
constexpr const char* type_name(const cell::SolverSummary&) { return "SolverSummary"; }
constexpr const char* type_name(const ContactResult&) { return "ContactResult"; }
constexpr const char* type_name(const cell::LostBody&) { return "LostBody"; }
constexpr const char* type_name(const cell::ProtectiveStop&) { return "ProtectiveStop"; }
constexpr const char* type_name(const RunResult&) { return "RunResult"; }

template <class Archive>
void fields(Archive& a, record::Event& event) {
  a("time_s", event.time);
  a("kind", event.kind);
  a("body", event.body);
  a("text", event.text);
  a.others(event.numbers);
}

template <class Archive>
void fields(Archive& a, cell::BoxResult& box) {
  a("id", box.id);
  a("state", box.state);
  a("X_TP", box.X_TP);
  a("up", Letter{box.up});
  a("outside_mm", Scaled{box.outside, kMm});
  a("above_rim_mm", Scaled{box.above_rim, kMm});
  a("events", box.events);
}

template <class Archive>
void fields(Archive& a, BodyResult& body) {
  a("name", body.name);
  a("X_WB", body.X_WB);
  a("speed_m_s", body.speed);
}

template <class Archive>
void fields(Archive& a, cell::Repick& repick) {
  a("id", repick.id);
  a("offset_mm", Scaled{repick.offset, kMm});
  a("up_before", Letter{repick.up_before});
  a("up_after", Letter{repick.up_after});
  a("up_intended", Letter{repick.up_intended});
}

template <class Archive>
void fields(Archive& a, cell::SolverSummary& solver) {
  a("steps", solver.steps);
  a("not_converged", solver.not_converged);
  a("worst_residual_m_s", solver.worst_residual);
  a("worst_penetration_mm", Scaled{solver.worst_penetration, kMm});
  a("worst_compliant_penetration_mm", Scaled{solver.worst_compliant_depth, kMm});
  a("mean_sweeps", solver.mean_sweeps);
}

template <class Archive>
void fields(Archive& a, ContactResult& contact) {
  a("bodies", Pair{contact.body_a, contact.body_b});
  a("point_m", contact.p_WQ);
  a("normal", contact.n_AB_W);
  a("force_N", contact.force_B_W);
  a("gap_mm", Scaled{contact.phi, kMm});
  a("slides", contact.slides);
}

template <class Archive>
void fields(Archive& a, cell::LostBody& lost) {
  a("body", lost.name);
  a("time_s", lost.time);
  a("position_m", lost.p_W);
  a("velocity_m_s", lost.v_W);
}

template <class Archive>
void fields(Archive& a, cell::ProtectiveStop& stop) {
  a("what", stop.cause);
  a("where", stop.where);
  a("value", stop.value);
  a("limit", stop.limit);
  a("unit", stop.unit);
  a("time_s", stop.time);
  a("row", FromOne{stop.row});
  a("waypoint", stop.waypoint);
  a("touching", stop.touching);
  a("limited_by", stop.limited_by);
}

template <class Archive>
void fields(Archive& a, RunResult& result) {
  const RepickOffsets offsets = summarize(result.repicks);
  a("duration_s", result.duration);
  a("wall_s", result.wall);
  a("real_time_factor", result.real_time_factor);
  a("filling_degree_percent", result.filling_degree_percent);
  a("boxes", result.boxes);
  a("bodies", result.bodies);
  a("events", result.events);
  a("repick_offset_mean_mm", Derived{offsets.mean * kMm});
  a("repick_offset_worst_mm", Derived{offsets.worst * kMm});
  a("repicks", result.repicks);
  a("solver", result.solver);
  a("state_hash", Hash{result.state_hash});
  a("contacts", result.contacts);
  a("lost", result.lost);
  a("protective_stop", result.stop);
  a("interrupted", result.is_interrupted);
  a("ended_by", IfAny{result.ended_by});
  a("warnings", result.warnings);
  a("failure", result.failure.text);
  a("failure_kind", result.failure.kind);
}

}  // namespace snug::runs::internal
