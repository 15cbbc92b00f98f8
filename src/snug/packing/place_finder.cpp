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
                                                  const internal::CandidatePose& pose) const {
    const auto& ways = choice.orientations[static_cast<std::size_t>(pose.orientation)];
    const Orientation way = *std::ranges::min_element(
        ways, {}, [&](const Orientation& orientation) { return count_flips(item.arrival, orientation); });
    if (!is_balanced(item, choice, pose, way)) return tl::unexpected(NoPlace::NoStablePlace);
    Place place;
    place.orientation = way;
    place.flips = count_flips(item.arrival, way);
    place.extents = extents(way, item.size);
    const double half = 0.5 * planning.planned_interference;
    place.low_T = Vector3(pose.x / internal::kTicksPerMetre - 0.5 * planning.inner_size.x() - half,
                          pose.y / internal::kTicksPerMetre - 0.5 * planning.inner_size.y() - half,
                          pose.z / internal::kTicksPerMetre);
    place.support = pose.support;
    return place;
  }

  /// Candidate poses were found with the centre of mass in the middle.
  [[nodiscard]] bool is_balanced(const Item& item, const internal::Choice& choice, const internal::CandidatePose& pose,
                                 const Orientation& way) const {
    if (pose.z == 0 || planning.settings.min_support <= 0.0 || item.com.isZero()) return true;
    const Vector3 com_T = rotation(way) * item.com;
    const int com_x = internal::to_ticks(com_T.x()), com_y = internal::to_ticks(com_T.y());
    if (com_x == 0 && com_y == 0) return true;
    internal::Piece piece = choice.piece;
    internal::PieceOrientation& standing = piece.orientations[static_cast<std::size_t>(pose.orientation)];
    standing.com_x = com_x;
    standing.com_y = com_y;
    internal::CandidatePose settled;
    return layout.settle(piece, pose.orientation, pose.x, pose.y, settled) == internal::Refusal::None;
  }

  internal::Planning planning;
  internal::Layout layout;
  internal::CandidatePoseList list;
};

Pose pose_at(const Place& place) { return {rotation(place.orientation), place.low_T + 0.5 * place.extents}; }

PlaceFinder::PlaceFinder(const ContainerState& container, const PackingSettings& settings, std::span<const Item> kinds)
    : impl_(std::make_unique<Impl>(container, settings, kinds)) {
  reset(container.boxes, container.obstacles);
}
PlaceFinder::PlaceFinder(const PlaceFinder& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
PlaceFinder& PlaceFinder::operator=(const PlaceFinder& other) {
  *impl_ = *other.impl_;
  return *this;
}
PlaceFinder::PlaceFinder(PlaceFinder&&) noexcept = default;
PlaceFinder& PlaceFinder::operator=(PlaceFinder&&) noexcept = default;
PlaceFinder::~PlaceFinder() = default;

void PlaceFinder::reset(const std::vector<PlacedBox>& boxes, const std::vector<Extent>& obstacles) {
  ContainerState state;
  state.inner_size = impl_->planning.inner_size;
  state.boxes = boxes;
  state.obstacles = obstacles;
  impl_->layout = internal::to_layout(impl_->planning, impl_->layout.rules(), state);
}

void PlaceFinder::add(const PlacedBox& box) { impl_->layout.add(internal::to_block(impl_->planning, box)); }

Expected<std::vector<Place>, NoPlace> PlaceFinder::find(const Item& item, int most) {
  const internal::Choice choice = internal::make_choice(impl_->planning, item);
  if (const auto no = internal::refuse(impl_->planning, item, choice)) return tl::unexpected(*no);
  internal::Refusal worst = internal::Refusal::None;
  impl_->layout.find_poses(choice.piece, impl_->list, &worst);
  std::vector<internal::CandidatePose>& poses = impl_->list.poses;
  if (poses.empty()) return tl::unexpected(reason_for(worst));
  std::ranges::sort(poses, {},
                    [](const internal::CandidatePose& s) { return std::tuple(s.z, s.x, s.y, s.orientation); });
  std::vector<Place> places;
  for (const internal::CandidatePose& pose : poses) {
    if (static_cast<int>(places.size()) >= most) break;
    if (const auto place = impl_->place_at(item, choice, pose)) places.push_back(*place);
  }
  if (places.empty()) return tl::unexpected(NoPlace::NoStablePlace);
  return places;
}

Expected<Place, NoPlace> PlaceFinder::lower(const Item& item, const Orientation& orientation, double x, double y) {
  internal::Choice choice = internal::make_choice(impl_->planning, item);
  if (const auto no = internal::refuse(impl_->planning, item, choice)) return tl::unexpected(*no);
  for (std::size_t i = 0; i < choice.orientations.size(); ++i) {
    if (std::ranges::find(choice.orientations[i], orientation) == choice.orientations[i].end()) continue;
    const internal::PieceOrientation& standing = choice.piece.orientations[i];
    const internal::Planning& planning = impl_->planning;
    internal::CandidatePose pose;
    const internal::Refusal refusal = impl_->layout.settle(
        choice.piece, static_cast<int>(i), internal::to_ticks(x + 0.5 * planning.inner_size.x()) - standing.width / 2,
        internal::to_ticks(y + 0.5 * planning.inner_size.y()) - standing.depth / 2, pose);
    if (refusal != internal::Refusal::None) return tl::unexpected(reason_for(refusal));
    choice.orientations[i] = {orientation};
    return impl_->place_at(item, choice, pose);
  }
  return tl::unexpected(NoPlace::NotPickable);
}

}  // namespace snug::packing
