// FutureModel: which kinds of items come how often.
#include <algorithm>
#include <iterator>
#include <string_view>
#include <unordered_set>
#include <vector>

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

FutureModel make_order_future(const model::Scenario& scenario, const model::Sequence& order) {
  std::unordered_set<std::string_view> wanted;
  for (const model::Item& item : order.items) wanted.insert(item.parcel);
  std::vector<model::Parcel> parcels;  // in the scenario's order: that of the sequence is not known
  std::ranges::copy_if(scenario.parcels, std::back_inserter(parcels),
                       [&](const model::Parcel& parcel) { return wanted.contains(parcel.id); });
  return make_future_model(scenario, parcels);
}

FutureModel make_catalogue_future(const model::Scenario& scenario) {
  FutureModel future = make_future_model(scenario);
  future.comes_once = false;
  return future;
}

}  // namespace snug::packing
