// Policy: features of a pose and their weighted sum.
#include "snug/packing/internal/policy.hpp"

#include <algorithm>
#include <numeric>

namespace snug::packing::internal {

namespace {

constexpr int kTouch = 30;  ///< ticks: nearer boxes count as touching

/// Ticks^3 under a box that are filled or lost already.
double filled_below(const Layout& layout, const Block& me) {
  if (me.z1 == 0) return 0.0;
  double below = 0.0;
  for (std::size_t i = 0; i < layout.blocks().size(); ++i) {
    const Block& b = layout.blocks()[i];
    const int ox = std::min(me.x2, b.x2) - std::max(me.x1, b.x1);
    const int oy = std::min(me.y2, b.y2) - std::max(me.y1, b.y1);
    if (ox > 0 && oy > 0) below += layout.columns()[i] * ox * oy;
  }
  return below;
}

BlockTable::Beside look_beside(const Layout& layout, const Block& me) {
  const Rules& rules = layout.rules();
  BlockTable::Beside s;
  s.gap = {me.x1, rules.size_x - me.x2, me.y1, rules.size_y - me.y2};
  const int height = me.z2 - me.z1;
  const int lengths[4] = {me.y2 - me.y1, me.y2 - me.y1, me.x2 - me.x1, me.x2 - me.x1};
  for (int side = 0; side < 4; ++side) {
    if (s.gap[static_cast<std::size_t>(side)] <= kTouch) s.contact += std::int64_t{lengths[side]} * height;
  }
  layout.table().look_beside({me.x1, me.y1, me.x2, me.y2}, me.z1, me.z2, kTouch, s);
  return s;
}

/// Sides at which a block touches `me` at the height of its middle: low x, high x, low y, high y.
std::array<bool, 4> find_held_sides(const Layout& layout, const Block& me) {
  std::array<bool, 4> held{};
  const int middle = (me.z1 + me.z2) / 2;
  for (const Block& b : layout.blocks()) {
    if (b.z2 < middle || b.z1 > middle) continue;
    const int ox = std::min(me.x2, b.x2) - std::max(me.x1, b.x1);
    const int oy = std::min(me.y2, b.y2) - std::max(me.y1, b.y1);
    if (oy > 0 && ox <= 0 && -ox <= kTouch) held[b.x1 < me.x1 ? 0 : 1] = true;
    if (ox > 0 && oy <= 0 && -oy <= kTouch) held[b.y1 < me.y1 ? 2 : 3] = true;
  }
  return held;
}

/// Over the four directions: by what part it tips earlier than at kLeastTipping. Half of it where a neighbour holds it:
/// what a neighbour is pressed with it has to bear itself.
double see_tipping(const Layout& layout, const Block& me) {
  constexpr double kLeastTipping = 0.3;  // g
  constexpr double kHeld = 0.5;
  const std::array<double, 4> tipping = layout.tipping_of(me);
  const std::array<bool, 4> held = find_held_sides(layout, me);
  double sum = 0.0;
  for (std::size_t side = 0; side < 4; ++side) {
    sum += (held[side] ? kHeld : 1.0) * std::max(0.0, 1.0 - tipping[side] / kLeastTipping);
  }
  return sum;
}

/// What is beside a block on the level of its middle, and over 30 % of its side at least.
struct Backing {
  std::array<bool, 4> is_outermost{true, true, true, true};  ///< nothing on this side, as far as the rim
  std::array<int, 4> gap{};                                  ///< ticks, to the nearest on this side
};

Backing find_backing(const Layout& layout, const Block& me) {
  constexpr double kLeastShared = 0.3;
  Backing backing;
  const int middle = (me.z1 + me.z2) / 2;
  const double least_x = kLeastShared * (me.x2 - me.x1), least_y = kLeastShared * (me.y2 - me.y1);
  const auto note = [&backing](std::size_t side, int gap) {
    backing.gap[side] = backing.is_outermost[side] ? gap : std::min(backing.gap[side], gap);
    backing.is_outermost[side] = false;
  };
  for (const Block& b : layout.blocks()) {
    if (b.z2 < middle || b.z1 >= me.z2) continue;
    const int ox = std::min(me.x2, b.x2) - std::max(me.x1, b.x1);
    const int oy = std::min(me.y2, b.y2) - std::max(me.y1, b.y1);
    if (oy > least_y && ox <= 0) note(b.x1 < me.x1 ? 0 : 1, -ox);
    if (ox > least_x && oy <= 0) note(b.y1 < me.y1 ? 2 : 3, -oy);
  }
  return backing;
}

/// Film presses what is outermost toward the middle of the load: how far it can go before something backs it, added up
/// over the four directions, each as a part of kFarthest.
double see_loose(const Layout& layout, const Block& me) {
  constexpr double kBacked = 50, kFarthest = 2000;  // ticks
  const Backing backing = find_backing(layout, me);
  double sum = 0.0;
  for (const std::size_t side : {0U, 1U, 2U, 3U}) {
    const std::size_t inner = side ^ 1U;
    if (!backing.is_outermost[side] || backing.is_outermost[inner]) continue;
    sum += std::clamp((backing.gap[inner] - kBacked) / kFarthest, 0.0, 1.0);
  }
  return sum;
}

}  // namespace

Weights default_weights() {
  Weights w{};
  w[Base] = -0.925;
  w[Top] = -1.510;
  w[Buried] = -0.391;
  w[SideWaste] = 0.861;
  w[HeightWaste] = 0.659;
  w[Contact] = -1.023;
  w[Flush] = -0.300;
  w[Support] = -0.175;
  w[Footprint] = 2.272;
  w[Sliver] = -0.112;
  return w;
}

Weights grid_weights() {
  Weights w{};
  w[Top] = 0.18;
  w[Buried] = 0.10;
  w[SideWaste] = 0.90;
  w[Flush] = -0.45;
  w[Footprint] = 1.00;
  w[Touch] = -2.20;
  return w;
}

Weights contact_weights() {
  Weights w{};
  w[Touch] = -1.0;
  w[Base] = 1e-3;
  w[Top] = 1e-4;
  return w;
}

Weights pallet_weights() {
  Weights w{};
  w[Base] = 3.96;
  w[Top] = -6.33;
  w[Buried] = 6.13;
  w[SideWaste] = 18.18;
  w[HeightWaste] = 5.37;
  w[Contact] = -0.48;
  w[Flush] = 3.48;
  w[Support] = -5.60;
  w[Footprint] = -2.77;
  w[Sliver] = -0.83;
  w[Touch] = -4.65;
  w[Tipping] = 2.77;
  w[Loose] = 0.44;
  w[Exposed] = 9.34;
  return w;
}

Weights pallet_layer_weights() {
  Weights w = default_weights();
  // A tenth of the height counts as much as a face that touches all round; a few millimetres of unevenness do not.
  w[Base] += 10.0;
  w[Tipping] = 3.0;
  return w;
}

Weights pallet_contact_weights() {
  Weights w = contact_weights();
  w[Base] += 10.0;
  w[Tipping] = 3.0;
  w[Loose] = 4.0;
  return w;
}

WasteTable::WasteTable(const std::vector<int>& lengths, int longest) {
  const int last = longest / kTicksPerMillimetre;
  std::vector<char> reached(static_cast<std::size_t>(last) + 1, 0);
  std::vector<int> steps;  // whole millimetres: thousands of boxes have a few hundred different ones
  for (const int length : lengths) steps.push_back((length + kTicksPerMillimetre - 1) / kTicksPerMillimetre);
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  reached[0] = 1;
  waste_.resize(reached.size());
  int best = 0;
  for (int mm = 0; mm <= last; ++mm) {
    for (const int step : steps) {
      if (step > 0 && step <= mm && reached[static_cast<std::size_t>(mm - step)] != 0)
        reached[static_cast<std::size_t>(mm)] = 1;
    }
    if (reached[static_cast<std::size_t>(mm)] != 0) best = mm;
    waste_[static_cast<std::size_t>(mm)] = (mm - best) * kTicksPerMillimetre;
  }
}

int WasteTable::waste(int length) const {
  const int mm = std::clamp(length / kTicksPerMillimetre, 0, static_cast<int>(waste_.size()) - 1);
  return waste_[static_cast<std::size_t>(mm)];
}

Features see(const Layout& layout, const Policy& policy, const Piece& piece, const CandidatePose& pose) {
  const Rules& rules = layout.rules();
  const Block me = Layout::block_at(piece, pose);
  const double width = me.x2 - me.x1, depth = me.y2 - me.y1, height = me.z2 - me.z1;
  const double area = width * depth;
  const BlockTable::Beside s = look_beside(layout, me);
  const double contact = static_cast<double>(s.contact);
  const double floor = static_cast<double>(rules.size_x) * rules.size_y, room = floor * rules.size_z;
  Features f{};
  f[Base] = static_cast<double>(me.z1) / rules.size_z;
  f[Top] = static_cast<double>(me.z2) / rules.size_z;
  f[Buried] = 10.0 * std::max(0.0, area * me.z1 - filled_below(layout, me)) / room;
  const double side = policy.sides.waste(s.gap[0]) * depth + policy.sides.waste(s.gap[1]) * depth +
                      policy.sides.waste(s.gap[2]) * width + policy.sides.waste(s.gap[3]) * width;
  f[SideWaste] = 10.0 * side * height / room;
  f[HeightWaste] = 10.0 * policy.heights.waste(rules.size_z - me.z2) * area / room;
  f[Contact] = contact / (2.0 * (width + depth) * height);
  f[Flush] = static_cast<double>(s.flush) / (2.0 * (width + depth));
  f[Support] = pose.support;
  f[Footprint] = 10.0 * area / floor;
  f[Touch] = (contact + pose.support * area) / (2.0 * (area + (width + depth) * height));
  for (const int gap : s.gap) f[Sliver] += gap > kTouch && gap < rules.min_side ? 1.0 : 0.0;
  if (!rules.has_walls) {
    f[Tipping] = see_tipping(layout, me);
    f[Loose] = see_loose(layout, me);
    f[Exposed] = 10.0 * static_cast<double>(layout.left_exposed(me)) / floor;
  }
  return f;
}

double cost(const Layout& layout, const Policy& policy, const Piece& piece, const CandidatePose& pose) {
  const Features f = see(layout, policy, piece, pose);
  return std::inner_product(f.begin(), f.end(), policy.weights.begin(), 0.0);
}

}  // namespace snug::packing::internal
