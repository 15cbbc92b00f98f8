// Belief forms: what a belief file has, key by key; worlds as what differs from those drawn by the seed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/planning/belief_snapshot.hpp"
#include "snug/planning/json_forms.hpp"

namespace snug::planning::internal {

inline constexpr int kVersion = 1;

struct SequenceItem {
  model::Item item;
  template <class Archive>
  void fields(Archive& a) {
    int up = static_cast<int>(item.up);
    bool has_heavy_side = item.heavy_side.has_value();
    int heavy_side = has_heavy_side ? static_cast<int>(*item.heavy_side) : 0;
    a("parcel", item.parcel);
    a("up", up);
    a("up_sign", item.up_sign);
    a("yaw", item.yaw);
    a("has_heavy_side", has_heavy_side);
    a("heavy_side", heavy_side);
    a("shift_A", item.shift_A);
    a("turn", item.turn);
    item.up = static_cast<model::UpAxis>(up);
    if (has_heavy_side) item.heavy_side = static_cast<model::HeavySide>(heavy_side);
  }
};

/// The scenario by its text, and the sequence: orders that were drawn are not in the text.
struct ScenarioForm {
  std::string name, source, text, sequence;
  std::vector<SequenceItem> items;
  std::optional<double> task_stiffness;
  template <class Archive>
  void fields(Archive& a) {
    a("name", name);
    a("source", source);
    a("text", text);
    a("sequence", sequence);
    a("items", items);
    a("task_stiffness", task_stiffness);
  }
};

struct SimulationForm {
  motion::Tracking tracking;
  std::string cup, robot;
  template <class Archive>
  void fields(Archive& a) {
    a("tracking", tracking);
    a("cup", cup);
    a("robot", robot);
  }
};

struct AgentForm {
  AgentSettings settings;
  std::vector<std::string> kinds;  ///< parcels
  template <class Archive>
  void fields(Archive& a) {
    a("name", settings.name);
    a("is_asked", settings.is_asked);
    a("seed", settings.seed);
    a("tries_places", settings.tries_places);
    a("future_kinds", kinds);
    a("future_weights", settings.future.weights);
    a("future_comes_once", settings.future.comes_once);
  }
};

struct BoxForm {
  Pose X_WP;
  Matrix6 covariance = Matrix6::Zero();
  bool was_seen = false;
  template <class Archive>
  void fields(Archive& a) {
    a("X_WP", X_WP);
    a("covariance", covariance);
    a("was_seen", was_seen);
  }
};

struct ItemForm {
  std::string id;
  Vector3 size = Vector3::Zero();
  packing::Orientation arrival;
  std::optional<packing::Placement> chosen;
  std::optional<BoxForm> box;
  template <class Archive>
  void fields(Archive& a) {
    a("id", id);
    a("size", size);
    a("arrival", arrival);
    a("chosen", chosen);
    a("box", box);
  }
};

struct SizeForm {
  std::string parcel;
  Vector3 size = Vector3::Zero();
  template <class Archive>
  void fields(Archive& a) {
    a("parcel", parcel);
    a("size", size);
  }
};

/// What differs from the world as it was drawn.
struct WorldForm {
  double weight = 1.0;
  std::vector<std::optional<Pose>> X_WP;
  std::vector<SizeForm> sizes;
  template <class Archive>
  void fields(Archive& a) {
    a("weight", weight);
    a("X_WP", X_WP);
    a("sizes", sizes);
  }
};

struct RobotForm {
  RobotState state;
  template <class Archive>
  void fields(Archive& a) {
    a("X_WE", state.X_WE);
    a("q", state.q);
    a("io", state.io);
  }
};

struct FailedForm {
  FailedMotion motion;
  template <class Archive>
  void fields(Archive& a) {
    a("item", motion.item);
    a("planned", motion.planned);
    a("skill", motion.skill);
    a("reorientation", motion.reorientation);
    a("while_turning", motion.while_turning);
  }
};

struct BeliefForm {
  ScenarioForm scenario;
  std::uint64_t seed = 1;
  SimulationForm simulation;
  AgentForm agent;
  bool has_chosen = false;
  std::vector<ItemForm> items;
  std::vector<WorldForm> worlds;
  int stiffenings = 0;
  std::vector<geometry::Aabb> obstacles, obstacle_bodies;
  std::vector<model::ItemIndex> sent, skipped;
  std::vector<FailedForm> failed;
  int skips_left = 0;
  std::optional<model::ItemIndex> next;
  RobotForm robot;
  template <class Archive>
  void fields(Archive& a) {
    a("scenario", scenario);
    a("seed", seed);
    a("simulation", simulation);
    a("agent", agent);
    a("places_are_chosen", has_chosen);
    a("items", items);
    a("worlds", worlds);
    a("stiffenings", stiffenings);
    a("obstacles", obstacles);
    a("obstacle_bodies", obstacle_bodies);
    a("sent", sent);
    a("failed", failed);
    a("skipped", skipped);
    a("skips_left", skips_left);
    a("next", next);
    a("robot", robot);
  }
};

struct RequestForm {
  int version = kVersion;
  std::string id;
  model::ItemIndex item;
  double decision_time = 0.0;
  std::string hash;
  BeliefForm belief;
  template <class Archive>
  void fields(Archive& a) {
    a("snug_belief", version);
    a("item_id", id);
    a("item", item);
    a("decision_time", decision_time);
    a("hash", hash);
    a("belief", belief);
  }
};

}  // namespace snug::planning::internal
