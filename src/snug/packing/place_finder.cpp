// PlaceFinder: a Layout that is kept from item to item.
#include "snug/packing/place_finder.hpp"

#include <algorithm>
#include <tuple>

#include "snug/packing/internal/agents.hpp"

namespace snug::packing {
namespace {

NoPlace reason_for(internal::Refusal refusal) {
  return refusal == internal::Refusal::Outside ? NoPlace::NoSpace : internal::reason_of(refusal);
}

internal::Planning plan_for(const ContainerState& container, const PackingSettings& settings) {
  (void)make_agent("margin", {settings, {}, {}, {}});  // checks them
  return internal::plan_for_contact(container, settings);
}

}  // namespace

struct PlaceFinder::Impl {
  Impl(const ContainerState& container, const PackingSettings& settings, std::span<const Item> kinds)
      : planning(plan_for(container, settings)), layout(internal::make_rules(planning, kinds)) {}

  /// What stands somewhere in ticks, in metres; the orientation with the fewest flips that balances there.
  [[nodiscard]] Expected<Place, NoPlace> place_at(const Item& item, const internal::Choice& choice,
                                                  const internal::Spot& spot) const {
    const auto& ways = choice.orientations[static_cast<std::size_t>(spot.stance)];
    const Orientation way = *std::ranges::min_element(
        ways, {}, [&](const Orientation& orientation) { return count_flips(item.arrival, orientation); });
    if (!is_balanced(item, choice, spot, way)) return tl::unexpected(NoPlace::NoStablePlace);
    Place place;
    place.orientation = way;
    place.flips = count_flips(item.arrival, way);
    place.extents = extents(way, item.size);
    const double squeeze = 0.5 * planning.squeeze;
    place.low_T = Vector3(spot.x / internal::kTicksPerMetre - 0.5 * planning.inner_size.x() - squeeze,
                          spot.y / internal::kTicksPerMetre - 0.5 * planning.inner_size.y() - squeeze,
                          spot.z / internal::kTicksPerMetre);
    place.support = spot.support;
    return place;
  }

  /// Spots were found with the centre of mass in the middle.
  [[nodiscard]] bool is_balanced(const Item& item, const internal::Choice& choice, const internal::Spot& spot,
                                 const Orientation& way) const {
    if (spot.z == 0 || planning.settings.min_support <= 0.0 || item.com.isZero()) return true;
    const Vector3 com_T = rotation(way) * item.com;
    const int com_x = internal::to_ticks(com_T.x()), com_y = internal::to_ticks(com_T.y());
    if (com_x == 0 && com_y == 0) return true;
    internal::Piece piece = choice.piece;
    internal::Stance& stance = piece.stances[static_cast<std::size_t>(spot.stance)];
    stance.com_x = com_x;
    stance.com_y = com_y;
    internal::Spot settled;
    return layout.settle(piece, spot.stance, spot.x, spot.y, settled) == internal::Refusal::None;
  }

  internal::Planning planning;
  internal::Layout layout;
  internal::SpotList list;
};

Pose pose_at(const Place& place) { return {rotation(place.orientation), place.low_T + 0.5 * place.extents}; }

PlaceFinder::PlaceFinder(const ContainerState& container, const PackingSettings& settings, std::span<const Item> kinds)
    : impl_(std::make_unique<Impl>(container, settings, kinds)) {
  reset(container.boxes);
}
PlaceFinder::PlaceFinder(const PlaceFinder& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
PlaceFinder& PlaceFinder::operator=(const PlaceFinder& other) {
  *impl_ = *other.impl_;
  return *this;
}
PlaceFinder::PlaceFinder(PlaceFinder&&) noexcept = default;
PlaceFinder& PlaceFinder::operator=(PlaceFinder&&) noexcept = default;
PlaceFinder::~PlaceFinder() = default;

void PlaceFinder::reset(const std::vector<PlacedBox>& boxes) {
  ContainerState state;
  state.inner_size = impl_->planning.inner_size;
  state.boxes = boxes;
  impl_->layout = internal::to_layout(impl_->planning, impl_->layout.rules(), state);
}

void PlaceFinder::add(const PlacedBox& box) { impl_->layout.add(internal::to_block(impl_->planning, box)); }

Expected<std::vector<Place>, NoPlace> PlaceFinder::find(const Item& item, int most) {
  const internal::Choice choice = internal::make_choice(impl_->planning, item);
  if (const auto no = internal::refuse(impl_->planning, item, choice)) return tl::unexpected(*no);
  internal::Refusal worst = internal::Refusal::None;
  impl_->layout.find_spots(choice.piece, impl_->list, &worst);
  std::vector<internal::Spot>& spots = impl_->list.spots;
  if (spots.empty()) return tl::unexpected(reason_for(worst));
  std::ranges::sort(spots, {}, [](const internal::Spot& s) { return std::tuple(s.z, s.x, s.y, s.stance); });
  std::vector<Place> places;
  for (const internal::Spot& spot : spots) {
    if (static_cast<int>(places.size()) >= most) break;
    if (const auto place = impl_->place_at(item, choice, spot)) places.push_back(*place);
  }
  if (places.empty()) return tl::unexpected(NoPlace::NoStablePlace);
  return places;
}

Expected<Place, NoPlace> PlaceFinder::lower(const Item& item, const Orientation& orientation, double x, double y) {
  internal::Choice choice = internal::make_choice(impl_->planning, item);
  if (const auto no = internal::refuse(impl_->planning, item, choice)) return tl::unexpected(*no);
  for (std::size_t i = 0; i < choice.orientations.size(); ++i) {
    if (std::ranges::find(choice.orientations[i], orientation) == choice.orientations[i].end()) continue;
    const internal::Stance& stance = choice.piece.stances[i];
    const internal::Planning& planning = impl_->planning;
    internal::Spot spot;
    const internal::Refusal refusal = impl_->layout.settle(
        choice.piece, static_cast<int>(i), internal::to_ticks(x + 0.5 * planning.inner_size.x()) - stance.width / 2,
        internal::to_ticks(y + 0.5 * planning.inner_size.y()) - stance.depth / 2, spot);
    if (refusal != internal::Refusal::None) return tl::unexpected(reason_for(refusal));
    choice.orientations[i] = {orientation};
    return impl_->place_at(item, choice, spot);
  }
  return tl::unexpected(NoPlace::NotPickable);
}

}  // namespace snug::packing
