// BoxObserver: where the boxes of a cell are that another program serves, for somebody who only looks.
#include "snug/remote_plant/box_observer.hpp"

#include "snug/click/joint_link.hpp"
#include "snug/click/names.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/csv.hpp"

namespace snug::remote_plant {

Vector3 sensed_size(const click::Sensor& sensed, const std::string& name, const Vector3& otherwise) {
  const auto found = sensed.objects.find(name);
  const auto* size = found == sensed.objects.end()
                         ? nullptr
                         : find_sensor(found->second, click::kSizeSensor, click::ValueType::Position);
  const bool is_good = size != nullptr && size->vector.allFinite() && size->vector.minCoeff() > 0.0;
  return is_good ? size->vector : otherwise;
}

std::optional<perception::SceneBox> sensed_box(const click::Sensor& sensed, const std::string& name,
                                               const std::string& item, const Vector3& size) {
  const auto found = sensed.objects.find(name);
  if (found == sensed.objects.end() || !is_active(found->second, click::kPresentSensor)) return std::nullopt;
  const std::optional<Pose> X_WP = click::sensed_pose(found->second);
  if (!X_WP) return std::nullopt;
  perception::SceneBox box;
  box.item = item;
  box.size = size;
  box.X_WP = *X_WP;
  return box;
}

BoxObserver::BoxObserver(const model::Scenario& scenario, const std::string& sequence, const std::string& endpoint,
                         double patience)
    : client_(click::Client::watcher(endpoint, patience)) {
  const auto refuse = [&](const std::string& why) {
    throw InputError("command line", "--observe", "'" + endpoint + "': " + why,
                     "an observer of the cell, as `snug serve --ur HOST --observers ADDRESS` has it");
  };
  const model::Sequence* items = model::find_sequence(scenario, sequence);
  if (items == nullptr) refuse("no sequence " + sequence);
  for (const model::Item& item : items->items) {
    const Vector3 size = model::collision_size(scenario, *model::find_parcel(scenario, item.parcel));
    items_.push_back({item.parcel, record::log_name(item.parcel), size});
  }
  const auto handshake = client_.shake_hands();
  if (!handshake) refuse(handshake.error());
  for (const Item& item : items_) {
    if (!handshake->objects.contains(item.name)) refuse("it has no object '" + item.name + "'");
  }
  if (const std::string trouble = look(); !trouble.empty()) refuse(trouble);
}

std::string BoxObserver::look() {
  const click::Client::Sensed sensed = client_.sense();
  if (!sensed) return sensed.error();
  last_ = **sensed;
  return {};
}

Vector3 BoxObserver::size_of(std::size_t item) const {
  return sensed_size(last_, items_[item].name, items_[item].size);
}

std::vector<std::optional<perception::SceneBox>> BoxObserver::boxes() const {
  std::vector<std::optional<perception::SceneBox>> boxes;
  for (std::size_t i = 0; i < items_.size(); ++i)
    boxes.push_back(sensed_box(last_, items_[i].name, items_[i].id, size_of(i)));
  return boxes;
}

}  // namespace snug::remote_plant
