// JsonForm of what events of a session are made of.
#pragma once

#include "snug/planning/json_forms.hpp"
#include "snug/session/event.hpp"

namespace snug {

/// A line of a program file (docs/formats.md): periods of swings in hundredths of a second.
template <>
struct JsonForm<motion::Waypoint> {
  [[nodiscard]] static JsonValue write(const motion::Waypoint& one);
  [[nodiscard]] static motion::Waypoint read(const JsonValue& value, const JsonReader& reader);
};

template <>
struct JsonForm<plant::End> {
  [[nodiscard]] static JsonValue write(const plant::End& one);
  [[nodiscard]] static plant::End read(const JsonValue& value, const JsonReader& reader);
};

template <>
struct JsonForm<session::ItemSeconds> {
  [[nodiscard]] static JsonValue write(const session::ItemSeconds& one);
  [[nodiscard]] static session::ItemSeconds read(const JsonValue& value, const JsonReader& reader);
};

template <>
struct JsonForm<planning::AttemptForces> {
  [[nodiscard]] static JsonValue write(const planning::AttemptForces& one);
  [[nodiscard]] static planning::AttemptForces read(const JsonValue& value, const JsonReader& reader);
};

template <>
struct JsonForm<planning::Tried> {
  [[nodiscard]] static JsonValue write(const planning::Tried& one);
  [[nodiscard]] static planning::Tried read(const JsonValue& value, const JsonReader& reader);
};

template <>
struct JsonForm<session::ObstacleReport> {
  [[nodiscard]] static JsonValue write(const session::ObstacleReport& one);
  [[nodiscard]] static session::ObstacleReport read(const JsonValue& value, const JsonReader& reader);
};

/// Of an enum whose values follow one another from the first.
template <class T, T kLast>
[[nodiscard]] constexpr auto all_up_to() {
  std::array<T, static_cast<std::size_t>(kLast) + 1> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<T>(i);
  return all;
}

template <>
struct JsonEnum<session::State> {
  static constexpr auto all = all_up_to<session::State, session::State::Done>();
};
template <>
struct JsonEnum<session::Signal> {
  static constexpr auto all = all_up_to<session::Signal, session::Signal::NextOnAgenda>();
};
template <>
struct JsonEnum<session::Trouble> {
  static constexpr auto all = all_up_to<session::Trouble, session::Trouble::PlantFault>();
};
template <>
struct JsonEnum<session::Remedy> {
  static constexpr auto all = all_up_to<session::Remedy, session::Remedy::Stop>();
};
template <>
struct JsonEnum<session::ItemEnd> {
  static constexpr auto all = all_up_to<session::ItemEnd, session::ItemEnd::TakenOut>();
};
template <>
struct JsonEnum<session::StopReason> {
  static constexpr auto all = all_up_to<session::StopReason, session::StopReason::Interrupted>();
};
template <>
struct JsonEnum<session::SessionFailureKind> {
  static constexpr auto all = all_up_to<session::SessionFailureKind, session::SessionFailureKind::PlantLost>();
};
template <>
struct JsonEnum<perception::LookFault> {
  static constexpr auto all = all_up_to<perception::LookFault, perception::LookFault::NoFrame>();
};
template <>
struct JsonEnum<plant::EndReason> {
  static constexpr auto all = all_up_to<plant::EndReason, plant::EndReason::Fault>();
};
template <>
struct JsonEnum<planning::PlanOutcome> {
  static constexpr auto all = all_up_to<planning::PlanOutcome, planning::PlanOutcome::Infeasible>();
};
template <>
struct JsonEnum<planning::Verdict> {
  static constexpr auto all = all_up_to<planning::Verdict, planning::Verdict::SearchEnded>();
};

}  // namespace snug
