// watched_boxes: a session in a cell that is elsewhere, scored by what an observer says of its boxes.
#include "snug/study/watched_boxes.hpp"

#include <memory>
#include <utility>

namespace snug::study {
namespace {

constexpr double kWhereItArrived = 0.05;  ///< m

class Watcher {
 public:
  Watcher(const model::Scenario& scenario, std::vector<std::string> items, BoxSource source)
      : container_(*model::find_container(scenario, scenario.target)),
        items_(std::move(items)),
        source_(std::move(source)) {}

  TruePoses poses() {
    const auto boxes = source_.boxes();
    TruePoses poses;
    arrived_.resize(boxes.size());
    has_left_.resize(boxes.size(), false);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const bool is_known = boxes[i].has_value() && source_.was_brought(i);
      poses.push_back(is_known ? std::optional<Pose>(boxes[i]->X_WP) : std::nullopt);
      if (!is_known) continue;
      if (!arrived_[i]) arrived_[i] = boxes[i]->X_WP.p;
      has_left_[i] = has_left_[i] || (boxes[i]->X_WP.p - *arrived_[i]).norm() > kWhereItArrived;
    }
    return poses;
  }

  std::vector<cell::BoxResult> boxes() {
    const TruePoses now = poses();
    std::vector<cell::BoxResult> results;
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (!source_.was_brought(i)) continue;
      cell::BoxResult box;
      box.id = items_[i];
      if (has_left_[i]) box.state = now[i] ? cell::BoxState::Dropped : cell::BoxState::Lost;
      if (now[i]) {
        box.X_TP = container_.X_WT.inverse() * *now[i];
        const cell::ContainerFit fit = cell::fit_in(container_.inner_size, source_.size_of(i), box.X_TP);
        if (fit.is_in) box.state = cell::BoxState::Packed;
      }
      results.push_back(std::move(box));
    }
    return results;
  }

  [[nodiscard]] Vector3 size_of(std::size_t item) const { return source_.size_of(item); }

 private:
  const model::Container& container_;
  std::vector<std::string> items_;
  BoxSource source_;
  std::vector<std::optional<Vector3>> arrived_;
  std::vector<bool> has_left_;
};

}  // namespace

Witness watch_boxes(const model::Scenario& scenario, const std::string& sequence, BoxSource source) {
  Witness witness;
  for (const model::Item& item : model::find_sequence(scenario, sequence)->items) {
    witness.items.push_back(item.parcel);
  }
  const auto watcher = std::make_shared<Watcher>(scenario, witness.items, std::move(source));
  witness.poses = [watcher] { return watcher->poses(); };
  witness.size_of = [watcher](std::size_t item) { return watcher->size_of(item); };
  witness.boxes = [watcher] { return watcher->boxes(); };
  return witness;
}

}  // namespace snug::study
