// FutureModel: which kinds of items come how often.
#include "snug/packing/agent.hpp"

namespace snug::packing {

FutureModel make_future_model(const model::Scenario& scenario) { return make_future_model(scenario, scenario.parcels); }

FutureModel make_future_model(const model::Scenario& scenario, std::span<const model::Parcel> parcels) {
  FutureModel future;
  for (const model::Parcel& parcel : parcels) {
    model::Item item;
    item.parcel = parcel.id;
    future.kinds.push_back(make_item(scenario, item));
    future.weights.push_back(1.0);
  }
  future.comes_once = true;
  return future;
}

}  // namespace snug::packing
