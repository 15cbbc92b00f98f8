// Item, Orientation: turning standing boxes in their heads, without trigonometry.
#include "snug/packing/item.hpp"

#include <cmath>
#include <numbers>

#include "snug/core/input_error.hpp"

namespace snug::packing {

namespace {

/// Each entry to -1, 0 or 1: standing rotations are exact.
Matrix3 rounded(const Matrix3& R) {
  return R.unaryExpr([](double v) { return std::round(v); });
}

}  // namespace

Matrix3 rotation(const Orientation& orientation) {
  const double yaw = orientation.yaw_quarter * std::numbers::pi / 2.0;
  return rounded(model::standing_rotation(orientation.up, orientation.up_sign, yaw));
}

Vector3 extents(const Orientation& orientation, const Vector3& size) { return rotation(orientation).cwiseAbs() * size; }

Orientation nearest_orientation(const Matrix3& R_TP) {
  Orientation best;
  double best_trace = -4.0;
  for (const model::UpAxis up : {model::UpAxis::X, model::UpAxis::Y, model::UpAxis::Z}) {
    for (const int sign : {1, -1}) {
      for (int yaw = 0; yaw < 4; ++yaw) {
        const Orientation candidate{up, sign, yaw};
        const double trace = (rotation(candidate).transpose() * R_TP).trace();
        if (trace > best_trace + 1e-12) {
          best_trace = trace;
          best = candidate;
        }
      }
    }
  }
  return best;
}

int count_flips(const Orientation& from, const Orientation& to) {
  if (from.up != to.up) return 1;
  return from.up_sign == to.up_sign ? 0 : 2;
}

std::vector<Orientation> allowed_orientations(const Item& item, int max_flips, bool all_yaws) {
  std::vector<Orientation> all;
  for (const model::UpAxis up : {model::UpAxis::Z, model::UpAxis::X, model::UpAxis::Y}) {
    for (const int sign : {1, -1}) {
      if (item.upright_only && (up != model::UpAxis::Z || sign != 1)) continue;
      for (int yaw = 0; yaw < (all_yaws ? 4 : 2); ++yaw) {
        const Orientation candidate{up, sign, yaw};
        if (count_flips(item.arrival, candidate) <= max_flips) all.push_back(candidate);
      }
    }
  }
  return all;
}

Item make_item(const model::Scenario& scenario, const model::Item& item) {
  const model::Parcel* parcel = model::find_parcel(scenario, item.parcel);
  if (parcel == nullptr)
    throw InputError(scenario.source_name, "parcel", item.parcel, "the id of a parcel of the scenario");
  Item made;
  made.id = parcel->id;
  made.type = parcel->type;
  made.size = parcel->size;
  made.mass = parcel->inertia.mass;
  made.com = parcel->inertia.com;
  made.upright_only = parcel->handling.upright_only;
  made.no_stack = parcel->handling.no_stack;
  made.max_load = parcel->handling.max_load;
  made.arrival = {item.up, item.up_sign, 0};
  if (item.yaw) {
    const double quarters = std::round(*item.yaw / (std::numbers::pi / 2.0));
    made.arrival.yaw_quarter = ((static_cast<int>(quarters) % 4) + 4) % 4;
  }
  return made;
}

std::vector<Item> make_items(const model::Scenario& scenario, const model::Sequence& sequence) {
  std::vector<Item> items;
  items.reserve(sequence.items.size());
  for (const model::Item& item : sequence.items) items.push_back(make_item(scenario, item));
  return items;
}

}  // namespace snug::packing
