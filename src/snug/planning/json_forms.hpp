// JsonForm of what beliefs, plans and events are made of.
#pragma once

#include <array>

#include "snug/geometry/bounds.hpp"
#include "snug/model/ids.hpp"
#include "snug/packing/placement.hpp"
#include "snug/planning/rehearsal.hpp"
#include "snug/spatial/json_forms.hpp"

namespace snug {

/// Place in the sequence, from 0; null: none.
template <>
struct JsonForm<model::ItemIndex> {
  [[nodiscard]] static JsonValue write(const model::ItemIndex& item) {
    return item.is_valid() ? write_json(item.value) : JsonValue{};
  }
  [[nodiscard]] static model::ItemIndex read(const JsonValue& value, const JsonReader& reader) {
    return value.is_null() ? model::ItemIndex() : model::ItemIndex(reader.as<int>());
  }
};

template <>
struct JsonForm<model::ParcelId> {
  [[nodiscard]] static JsonValue write(const model::ParcelId& id) { return {id.value}; }
  [[nodiscard]] static model::ParcelId read(const JsonValue& /*value*/, const JsonReader& reader) {
    return model::ParcelId(reader.as<std::string>());
  }
};

/// Axis that is up, its sign, quarter turns: [2, 1, 0].
template <>
struct JsonForm<packing::Orientation> {
  [[nodiscard]] static JsonValue write(const packing::Orientation& one) {
    return write_json(std::vector<int>{static_cast<int>(one.up), one.up_sign, one.yaw_quarter});
  }
  [[nodiscard]] static packing::Orientation read(const JsonValue& /*value*/, const JsonReader& reader) {
    const auto numbers = reader.as<std::vector<int>>();
    if (numbers.size() != 3 || numbers[0] < 0 || numbers[0] > 2 || (numbers[1] != 1 && numbers[1] != -1) ||
        numbers[2] < 0 || numbers[2] > 3) {
      reader.fail("[axis 0 .. 2, sign 1 or -1, quarter turns 0 .. 3]");
    }
    return {static_cast<model::UpAxis>(numbers[0]), numbers[1], numbers[2]};
  }
};

template <>
struct JsonForm<packing::Placement> {
  struct Fields {
    packing::Placement one;
    template <class Archive>
    void fields(Archive& a) {
      a("item", one.item);
      a("X_TP", one.X_TP);
      a("orientation", one.orientation);
      a("flips", one.flips);
    }
  };
  [[nodiscard]] static JsonValue write(const packing::Placement& one) { return write_json(Fields{one}); }
  [[nodiscard]] static packing::Placement read(const JsonValue& /*value*/, const JsonReader& reader) {
    return reader.as<Fields>().one;
  }
};

template <>
struct JsonForm<geometry::Aabb> {
  [[nodiscard]] static JsonValue write(const geometry::Aabb& one) {
    return write_json(std::vector<Vector3>{one.lower, one.upper});
  }
  [[nodiscard]] static geometry::Aabb read(const JsonValue& /*value*/, const JsonReader& reader) {
    const auto corners = reader.as<std::vector<Vector3>>();
    if (corners.size() != 2) reader.fail("[lower corner, upper corner]");
    return {corners[0], corners[1]};
  }
};

template <>
struct JsonForm<motion::IO> {
  [[nodiscard]] static JsonValue write(const motion::IO& io) {
    return write_json(
        std::vector<int>{io.vacuum, io.blow_off, io.conveyor_cw, io.conveyor_ccw, io.optitrack, io.reserved});
  }
  [[nodiscard]] static motion::IO read(const JsonValue& /*value*/, const JsonReader& reader) {
    const auto on = reader.as<std::vector<int>>();
    if (on.size() != 6) reader.fail("six switches, 0 or 1");
    return {on[0] != 0, on[1] != 0, on[2] != 0, on[3] != 0, on[4] != 0, on[5] != 0};
  }
};

/// {"kind": "fast", "tempo": 1.0}; the tempo counts with fast alone.
template <>
struct JsonForm<motion::Tracking> {
  struct Fields {
    std::string kind;
    double tempo = 1.0;
    template <class Archive>
    void fields(Archive& a) {
      a("kind", kind);
      a("tempo", tempo);
    }
  };
  [[nodiscard]] static JsonValue write(const motion::Tracking& one) {
    return write_json(Fields{motion::name_of(one), motion::tempo_of(one)});
  }
  [[nodiscard]] static motion::Tracking read(const JsonValue& /*value*/, const JsonReader& reader) {
    const auto fields = reader.as<Fields>();
    if (fields.tempo < 0.1 || fields.tempo > 1.0) reader.fail("a tempo of 0.1 .. 1");
    motion::Tracking tracking = motion::tracking_of(fields.kind, reader.where());
    if (auto* fast = std::get_if<motion::FastTracking>(&tracking)) fast->tempo = fields.tempo;
    return tracking;
  }
};

template <>
struct JsonEnum<skills::InsertionSkill> {
  static constexpr std::array all{skills::InsertionSkill::TopDown, skills::InsertionSkill::SlideToContact,
                                  skills::InsertionSkill::Tilted, skills::InsertionSkill::SlideOnSupport};
};

template <>
struct JsonEnum<skills::Reorientation> {
  static constexpr std::array all{skills::Reorientation::None, skills::Reorientation::SideGrasp,
                                  skills::Reorientation::Regrasp, skills::Reorientation::Pivot};
};

template <>
struct JsonEnum<planning::AttemptFailure> {
  using F = planning::AttemptFailure;
  static constexpr std::array all{F::None,       F::Grasp,       F::OutOfReach,    F::Rollout,
                                  F::HoldMargin, F::Gone,        F::SticksOut,     F::OffPlace,
                                  F::Tilted,     F::OthersMoved, F::OthersCameOut, F::SentBefore};
};

}  // namespace snug
