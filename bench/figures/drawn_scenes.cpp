// Drawn scenes: piles of dropped boxes and random drops of all kinds of bodies, written as scenario files are.
#include "bench/figures/drawn_scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "snug/core/rng.hpp"

namespace snug::bench {
namespace {

std::string head(const char* name, double time_step, double friction, double restitution) {
  return fmt::format(
      "name: {}\ntime_step: {}\nmaterials: [{{name: m}}]\ncontacts: {{default: {{friction: {}, restitution: {}}}}}\n",
      name, time_step, friction, restitution);
}

std::string tote(double width, double height) {
  return fmt::format(
      "containers:\n- {{name: tote, inner_size: [{0}, {0}, {1}], material: m, wall_thickness: 0.1, "
      "floor_thickness: 0.1}}\nbodies:\n",
      width, height);
}

std::string drawn_vector(Rng& rng, double low, double high) {
  const double x = rng.uniform(low, high), y = rng.uniform(low, high), z = rng.uniform(low, high);
  return fmt::format("[{}, {}, {}]", x, y, z);
}

/// Points of an ellipsoid, some of them inside the hull of the others.
std::string drawn_hull(Rng& rng) {
  const double x = rng.uniform(0.03, 0.12), y = rng.uniform(0.03, 0.12), z = rng.uniform(0.03, 0.12);
  std::string points;
  for (int i = 6 + rng.index(18); i > 0; --i) {
    Vector3 p;
    for (const int axis : {2, 1, 0}) p[axis] = rng.normal();
    p = (p.normalized() * std::cbrt(rng.uniform(0.3, 1.0))).cwiseProduct(Vector3(x, y, z));
    points += fmt::format("{}[{}, {}, {}]", points.empty() ? "" : ", ", p.x(), p.y(), p.z());
  }
  return fmt::format("shapes: [{{hull: [{}]}}]", points);
}

std::string drawn_shape(Rng& rng) {
  const int kind = rng.index(5);
  if (kind < 2) return "size: " + drawn_vector(rng, 0.03, 0.16);
  if (kind < 4) return drawn_hull(rng);
  const double radius = rng.uniform(0.02, 0.06), length = rng.uniform(0.02, 0.15);
  return fmt::format("shapes: [{{capsule: {{radius: {}, length: {}}}}}]", radius, length);
}

}  // namespace

model::Scenario drawn_pile(const Pile& pile) {
  constexpr double kSpread = 0.28, kLayer = 0.26, kDensity = 300.0;  // m, m, kg/m^3
  Rng rng = Rng(pile.seed).split("pile");
  const int layer_size = pile.side * pile.side;
  const int layers = (pile.count + layer_size - 1) / layer_size;
  std::string text = head("pile", 0.002, 0.4, 0.1) + tote(pile.side * kSpread + 0.06, layers * kLayer + 1.0);
  for (int i = 0; i < pile.count; ++i) {
    const double sx = rng.uniform(0.09, 0.16), sy = rng.uniform(0.09, 0.16), sz = rng.uniform(0.09, 0.16);
    const int place = i % layer_size;
    const double middle = 0.5 * (pile.side - 1);
    const double x = (place / pile.side - middle) * kSpread + rng.uniform(-0.02, 0.02);
    const double y = (place % pile.side - middle) * kSpread + rng.uniform(-0.02, 0.02);
    const double z = 0.13 + kLayer * (i / layer_size);
    text += fmt::format("- {{name: o{}, size: [{}, {}, {}], material: m, mass: {}, pose: {{position: [{}, {}, {}], ", i,
                        sx, sy, sz, kDensity * sx * sy * sz, x, y, z);
    text += "rpy_deg: " + drawn_vector(rng, -15.0, 15.0) + "}}\n";
  }
  return model::parse_scenario(text, fmt::format("pile of {} boxes, seed {}", pile.count, pile.seed));
}

model::Scenario drawn_drop(const RandomDrop& drop) {
  constexpr double kLayer = 0.36, kLightest = 0.01;  // m, kg
  Rng rng = Rng(drop.seed).split("random drop");
  const int count = 5 + rng.index(36);
  const double friction = rng.uniform(0.1, 0.8), restitution = 0.3 * rng.index(2), width = rng.uniform(0.7, 1.0);
  std::string text = head("drop", drop.time_step, friction, restitution) + tote(width, (count / 4 + 2) * kLayer + 1.0);
  for (int i = 0; i < count; ++i) {
    const double x = width * (i % 2 == 0 ? -0.25 : 0.25), y = width * (i % 4 < 2 ? -0.25 : 0.25);
    const double mass = kLightest * std::exp(rng.uniform(0.0, std::log(drop.mass_ratio)));
    text += fmt::format("- {{name: o{}, material: m, mass: {}, pose: {{position: [{}, {}, {}], ", i, mass, x, y,
                        0.25 + kLayer * (i / 4));
    text += "rpy_deg: " + drawn_vector(rng, -180.0, 180.0) + "}, ";
    const std::string linear = drawn_vector(rng, -1.0, 1.0);  // one after the other, whichever the compiler makes first
    text += "twist: {linear: " + linear + ", angular: " + drawn_vector(rng, -6.0, 6.0) + "}, ";
    text += drawn_shape(rng) + "}\n";
  }
  return model::parse_scenario(text, fmt::format("random drop, seed {}", drop.seed));
}

}  // namespace snug::bench
