// merge_statics, name_bodies: what scenarios ask of bodies, and other simulators do not.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "snug/core/text.hpp"
#include "snug/geometry/bounds.hpp"
#include "snug/geometry/manifold.hpp"
#include "snug/scene_import/internal/raw_scene.hpp"

namespace snug::scene_import::internal {
namespace {

/// Statics of a scenario may overlap by 1 um (model/checks.cpp); less here, as poses are written with all their digits.
constexpr double kTouching = 5e-7;
constexpr std::size_t kMostPairs = 2'000'000;
constexpr std::size_t kLongestName = 60;

bool overlap(const RawShape& a, const Pose& X_WA, const RawShape& b, const Pose& X_WB) {
  const Pose X_WG = X_WA * a.placed.X_BG, X_WH = X_WB * b.placed.X_BG;
  if (!geometry::bounds(a.placed.shape, X_WG).overlaps(geometry::bounds(b.placed.shape, X_WH))) return false;
  geometry::PairCache cache;
  geometry::Manifold manifold;
  geometry::collide(a.placed.shape, X_WG, b.placed.shape, X_WH, 0.0, cache, manifold);
  for (int i = 0; i < manifold.count; ++i)
    if (-manifold.points[static_cast<std::size_t>(i)].phi > kTouching) return true;
  return false;
}

bool overlap(const RawBody& a, const RawBody& b, std::size_t& pairs) {
  for (const RawShape& one : a.shapes) {
    for (const RawShape& other : b.shapes) {
      if (++pairs > kMostPairs) return true;  // all in one: nothing is lost but names
      if (overlap(one, a.X_WB, other, b.X_WB)) return true;
    }
  }
  return false;
}

/// A body for each surface of its shapes: a body of a scenario has one material.
std::vector<RawBody> split_by_surface(const RawBody& body) {
  std::vector<RawBody> parts;
  for (const RawShape& shape : body.shapes) {
    auto part = std::find_if(parts.begin(), parts.end(),
                             [&](const RawBody& one) { return one.shapes.front().surface == shape.surface; });
    if (part == parts.end()) {
      parts.push_back(body);
      parts.back().shapes.clear();
      part = parts.end() - 1;
    }
    part->shapes.push_back(shape);
  }
  return parts;
}

double volume_of(const RawShape& shape) {
  const geometry::Aabb box = geometry::bounds(shape.placed.shape, Pose{});
  return (box.upper - box.lower).prod();
}

}  // namespace

void merge_statics(RawScene& scene) {
  std::vector<RawBody> statics, others;
  for (const RawBody& body : scene.bodies) {
    if (!body.is_static) {
      others.push_back(body);
      continue;
    }
    for (RawBody& part : split_by_surface(body)) statics.push_back(std::move(part));
  }
  std::vector<std::size_t> leader(statics.size());
  std::iota(leader.begin(), leader.end(), 0U);
  const auto lead = [&](std::size_t i) {
    while (leader[i] != i) i = leader[i];
    return i;
  };
  std::size_t pairs = 0;
  for (std::size_t j = 1; j < statics.size(); ++j)
    for (std::size_t i = 0; i < j; ++i)
      if (lead(i) != lead(j) && overlap(statics[i], statics[j], pairs))
        leader[std::max(lead(i), lead(j))] = std::min(lead(i), lead(j));
  std::vector<RawBody> merged;
  std::vector<std::size_t> place(statics.size());
  for (std::size_t i = 0; i < statics.size(); ++i) {
    if (lead(i) == i) {
      place[i] = merged.size();
      merged.push_back(statics[i]);
      continue;
    }
    RawBody& into = merged[place[lead(i)]];
    const Pose X = into.X_WB.inverse() * statics[i].X_WB;
    const bool is_same = into.shapes.front().surface == statics[i].shapes.front().surface;
    scene.remarks.add(statics[i].file, statics[i].line,
                      is_same ? "static bodies that overlap: one body"
                              : "static bodies that overlap and slide differently: one body, with the first's surface");
    for (const RawShape& shape : statics[i].shapes)
      into.shapes.push_back({{shape.placed.shape, X * shape.placed.X_BG}, into.shapes.front().surface});
  }
  scene.bodies = std::move(merged);
  for (RawBody& body : others) {
    if (body.shapes.empty()) {
      scene.remarks.add(body.file, body.line, "a body that moves and has no shape that touches: left out");
      continue;
    }
    // One material for a body that moves: that of its largest shape.
    const auto largest = std::max_element(body.shapes.begin(), body.shapes.end(),
                                          [](const auto& a, const auto& b) { return volume_of(a) < volume_of(b); });
    const Surface surface = largest->surface;
    for (RawShape& shape : body.shapes) {
      if (shape.surface != surface)
        scene.remarks.add(body.file, body.line, "a body whose shapes slide differently: all as its largest");
      shape.surface = surface;
    }
    scene.bodies.push_back(std::move(body));
  }
}

void name_bodies(RawScene& scene) {
  std::set<std::string> taken;
  for (RawBody& body : scene.bodies) {
    std::string name;
    for (const char c : body.name)
      if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) name += c;
    if (!is_printable(name) || name.size() > kLongestName) name = printable(name, kLongestName / 4);
    if (name.empty()) name = "body";
    const std::string first = name;
    for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{} ({})", first, i);
    body.name = name;
  }
}

}  // namespace snug::scene_import::internal
