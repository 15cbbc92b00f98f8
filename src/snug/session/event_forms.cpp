// JsonForm of what events of a session are made of.
#include "snug/session/internal/event_forms.hpp"
#include "snug/motion/program_csv.hpp"

namespace snug {
namespace {

struct EndFields {
  plant::End one;
  template <class Archive>
  void fields(Archive& a) {
    a("reason", one.reason);
    std::optional<int> waypoint = one.waypoint ? std::optional(one.waypoint->value) : std::nullopt;
    a("waypoint", waypoint);
    one.waypoint = waypoint ? std::optional(motion::WaypointIndex(*waypoint)) : std::nullopt;
    a("value", one.value);
    a("limit", one.limit);
    a("where", one.where);
  }
};

struct SecondsFields {
  session::ItemSeconds one;
  template <class Archive>
  void fields(Archive& a) {
    a("travel", one.travel);
    a("carry", one.carry);
    a("regrasp", one.regrasp);
    a("insert", one.insert);
    a("push", one.push);
    a("wait", one.wait);
  }
};

struct ForcesFields {
  planning::AttemptForces one;
  template <class Archive>
  void fields(Archive& a) {
    a("force", one.force);
    a("torque", one.torque);
    a("displacement", one.displacement);
  }
};

struct TriedFields {
  planning::Tried one;
  template <class Archive>
  void fields(Archive& a) {
    a("planned", one.planned);
    a("expected_percent", one.expected_percent);
    a("cost", one.cost);
    a("utility", one.utility);
    a("verdict", one.verdict);
    a("skill", one.skill);
    a("failure", one.failure);
    a("succeeded", one.succeeded);
    a("samples", one.samples);
    a("success_rate", one.success_rate);
    a("reason", one.reason);
  }
};

struct ObstacleFields {
  session::ObstacleReport one;
  template <class Archive>
  void fields(Archive& a) {
    a("number", one.number);
    a("seen", one.seen);
    a("gone", one.gone);
    a("low_T", one.low_T);
    a("high_T", one.high_T);
  }
};

}  // namespace

JsonValue JsonForm<motion::Waypoint>::write(const motion::Waypoint& one) {
  std::string line = motion::format_program({"", {one}});
  if (line.ends_with('\n')) line.pop_back();
  return {std::move(line)};
}

motion::Waypoint JsonForm<motion::Waypoint>::read(const JsonValue& /*value*/, const JsonReader& reader) {
  motion::Program program = motion::parse_program(reader.as<std::string>(), "waypoint");
  if (program.waypoints.size() != 1) reader.fail("one waypoint");
  program.waypoints[0].line = 0;
  return program.waypoints[0];
}

JsonValue JsonForm<plant::End>::write(const plant::End& one) { return write_json(EndFields{one}); }
plant::End JsonForm<plant::End>::read(const JsonValue& /*value*/, const JsonReader& reader) {
  return reader.as<EndFields>().one;
}

JsonValue JsonForm<session::ItemSeconds>::write(const session::ItemSeconds& one) {
  return write_json(SecondsFields{one});
}
session::ItemSeconds JsonForm<session::ItemSeconds>::read(const JsonValue& /*value*/, const JsonReader& reader) {
  return reader.as<SecondsFields>().one;
}

JsonValue JsonForm<planning::AttemptForces>::write(const planning::AttemptForces& one) {
  return write_json(ForcesFields{one});
}
planning::AttemptForces JsonForm<planning::AttemptForces>::read(const JsonValue& /*value*/, const JsonReader& reader) {
  return reader.as<ForcesFields>().one;
}

JsonValue JsonForm<planning::Tried>::write(const planning::Tried& one) { return write_json(TriedFields{one}); }
planning::Tried JsonForm<planning::Tried>::read(const JsonValue& /*value*/, const JsonReader& reader) {
  return reader.as<TriedFields>().one;
}

JsonValue JsonForm<session::ObstacleReport>::write(const session::ObstacleReport& one) {
  return write_json(ObstacleFields{one});
}
session::ObstacleReport JsonForm<session::ObstacleReport>::read(const JsonValue& /*value*/, const JsonReader& reader) {
  return reader.as<ObstacleFields>().one;
}

}  // namespace snug
