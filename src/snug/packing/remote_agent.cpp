// Remote agent: states and items as JSON, answers back into candidates.
#include "snug/packing/remote_agent.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "snug/core/check.hpp"
#include "snug/packing/place_finder.hpp"

namespace snug::packing {
namespace {

using Json = nlohmann::ordered_json;
constexpr int kMostCandidates = 200;

Json as_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json as_json(const Orientation& orientation) {
  return {{"up", std::string(1, "XYZ"[static_cast<int>(orientation.up)])},
          {"up_sign", orientation.up_sign},
          {"yaw_quarter", orientation.yaw_quarter}};
}

Json as_json(const Item& item) {
  Json json{{"id", item.id},
            {"type", item.type},
            {"size", as_json(item.size)},
            {"mass", item.mass},
            {"com", as_json(item.com)},
            {"arrival", as_json(item.arrival)},
            {"upright_only", item.upright_only},
            {"no_stack", item.no_stack}};
  json["max_load"] = item.max_load ? Json(*item.max_load) : Json();
  return json;
}

Json as_json(const PlacedBox& box) {
  const Extent extent = bounding_extent(box);
  const Quaternion q(box.X_TP.R);
  Json json = as_json(box.item);
  json["position"] = as_json(box.X_TP.p);
  json["quaternion_wxyz"] = {q.w(), q.x(), q.y(), q.z()};
  json["low"] = as_json(extent.low);
  json["high"] = as_json(extent.high);
  return json;
}

Json as_json(const Place& place, int index) {
  Json json{{"index", index}};
  json.update(as_json(place.orientation));
  json["flips"] = place.flips;
  json["low"] = as_json(place.low_T);
  json["extents"] = as_json(place.extents);
  json["support"] = place.support;
  return json;
}

Candidate as_candidate(const Item& item, const Place& place, double score) {
  Candidate candidate;
  candidate.placement = {item.id, pose_at(place), place.orientation, place.flips};
  candidate.score = score;
  candidate.support = place.support;
  return candidate;
}

Orientation parse_orientation(const Json& json) {
  Orientation orientation;
  const std::string up = json.value("up", std::string("Z"));
  const std::size_t axis = std::string("XYZ").find(up);
  if (up.size() != 1 || axis == std::string::npos) throw AgentError("'up' is '" + up + "', not X, Y or Z");
  orientation.up = static_cast<model::UpAxis>(axis);
  orientation.up_sign = json.value("up_sign", 1);
  orientation.yaw_quarter = json.value("yaw_quarter", 0);
  if (std::abs(orientation.up_sign) != 1) throw AgentError("'up_sign' is neither 1 nor -1");
  if (orientation.yaw_quarter < 0 || orientation.yaw_quarter > 3) throw AgentError("'yaw_quarter' is not 0 .. 3");
  return orientation;
}

class RemoteAgent final : public Agent {
 public:
  RemoteAgent(std::string_view name, AgentInput input) : name_(name), input_(std::move(input)) {
    SNUG_CHECK(input_.ask != nullptr, "a remote agent has somebody to ask");
  }
  [[nodiscard]] std::string_view name() const override { return name_; }

  Expected<Decision, NoPlace> decide(const ContainerState& state, const Item& item) override {
    if (!has_begun_) begin(state);
    PackingSettings rules = input_.settings;
    rules.planned_interference = state.has_walls ? rules.planned_interference : 0.0;
    PlaceFinder finder(state, rules);
    std::vector<Place> places;
    if (auto found = finder.find(item, kMostCandidates)) {
      places = std::move(*found);
    } else if (is_infeasible(found.error())) {
      return tl::unexpected(found.error());
    }
    Json question{{"ask", "decide"}, {"item", as_json(item)}, {"boxes", Json::array()}, {"candidates", Json::array()}};
    for (const PlacedBox& box : state.boxes) question["boxes"].push_back(as_json(box));
    for (const Extent& one : state.obstacles) {
      question["obstacles"].push_back({{"low", as_json(one.low)}, {"high", as_json(one.high)}});
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      question["candidates"].push_back(as_json(places[i], static_cast<int>(i)));
    }
    return read(ask(question), item, places, finder);
  }

 private:
  void begin(const ContainerState& state) {
    has_begun_ = true;
    const PackingSettings& s = input_.settings;
    Json future = Json::array();
    for (std::size_t i = 0; i < input_.future.kinds.size(); ++i) {
      Json kind = as_json(input_.future.kinds[i]);
      kind["weight"] = input_.future.weights[i];
      future.push_back(std::move(kind));
    }
    (void)ask({{"ask", "begin"},
               {"settings",
                {{"seed", input_.run.seed},
                 {"decision_time", input_.run.time},
                 {"max_flips", s.max_flips},
                 {"planned_interference", s.planned_interference},
                 {"min_support", s.min_support},
                 {"max_item_mass", s.max_item_mass}}},
               {"container", {{"inner_size", as_json(state.inner_size)}, {"walls", state.has_walls}}},
               {"future", future}});
  }

  Json ask(const Json& question) const {
    const std::string answer = input_.ask(question.dump());
    Json json = Json::parse(answer, nullptr, false);
    if (!json.is_object()) throw AgentError(name_ + ": the answer is no JSON object: " + answer.substr(0, 200));
    if (json.contains("error")) throw AgentError(name_ + ": " + json["error"].dump());
    return json;
  }

  Expected<Decision, NoPlace> read(const Json& answer, const Item& item, const std::vector<Place>& places,
                                   PlaceFinder& finder) const {
    try {
      if (!answer.contains("places") || answer["places"].empty()) return tl::unexpected(NoPlace::NoSpace);
      if (!answer["places"].is_array()) throw AgentError(name_ + ": 'places' is no list: " + answer["places"].dump());
      Decision decision;
      NoPlace reason = NoPlace::NotReachable;
      for (const Json& entry : answer.at("places")) {
        const auto place = place_of(entry, item, places, finder);
        if (!place) {
          reason = place.error();
          continue;
        }
        Candidate candidate = as_candidate(item, *place, -static_cast<double>(decision.candidates.size()));
        if (input_.is_reachable && !input_.is_reachable(candidate.placement)) continue;
        decision.candidates.push_back(std::move(candidate));
        if (static_cast<int>(decision.candidates.size()) >= input_.settings.max_candidates) break;
      }
      if (decision.candidates.empty()) return tl::unexpected(reason);
      return decision;
    } catch (const nlohmann::json::exception& error) {
      throw AgentError(name_ + ": the answer is not understood: " + error.what());
    }
  }

  [[nodiscard]] Expected<Place, NoPlace> place_of(const Json& entry, const Item& item, const std::vector<Place>& places,
                                                  PlaceFinder& finder) const {
    if (entry.is_number_integer()) {
      const auto index = entry.get<std::int64_t>();
      if (index < 0 || index >= static_cast<std::int64_t>(places.size()))
        throw AgentError(name_ + ": candidate " + std::to_string(index) + " of " + std::to_string(places.size()));
      return places[static_cast<std::size_t>(index)];
    }
    const double x = entry.at("x").get<double>(), y = entry.at("y").get<double>();
    if (!std::isfinite(x) || !std::isfinite(y)) throw AgentError(name_ + ": a place that is not finite");
    return finder.lower(item, parse_orientation(entry), x, y);
  }

  std::string name_;
  AgentInput input_;
  bool has_begun_ = false;
};

}  // namespace

std::unique_ptr<Agent> make_remote_agent(std::string_view name, AgentInput input) {
  return std::make_unique<RemoteAgent>(name, std::move(input));
}

}  // namespace snug::packing
