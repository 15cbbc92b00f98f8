// FutureModel: which kinds of items come how often.
#include <algorithm>

#include "snug/packing/agent.hpp"

namespace snug::packing {

FutureModel make_future_model(const model::Scenario& scenario) {
  FutureModel future;
  for (const model::Parcel& parcel : scenario.parcels) {
    model::Item item;
    item.parcel = parcel.id;
    future.kinds.push_back(make_item(scenario, item));
    future.weights.push_back(1.0);
  }
  return future;
}

FutureModel learn_future_model(std::span<const Item> items) {
  FutureModel future;
  const auto same = [](const Item& a, const Item& b) {
    return a.size == b.size && a.upright_only == b.upright_only && a.no_stack == b.no_stack && a.max_load == b.max_load;
  };
  for (const Item& item : items) {
    const auto known =
        std::find_if(future.kinds.begin(), future.kinds.end(), [&](const Item& k) { return same(k, item); });
    if (known == future.kinds.end()) {
      future.kinds.push_back(item);
      future.weights.push_back(1.0);
    } else {
      future.weights[static_cast<std::size_t>(known - future.kinds.begin())] += 1.0;
    }
  }
  return future;
}

}  // namespace snug::packing
