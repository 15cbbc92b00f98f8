// Environment: items, places and what is seen of them; what happens to a box is in internal/.
#include "snug/environment/environment.hpp"

#include <algorithm>
#include <cmath>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/hash.hpp"
#include "snug/core/input_error.hpp"
#include "snug/environment/internal/placer.hpp"
#include "snug/model/scenario_changes.hpp"

namespace snug::environment {
namespace {

constexpr std::string_view kSequence = "episode";
constexpr int kMostCells = 4'000'000;

void check(const Settings& s, const Parameters& p) {
  require_number(s.resolution >= 1e-4 && s.resolution <= 10.0, "environment", "resolution", s.resolution,
                 "0.0001 .. 10 m");
  require_number(s.max_candidates >= 1 && s.max_candidates <= 1000, "environment", "max_candidates", s.max_candidates,
                 "1 .. 1000");
  require_number(s.max_steps >= 1, "environment", "max_steps", s.max_steps, "1 or more");
  require_number(s.settle_time > 0.0 && s.settle_time <= 60.0, "environment", "settle_time", s.settle_time,
                 "above 0, at most 60 s");
  require_number(s.time_step >= 0.0 && s.time_step <= 0.1, "environment", "time_step", s.time_step, "0 .. 0.1 s");
  require_number(s.max_displacement > 0.0, "environment", "max_displacement", s.max_displacement, "above 0 m");
  require_number(s.max_tilt > 0.0, "environment", "max_tilt", s.max_tilt, "above 0 rad");
  require_number(std::abs(p.size_offset) <= 0.02, "environment", "size_offset", p.size_offset, "-0.02 .. 0.02 m");
  require_number(p.friction_scale >= 0.0 && p.friction_scale <= 100.0, "environment", "friction_scale",
                 p.friction_scale, "0 .. 100");
  require_number(p.cup_scale > 0.0 && p.cup_scale <= 100.0, "environment", "cup_scale", p.cup_scale,
                 "above 0, at most 100");
  require_number(p.mass_scale > 0.0 && p.mass_scale <= 100.0, "environment", "mass_scale", p.mass_scale,
                 "above 0, at most 100");
}

/// What scaling lengths and masses leaves of a scenario, written nowhere: parameters are few and say it themselves.
model::Scenario with_parameters(model::Scenario scenario, const Parameters& p) {
  for (model::Parcel& parcel : scenario.parcels) {
    parcel.size += Vector3::Constant(p.size_offset);
    if (parcel.size.minCoeff() <= scenario.parcel_clearance)
      throw InputError("environment", "size_offset", std::to_string(p.size_offset), "one that leaves boxes a size");
    parcel.inertia.mass *= p.mass_scale;
    parcel.inertia.inertia *= p.mass_scale;
  }
  for (model::ContactPair& pair : scenario.contact_pairs) pair.params.friction *= p.friction_scale;
  if (scenario.default_contact) scenario.default_contact->friction *= p.friction_scale;
  model::scale_stiffness(scenario.cup, p.cup_scale);
  scale(scenario.cup.damping, p.cup_scale);
  model::vary_cups(p.cup_scale, p.cup_scale, 0.0, scenario.gripper);
  return scenario;
}

/// The sequence that is named, or every parcel in the scenario's order.
model::Sequence sequence_of(const model::Scenario& scenario, const std::string& name) {
  model::Sequence sequence;
  if (name.empty()) {
    for (const model::Parcel& parcel : scenario.parcels) sequence.items.emplace_back().parcel = parcel.id;
  } else if (const model::Sequence* found = model::find_sequence(scenario, name)) {
    sequence = *found;
  } else {
    std::string names;
    for (const model::Sequence& known : scenario.sequences) names += (names.empty() ? "" : ", ") + known.name;
    throw InputError(scenario.source_name, "sequence", "'" + name + "'", "one of " + names);
  }
  sequence.name = kSequence;
  if (sequence.items.empty()) throw InputError(scenario.source_name, "parcels", "none", "boxes to be packed");
  return sequence;
}

const model::Container& container_of(const model::Scenario& scenario) {
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr) throw InputError(scenario.source_name, "target", "nothing", "a container to be packed");
  return *container;
}

packing::PackingSettings rules_of(const Settings& settings) {
  packing::PackingSettings rules = settings.packing;
  if (settings.mode == Mode::Executed) rules.max_flips = 0;  // the tool brings boxes as they stand
  return rules;
}

}  // namespace

struct Environment::State {
  State(const model::Scenario& from, const Settings& asked, const Parameters& parameters)
      : settings(asked),
        scenario((check(asked, parameters), model::with_time_step(with_parameters(from, parameters), asked.time_step))),
        base(sequence_of(scenario, asked.sequence)),
        container(packing::make_container_state(container_of(scenario))),
        finder(container, rules_of(asked)) {
    if (asked.mode == Mode::Executed && (!scenario.aligner || !scenario.tool))
      throw InputError(scenario.source_name, "mode", "executed", "a scenario with aligner and tool");
    for (const model::Item& item : base.items) base_items.push_back(packing::make_item(scenario, item));
    finder = packing::PlaceFinder(
        container, rules_of(asked),
        asked.varies ? std::span<const packing::Item>{} : std::span<const packing::Item>(base_items));
    const double cells_y = std::ceil(container.inner_size.y() / settings.resolution - 1e-9);
    const double cells_x = std::ceil(container.inner_size.x() / settings.resolution - 1e-9);
    require_number(cells_x * cells_y <= kMostCells, "environment", "resolution", settings.resolution,
                   "one that leaves at most 4e6 cells");
    rows = static_cast<int>(cells_y);
    columns = static_cast<int>(cells_x);
  }
  State(const State& other) = default;

  /// A copy's placer goes on by itself.
  struct Clonable {
    Clonable() = default;
    Clonable(const Clonable& other) : it(other.it ? other.it->clone() : nullptr) {}
    Clonable& operator=(const Clonable&) = delete;
    std::unique_ptr<internal::Placer> it;
  };

  void reset(std::uint64_t seed) {
    Rng rng = Rng(seed).split("environment");
    order.resize(base.items.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    if (settings.sequence.empty()) {  // Fisher and Yates
      for (std::size_t i = order.size(); i > 1; --i) {
        std::swap(order[i - 1], order[static_cast<std::size_t>(rng.index(static_cast<int>(i)))]);
      }
    }
    boxes.clear();
    placed.clear();
    next = 0;
    steps = 0;
    packed = 0.0;
    has_ended = false;
    finder.reset();
    heights.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), 0.0F);
    begin_placer(rng);
    (void)look_for_places();
  }

  void begin_placer(Rng rng) {
    placer.it.reset();
    const bool changes = settings.varies;
    items.clear();
    if (settings.mode == Mode::Geometric && !changes) {
      for (const std::size_t i : order) items.push_back(base_items[i]);
      return;
    }
    model::Scenario drawn = scenario;
    model::Sequence sequence = base;
    for (std::size_t i = 0; i < order.size(); ++i) sequence.items[i] = base.items[order[i]];
    drawn.sequences = {sequence};
    if (changes) drawn = cell::draw_scenario(drawn, sequence.name, rng.split("variation"));
    for (const model::Item& item : sequence.items) items.push_back(packing::make_item(drawn, item));
    if (settings.mode == Mode::Geometric) return;
    const std::string name(kSequence);
    const internal::Episode episode{drawn, name, settings};
    placer.it = settings.mode == Mode::Statics ? make_statics(episode) : make_execution(episode);
  }

  /// For the next item; why there is none.
  std::string_view look_for_places() {
    candidates.clear();
    if (next >= static_cast<int>(items.size())) {
      has_ended = true;
      return "all items are packed";
    }
    auto found = finder.find(items[static_cast<std::size_t>(next)], settings.max_candidates);
    if (found) {
      candidates = std::move(*found);
      return {};
    }
    has_ended = true;
    return packing::describe(found.error());
  }

  [[nodiscard]] Expected<packing::Place, std::string_view> place_of(const Action& action) {
    if (action.candidate >= 0) {
      if (action.candidate < static_cast<int>(candidates.size()))
        return candidates[static_cast<std::size_t>(action.candidate)];
      return tl::unexpected(std::string_view("there is no such candidate"));
    }
    if (action.orientation < 0 || action.orientation >= static_cast<int>(orientations().size()))
      return tl::unexpected(std::string_view("there is no such orientation"));
    if (!std::isfinite(action.x) || !std::isfinite(action.y))
      return tl::unexpected(std::string_view("the place is not a number"));
    const auto place = finder.lower(items[static_cast<std::size_t>(next)],
                                    orientations()[static_cast<std::size_t>(action.orientation)], action.x, action.y);
    if (!place) return tl::unexpected(packing::describe(place.error()));
    return *place;
  }

  Step step(const Action& action) {
    Step result;
    if (has_ended) {
      result.terminated = true;
      result.reason = "the episode has ended";
      return result;
    }
    ++steps;
    const auto place = place_of(action);
    if (!place) {
      result.reason = place.error();
    } else if (placer.it) {
      const internal::Outcome outcome = placer.it->place(next, *place, boxes);
      result.is_placed = outcome.is_placed;
      result.reason = outcome.reason;
      result.displacement = outcome.displacement;
      boxes.push_back({items[static_cast<std::size_t>(next)], {}});
      placed.push_back(next);
      look();
    } else {
      result.is_placed = true;
      put({items[static_cast<std::size_t>(next)], packing::pose_at(*place)});
    }
    result.reward = count();
    ++next;
    if (result.is_placed) {
      result.reason = look_for_places();
    } else {
      candidates.clear();
      has_ended = true;
    }
    result.terminated = has_ended;
    if (!has_ended && steps >= settings.max_steps) {
      result.truncated = has_ended = true;
      result.reason = "as many steps as there may be";
    }
    return result;
  }

  void put(packing::PlacedBox box) {
    raise(box);
    finder.add(box);
    boxes.push_back(std::move(box));
    placed.push_back(next);
  }

  /// Boxes as they are, after something happened to them.
  void look() {
    std::ranges::fill(heights, 0.0F);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      boxes[i].X_TP = placer.it->pose_of(placed[i]);
      raise(boxes[i]);
    }
    finder.reset(boxes);
  }

  /// The box into the height map: each cell that its outline covers a part of, if only a corner.
  void raise(const packing::PlacedBox& box) {
    const packing::Extent extent = packing::bounding_extent(box);
    const Vector3 low = extent.low + 0.5 * container.inner_size, high = extent.high + 0.5 * container.inner_size;
    const auto cell = [&](double length, int count, double slack) {
      return std::clamp(static_cast<int>(std::floor(length / settings.resolution + slack)), 0, count);
    };
    constexpr double kSlack = 1e-6;  // of a cell
    const int x1 = cell(low.x(), columns, kSlack), x2 = cell(high.x(), columns, 1.0 - kSlack);
    const int y1 = cell(low.y(), rows, kSlack), y2 = cell(high.y(), rows, 1.0 - kSlack);
    const auto top = static_cast<float>(extent.high.z());
    for (int y = y1; y < y2; ++y) {
      float* const row = heights.data() + static_cast<std::ptrdiff_t>(y) * columns;
      for (int x = x1; x < x2; ++x) row[x] = std::max(row[x], top);
    }
  }

  /// Adds up what is packed; the change, as part of the container.
  double count() {
    double volume = 0.0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (!placer.it || placer.it->is_packed(placed[i])) volume += boxes[i].item.size.prod();
    }
    const double before = packed;
    packed = volume / container.inner_size.prod();
    return packed - before;
  }

  Settings settings;
  model::Scenario scenario;
  model::Sequence base;
  packing::ContainerState container;  ///< empty
  packing::PlaceFinder finder;
  std::vector<packing::Item> base_items;
  int rows = 0, columns = 0;

  std::vector<std::size_t> order;
  std::vector<packing::Item> items;
  std::vector<packing::PlacedBox> boxes;
  std::vector<int> placed;  ///< items of `boxes`
  std::vector<packing::Place> candidates;
  std::vector<float> heights;
  Clonable placer;
  int next = 0;
  int steps = 0;
  double packed = 0.0;  ///< part of the container's volume
  bool has_ended = true;
};

Environment::Environment(const model::Scenario& scenario, const Settings& settings, const Parameters& parameters)
    : state_(std::make_unique<State>(scenario, settings, parameters)) {
  reset(scenario.seed);
}
Environment::Environment(const Environment& other) : state_(std::make_unique<State>(*other.state_)) {}
Environment& Environment::operator=(const Environment& other) {
  if (this != &other) state_ = std::make_unique<State>(*other.state_);
  return *this;
}
Environment::Environment(Environment&&) noexcept = default;
Environment& Environment::operator=(Environment&&) noexcept = default;
Environment::~Environment() = default;

void Environment::reset(std::uint64_t seed) { state_->reset(seed); }
Step Environment::step(const Action& action) { return state_->step(action); }

void Environment::observe(const ObservationView& view) const {
  const State& s = *state_;
  const auto put = [](std::span<float> to, std::size_t at, std::initializer_list<double> numbers) {
    for (const double number : numbers) to[at++] = static_cast<float>(number);
  };
  if (!view.height_map.empty()) std::ranges::copy(s.heights, view.height_map.begin());
  if (!view.item.empty()) {
    std::ranges::fill(view.item, 0.0F);
    if (s.next < static_cast<int>(s.items.size())) {
      const packing::Item& item = s.items[static_cast<std::size_t>(s.next)];
      const Vector3 e = packing::extents(item.arrival, item.size);
      put(view.item, 0, {e.x(), e.y(), e.z(), item.mass, item.upright_only ? 1.0 : 0.0, item.no_stack ? 1.0 : 0.0});
    }
  }
  if (!view.boxes.empty()) {
    std::ranges::fill(view.boxes, 0.0F);
    for (std::size_t i = 0; i < s.boxes.size(); ++i) {
      const packing::Extent e = packing::bounding_extent(s.boxes[i]);
      put(view.boxes, i * kBoxNumbers,
          {e.low.x(), e.low.y(), e.low.z(), e.high.x(), e.high.y(), e.high.z(), s.boxes[i].item.mass});
    }
  }
  if (!view.candidates.empty()) std::ranges::fill(view.candidates, 0.0F);
  if (!view.mask.empty()) std::ranges::fill(view.mask, std::int8_t{0});
  for (std::size_t i = 0; i < s.candidates.size(); ++i) {
    const packing::Place& p = s.candidates[i];
    if (!view.mask.empty()) view.mask[i] = 1;
    if (view.candidates.empty()) continue;
    const packing::Orientation& o = p.orientation;
    const int index = 8 * static_cast<int>(o.up) + (o.up_sign > 0 ? 0 : 4) + o.yaw_quarter;
    put(view.candidates, i * kCandidateNumbers,
        {p.low_T.x(), p.low_T.y(), p.low_T.z(), p.extents.x(), p.extents.y(), p.extents.z(), p.support,
         static_cast<double>(index)});
  }
}

const Settings& Environment::settings() const { return state_->settings; }
int Environment::rows() const { return state_->rows; }
int Environment::columns() const { return state_->columns; }
int Environment::most_boxes() const { return static_cast<int>(state_->base.items.size()); }

const std::vector<packing::Orientation>& Environment::orientations() {
  static const std::vector<packing::Orientation> all = [] {
    std::vector<packing::Orientation> list;
    for (const model::UpAxis up : {model::UpAxis::X, model::UpAxis::Y, model::UpAxis::Z}) {
      for (const int sign : {1, -1}) {
        for (int yaw = 0; yaw < 4; ++yaw) list.push_back({up, sign, yaw});
      }
    }
    return list;
  }();
  return all;
}

const std::vector<packing::Item>& Environment::items() const { return state_->items; }
int Environment::next() const { return state_->next; }
bool Environment::has_ended() const { return state_->has_ended; }
const std::vector<packing::Place>& Environment::candidates() const { return state_->candidates; }
const std::vector<packing::PlacedBox>& Environment::boxes() const { return state_->boxes; }
double Environment::packed_percent() const { return 100.0 * state_->packed; }
double Environment::time() const { return state_->placer.it ? state_->placer.it->time() : 0.0; }

std::uint64_t Environment::hash() const {
  Hash hash;
  for (const packing::PlacedBox& box : state_->boxes) {
    for (int i = 0; i < 3; ++i) hash.add(box.X_TP.p[i]);
    for (int i = 0; i < 9; ++i) hash.add(box.X_TP.R(i / 3, i % 3));
  }
  hash.add(static_cast<std::uint64_t>(state_->next));
  if (state_->placer.it) hash.add(state_->placer.it->hash());
  return hash.value();
}

}  // namespace snug::environment
