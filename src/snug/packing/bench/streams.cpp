// Streams: lines of boxes as the literature on packing online draws them, and a greedy of one line to compare with.
#include "snug/packing/bench/streams.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "snug/model/items_file.hpp"
#include "snug/packing/internal/agents.hpp"

namespace snug::packing::bench {
namespace {

constexpr double kUnit = 0.05;  ///< m, a cell of the 10^3 containers
constexpr int kCells = 10;

using Cells = std::array<int, 3>;
struct Cut {
  Cells low{}, size{};
};

Item make_item_of(const Vector3& size, std::size_t number) {
  Item item;
  item.id = "B" + std::to_string(number);
  item.size = size;
  item.mass = 1000.0 * 0.2 * size.prod();
  return item;
}

Vector3 metres(const Cells& cells) { return kUnit * Vector3(cells[0], cells[1], cells[2]); }

/// Nothing but geometry.
PackingSettings plain_settings(double min_support) {
  PackingSettings settings;
  settings.max_flips = 2;
  settings.planned_interference = settings.last_interference = 0.0;
  settings.min_support = min_support;
  settings.com_margin = 0.0;
  settings.level_slack = 0.0;
  settings.min_slenderness = 0.0;
  settings.max_item_mass = 1e6;
  settings.min_pick_face = 0.0;
  return settings;
}

/// Every side of every kind equally likely, again and again.
FutureModel cube_kinds(int least, int most) {
  FutureModel future;
  for (int a = least; a <= most; ++a) {
    for (int b = least; b <= most; ++b) {
      for (int c = least; c <= most; ++c) {
        future.kinds.push_back(make_item_of(metres({a, b, c}), 1000 + future.kinds.size()));
        future.weights.push_back(1.0);
      }
    }
  }
  return future;
}

/// The container cut by planes until every side is 2 to 5.
std::vector<Cut> cut_container(Rng& rng) {
  std::vector<Cut> open{{{0, 0, 0}, {kCells, kCells, kCells}}}, done;
  while (!open.empty()) {
    Cut one = open.back();
    open.pop_back();
    std::vector<std::size_t> axes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (one.size[axis] > 5) axes.push_back(axis);
    }
    if (axes.empty()) {
      done.push_back(one);
      continue;
    }
    const std::size_t axis = axes[static_cast<std::size_t>(rng.index(static_cast<int>(axes.size())))];
    const int at = 2 + rng.index(one.size[axis] - 3);
    Cut rest = one;
    one.size[axis] = at;
    rest.low[axis] += at;
    rest.size[axis] -= at;
    open.push_back(one);
    open.push_back(rest);
  }
  return done;
}

bool stands_on(const Cut& upper, const Cut& lower) {
  if (lower.low[2] + lower.size[2] != upper.low[2]) return false;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (upper.low[axis] >= lower.low[axis] + lower.size[axis]) return false;
    if (lower.low[axis] >= upper.low[axis] + upper.size[axis]) return false;
  }
  return true;
}

/// At random, none before what it stands on.
std::vector<Cut> stacked(std::vector<Cut> cuts, Rng& rng) {
  std::vector<Cut> order;
  while (!cuts.empty()) {
    std::vector<std::size_t> ready;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      if (std::ranges::none_of(cuts, [&](const Cut& other) { return stands_on(cuts[i], other); })) ready.push_back(i);
    }
    const std::size_t next = ready[static_cast<std::size_t>(rng.index(static_cast<int>(ready.size())))];
    order.push_back(cuts[next]);
    cuts.erase(cuts.begin() + static_cast<std::ptrdiff_t>(next));
  }
  return order;
}

/// An order of cartons of three to ten sizes, upright, 45 % more of them than the pallet takes by volume.
void draw_pallet(Rng& rng, Stream& stream) {
  stream.container.inner_size = Vector3(1.23, 1.03, 1.85);
  stream.container.has_walls = false;
  stream.future.comes_once = true;
  std::vector<Item> pool;  // one to four of each size
  for (int sizes = 3 + rng.index(8); sizes > 0;) {
    const auto side = [&rng](int least, int most) { return 0.01 * (least + rng.index(most - least + 1)); };
    const double length = side(30, 60), width = side(24, 40), height = side(12, 32);
    Item item = make_item_of({length, width, height}, 0);
    item.mass = rng.uniform(80.0, 140.0) * item.size.prod();
    item.upright_only = true;
    if (width > length || item.mass < 1.5 || item.mass > 8.0) continue;
    pool.insert(pool.end(), static_cast<std::size_t>(1 + rng.index(4)), item);
    --sizes;
  }
  for (double volume = 0.0; volume < 1.45 * stream.container.inner_size.prod();) {
    Item item = pool[static_cast<std::size_t>(rng.index(static_cast<int>(pool.size())))];
    item.id = "B" + std::to_string(stream.items.size());
    volume += item.size.prod();
    stream.items.push_back(item);
    stream.future.kinds.push_back(item);
    stream.future.weights.push_back(1.0);
  }
}

}  // namespace

std::optional<Stream> draw_stream(const std::string& family, Rng rng) {
  Stream stream;
  stream.container.inner_size = Vector3::Constant(kCells * kUnit);
  if (family == "rs" || family == "rs-support") {
    stream.settings = plain_settings(family == "rs" ? 0.0 : 0.6);
    stream.future = cube_kinds(1, 5);
    for (std::size_t i = 0; i < 120; ++i) {
      stream.items.push_back(make_item_of(metres({1 + rng.index(5), 1 + rng.index(5), 1 + rng.index(5)}), i));
    }
  } else if (family == "cut1" || family == "cut2") {
    stream.settings = plain_settings(0.0);
    stream.future = cube_kinds(2, 5);
    std::vector<Cut> cuts = cut_container(rng);
    if (family == "cut2") {
      cuts = stacked(std::move(cuts), rng);
    } else {
      std::ranges::stable_sort(cuts, {}, [](const Cut& one) { return one.low[2]; });
    }
    for (const Cut& cut : cuts) stream.items.push_back(make_item_of(metres(cut.size), stream.items.size()));
  } else if (family == "cartons" || family == "cartons-pallet") {
    stream.container.inner_size = Vector3(0.6, 0.4, 0.3);
    stream.container.has_walls = family == "cartons";
    stream.settings = plain_settings(0.6);
    stream.settings.com_margin = 0.005;
    const auto draw = [&rng](std::size_t number) {
      const auto side = [&rng] { return 0.001 * (60 + 5 * rng.index(49)); };
      const double a = side(), b = side(), c = side();
      return make_item_of({a, b, c}, number);
    };
    for (std::size_t i = 0; i < 100; ++i) stream.items.push_back(draw(i));
    for (std::size_t i = 0; i < 100; ++i) {
      stream.future.kinds.push_back(draw(1000 + i));
      stream.future.weights.push_back(1.0);
    }
  } else if (family == "pallet") {
    draw_pallet(rng, stream);
  } else {
    return std::nullopt;
  }
  return stream;
}

std::vector<Stream> load_streams(const std::filesystem::path& orders) {
  std::vector<Stream> streams;
  std::string order;
  for (const model::OrderLine& line : model::load_orders(orders)) {
    if (streams.empty() || line.order != order) {
      order = line.order;
      Stream& stream = streams.emplace_back();
      stream.container.inner_size = Vector3(1.2, 0.8, 0.8);
      stream.settings = plain_settings(0.6);
      stream.settings.com_margin = 0.005;
      stream.future.comes_once = true;
    }
    Stream& stream = streams.back();
    for (int i = 0; i < line.count; ++i) {
      Item item = make_item_of(line.size, stream.items.size());
      item.mass = line.mass;
      stream.items.push_back(item);
      stream.future.kinds.push_back(item);
      stream.future.weights.push_back(1.0);
    }
  }
  return streams;
}

namespace {

std::optional<internal::Weights> weights_of(const std::string& agent) {
  if (agent == "contact") return internal::contact_weights();
  if (agent == "mixed") return internal::default_weights();
  if (agent == "grid") return internal::grid_weights();
  if (agent == "pallet") return internal::pallet_weights();
  if (agent == "pallet-layers") return internal::pallet_layer_weights();
  if (agent != "lowest") return std::nullopt;
  internal::Weights lowest{};
  lowest[internal::Top] = 1.0;
  lowest[internal::Touch] = -1e-3;
  return lowest;
}

}  // namespace

bool is_greedy(const std::string& agent) { return weights_of(agent).has_value(); }

std::optional<Candidate> place_greedily(const std::string& agent, const Stream& stream, const ContainerState& state,
                                        const Item& item) {
  using namespace internal;
  const Planning planning = plan_for_contact(state, stream.settings);
  const Choice choice = make_choice(planning, item);
  const std::vector<Item>& kinds = stream.future.kinds;
  const Layout layout = to_layout(planning, make_rules(planning, kinds), state);
  Policy policy = make_policy(planning, kinds);
  policy.weights = weights_of(agent).value();
  CandidatePoseList list;
  layout.find_poses(choice.piece, list);
  order_by_cost(layout, policy, choice.piece, list.poses);
  for (const CandidatePose& pose : list.poses) {
    if (auto candidate = place_item(planning, layout, item, choice, pose, {})) return *candidate;
  }
  return std::nullopt;
}

}  // namespace snug::packing::bench
