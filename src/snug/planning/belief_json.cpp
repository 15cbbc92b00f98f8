// Belief files: a belief, the item that is to be decided on and the budget, as JSON: a decision that can be repeated.
#include "snug/planning/belief_json.hpp"

#include <algorithm>
#include <utility>

#include "snug/core/hash.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/planning/internal/belief_forms.hpp"

namespace snug::planning {
namespace {

using namespace internal;  // NOLINT(google-build-using-namespace): the forms of the file

constexpr int kMostSamples = 1000;

ScenarioForm form_of(const model::Scenario& scenario, const std::string& name) {
  ScenarioForm form{scenario.name, scenario.source_name, scenario.source_text, name, {}, {}};
  const model::Sequence& sequence = *model::find_sequence(scenario, name);
  for (const model::Item& item : sequence.items) form.items.push_back({item});
  form.task_stiffness = sequence.task_stiffness;
  return form;
}

BeliefForm form_of(const BeliefSnapshot& belief) {
  BeliefForm form;
  form.scenario = form_of(belief.scenario, belief.sequence);
  form.seed = belief.seed;
  const SimulationChoice& simulation = belief.simulation;
  form.simulation = {simulation.tracking, simulation.cup ? cup::name_of(*simulation.cup) : "", simulation.robot};
  form.agent.settings = belief.agent;
  for (const packing::Item& kind : belief.agent.future.kinds) form.agent.kinds.push_back(kind.id);
  form.has_chosen = !belief.chosen.empty();
  for (std::size_t i = 0; i < belief.items.size(); ++i) {
    ItemForm& item = form.items.emplace_back();
    item.id = belief.items[i].id;
    item.size = belief.items[i].size;
    item.arrival = belief.items[i].arrival;
    if (form.has_chosen) item.chosen = belief.chosen[i];
    if (const auto& box = belief.boxes[i]) item.box = {box->X_WP, box->covariance, box->was_seen};
  }
  const std::vector<World> drawn =
      draw_worlds(belief.scenario, belief.sequence, belief.seed, static_cast<int>(belief.worlds.size()) - 1);
  for (std::size_t w = 0; w < drawn.size(); ++w) {
    WorldForm& world = form.worlds.emplace_back();
    world.weight = belief.worlds[w].weight;
    world.X_WP = belief.worlds[w].X_WP;
    const auto& parcels = belief.worlds[w].scenario.parcels;
    for (std::size_t i = 0; i < parcels.size(); ++i) {
      if (parcels[i].size != drawn[w].scenario.parcels[i].size) world.sizes.push_back({parcels[i].id, parcels[i].size});
    }
  }
  form.stiffenings = belief.stiffenings;
  form.obstacles = belief.obstacles;
  form.obstacle_bodies = belief.obstacle_bodies;
  form.sent = belief.sent;
  for (const FailedMotion& one : belief.failed) form.failed.push_back({one});
  form.skipped = belief.skipped;
  form.skips_left = belief.skips_left;
  form.next = belief.next;
  form.robot = {belief.robot};
  return form;
}

std::string hex(std::uint64_t value) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; value >>= 4U) text[i] = kDigits[value & 15U];
  return text;
}

class Restorer {
 public:
  Restorer(const BeliefForm& form, const std::string& where) : form_(form), where_(where) {}

  BeliefSnapshot restore() {
    restore_scenario();
    expect(!form_.worlds.empty() && form_.worlds.size() <= kMostSamples + 1, "worlds", "1 .. 1001 worlds");
    belief_.seed = form_.seed;
    belief_.worlds =
        draw_worlds(belief_.scenario, belief_.sequence, form_.seed, static_cast<int>(form_.worlds.size()) - 1);
    belief_.simulation.tracking = form_.simulation.tracking;
    if (!form_.simulation.cup.empty()) belief_.simulation.cup = cup::cup_mode_of(form_.simulation.cup, where_);
    belief_.simulation.robot = form_.simulation.robot;
    restore_agent();
    restore_items();
    belief_.obstacles = form_.obstacles;
    belief_.obstacle_bodies = form_.obstacle_bodies;
    expect(form_.stiffenings >= 0 && form_.stiffenings <= 1000, "stiffenings", "0 .. 1000");
    belief_.stiffenings = form_.stiffenings;
    for (std::size_t w = 0; w < form_.worlds.size(); ++w) restore_world(form_.worlds[w], belief_.worlds[w]);
    for (const auto* items : {&form_.sent, &form_.skipped}) {
      for (const model::ItemIndex item : *items) expect_item(item, items == &form_.sent ? "sent" : "skipped");
    }
    if (form_.next) expect_item(*form_.next, "next");
    belief_.sent = form_.sent;
    for (const FailedForm& one : form_.failed) {
      expect_item(one.motion.item, "failed");
      belief_.failed.push_back(one.motion);
    }
    belief_.skipped = form_.skipped;
    belief_.skips_left = form_.skips_left;
    belief_.next = form_.next;
    belief_.robot = form_.robot.state;
    return std::move(belief_);
  }

 private:
  void expect(bool holds, const char* key, const std::string& expected) const {
    if (!holds) throw InputError(where_, key, "something else", expected);
  }
  void expect_item(model::ItemIndex item, const char* key) const {
    expect(item.is_valid() && item.slot() < form_.items.size(), key, "items of the sequence, from 0");
  }

  void restore_scenario() {
    belief_.scenario = model::parse_scenario(form_.scenario.text, form_.scenario.source);
    belief_.scenario.name = form_.scenario.name;
    belief_.sequence = form_.scenario.sequence;
    model::Sequence sequence{form_.scenario.sequence, {}, form_.scenario.task_stiffness, {}};
    for (const SequenceItem& one : form_.scenario.items) {
      expect(model::find_parcel(belief_.scenario, one.item.parcel) != nullptr, "scenario.items",
             "parcels of the scenario");
      sequence.items.push_back(one.item);
    }
    auto& sequences = belief_.scenario.sequences;
    const auto known = std::ranges::find(sequences, sequence.name, &model::Sequence::name);
    if (known == sequences.end()) {
      sequences.push_back(std::move(sequence));
    } else {  // the program may have shortened it
      known->items = std::move(sequence.items);
      known->task_stiffness = sequence.task_stiffness;
    }
  }

  void restore_agent() {
    belief_.agent = form_.agent.settings;
    for (const std::string& id : form_.agent.kinds) {
      const model::Parcel* parcel = model::find_parcel(belief_.scenario, id);
      expect(parcel != nullptr, "agent.future_kinds", "parcels of the scenario");
      belief_.agent.future.kinds.push_back(packing::make_future_model(belief_.scenario, {parcel, 1}).kinds.front());
    }
    expect(belief_.agent.future.weights.size() == belief_.agent.future.kinds.size(), "agent.future_weights",
           "a weight of each kind");
  }

  void restore_items() {
    belief_.items = packing::make_items(belief_.nominal(), *model::find_sequence(belief_.nominal(), belief_.sequence));
    expect(belief_.items.size() == form_.items.size(), "items", "an entry of each item of the sequence");
    for (std::size_t i = 0; i < form_.items.size(); ++i) {
      const ItemForm& from = form_.items[i];
      expect(from.id == belief_.items[i].id, "items", "item " + belief_.items[i].id + " at " + std::to_string(i));
      belief_.items[i].size = from.size;
      belief_.items[i].arrival = from.arrival;
      if (form_.has_chosen) belief_.chosen.push_back(from.chosen);
      belief_.boxes.emplace_back();
      if (from.box) belief_.boxes.back() = BelievedBox{from.box->X_WP, from.box->covariance, from.box->was_seen};
    }
  }

  void restore_world(const WorldForm& from, World& world) const {
    expect(from.X_WP.size() == form_.items.size(), "worlds.X_WP", "a pose or null of each item");
    for (std::size_t i = 0; i < form_.items.size(); ++i) {
      expect(from.X_WP[i].has_value() || !belief_.boxes[i].has_value(), "worlds.X_WP", "a pose of each box");
    }
    world.weight = from.weight;
    world.X_WP = from.X_WP;
    for (const SizeForm& one : from.sizes) {
      const auto parcel = std::ranges::find(world.scenario.parcels, one.parcel, &model::Parcel::id);
      expect(parcel != world.scenario.parcels.end() && one.size.minCoeff() > 0.0 && one.size.allFinite(),
             "worlds.sizes", "sizes [m] of parcels of the scenario");
      parcel->size = one.size;
    }
    set_obstacles(belief_, world);
    stiffen(belief_.scenario.belief, 0, belief_.stiffenings, world);
  }

  const BeliefForm& form_;
  const std::string& where_;
  BeliefSnapshot belief_;
};

}  // namespace

std::string format_belief(const BeliefSnapshot& belief) { return format_json(write_json(form_of(belief))); }

std::string format_request(const PlanRequest& request) {
  const RequestForm form{kVersion,
                         request.belief.items[request.item.slot()].id,
                         request.item,
                         request.budget.decision_time,
                         hex(hash(request.belief)),
                         form_of(request.belief)};
  return format_json(write_json(form)) + "\n";
}

PlanRequest parse_request(std::string_view text, const std::string& name) {
  const JsonValue value = parse_json(text, name);
  const JsonReader reader(value, name);
  if (value.find("snug_belief") == nullptr)
    throw InputError(name, "snug_belief", "nothing", "a file of `snug pack --save-belief`");
  const auto form = reader.as<RequestForm>();
  if (form.version != kVersion) {
    throw InputError(name, "snug_belief", std::to_string(form.version), "version " + std::to_string(kVersion));
  }
  PlanRequest request{Restorer(form.belief, name).restore(), form.item, {}};
  request.budget.decision_time = form.decision_time;
  if (!form.item.is_valid() || form.item.slot() >= request.belief.items.size()) {
    throw InputError(name, "item", std::to_string(form.item.value), "an item of the sequence, from 0");
  }
  if (hex(hash(request.belief)) != form.hash) {
    throw InputError(name, "hash", form.hash, hex(hash(request.belief)) + ": that of the belief as it was read");
  }
  return request;
}

PlanRequest load_request(const std::filesystem::path& path) {
  return parse_request(read_file(path, "a belief (JSON, snug pack --save-belief)"), path.string());
}

void expect_can_be_saved(const BeliefSnapshot& belief) {
  if (belief.scenario.source_text.empty()) {
    throw InputError(belief.scenario.source_name, "", "a scenario without text", "one that was read from a file");
  }
  const PlanRequest request{belief, model::ItemIndex(0), {}};
  if (parse_request(format_request(request), "the belief").belief != belief) {
    throw InputError(belief.scenario.source_name, "", "a scenario that its text does not give",
                     "one that was read from a file and changed by options");
  }
}

}  // namespace snug::planning
