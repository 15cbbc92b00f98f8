// Perception: from what there is to what is seen of it: exact, noisy, or nothing at all, behind one interface.
#include "snug/perception/perception.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"

namespace snug::perception {
namespace {

constexpr std::array kKinds{Kind::Exact, Kind::Noisy, Kind::DeadReckoning, Kind::Camera, Kind::Frames};

/// Fills `not_seen` with what was expected and is not in `seen`.
Observation finished(Observation observation, std::span<const Expectation> expected) {
  for (const Expectation& one : expected) {
    if (find(observation, one.item) == nullptr) observation.not_seen.push_back(one.item);
  }
  return observation;
}

/// The same of a sensor that nothing is hidden from: what it does not see is not there.
Observation finished_by_all_seeing(Observation observation, std::span<const Expectation> expected) {
  observation = finished(std::move(observation), expected);
  observation.missing = observation.not_seen;
  return observation;
}

/// Of a sensor that nothing is hidden from.
Obstacle obstacle_of(const Pose& X_WP, const Vector3& size, double deviation) {
  return {columns_of_box(X_WP, size), deviation};
}

class Exact final : public Perception {
 public:
  [[nodiscard]] std::string_view name() const override { return name_of(Kind::Exact); }
  [[nodiscard]] Observation perceive(const Scene& scene, std::span<const Expectation> expected) override {
    Observation observation;
    observation.time = scene.time;
    for (const SceneBox& box : scene.boxes) {
      observation.seen.push_back({box.item, box.X_WP, Matrix6::Zero(), box.size, 0.0});
    }
    observation.obstacles.emplace();
    for (const SceneBox& object : scene.objects) {
      observation.obstacles->push_back(obstacle_of(object.X_WP, object.size, 0.0));
    }
    return finished_by_all_seeing(std::move(observation), expected);
  }
};

class Noisy final : public Perception {
 public:
  Noisy(std::uint64_t seed, const NoiseLevels& noise) : rng_(Rng(seed).split("perception")), noise_(noise) {
    const auto variance = [](double half_width) { return half_width * half_width / 3.0; };  // of a uniform draw
    covariance_.diagonal() << Vector3::Constant(variance(noise.position)), Vector3::Constant(variance(noise.rotation));
  }
  [[nodiscard]] std::string_view name() const override { return name_of(Kind::Noisy); }
  [[nodiscard]] Observation perceive(const Scene& scene, std::span<const Expectation> expected) override {
    Observation observation;
    observation.time = scene.time;
    for (const SceneBox& box : scene.boxes) {
      const SceneBox drawn = draw(box);
      observation.seen.push_back({box.item, drawn.X_WP, covariance_, drawn.size, noise_.size / std::sqrt(3.0)});
    }
    observation.obstacles.emplace();
    for (const SceneBox& object : scene.objects) {
      const SceneBox drawn = draw(object);
      observation.obstacles->push_back(obstacle_of(drawn.X_WP, drawn.size, noise_.position / std::sqrt(3.0)));
    }
    return finished_by_all_seeing(std::move(observation), expected);
  }

 private:
  SceneBox draw(const SceneBox& box) {
    const Vector3 shift = draw(noise_.position), turn = draw(noise_.rotation), size = box.size + draw(noise_.size);
    return {box.item, {exp_rotation(turn) * box.X_WP.R, box.X_WP.p + shift}, size};
  }
  Vector3 draw(double half_width) {
    const double x = rng_.uniform(-half_width, half_width), y = rng_.uniform(-half_width, half_width);
    return {x, y, rng_.uniform(-half_width, half_width)};
  }

  Rng rng_;
  NoiseLevels noise_;
  Matrix6 covariance_ = Matrix6::Zero();
};

class DeadReckoning final : public Perception {
 public:
  [[nodiscard]] std::string_view name() const override { return name_of(Kind::DeadReckoning); }
  [[nodiscard]] Observation perceive(const Scene& scene, std::span<const Expectation> expected) override {
    Observation observation;
    observation.time = scene.time;
    return finished(std::move(observation), expected);
  }
};

}  // namespace

const PoseEstimate* find(const Observation& observation, const std::string& item) {
  const auto found = std::ranges::find(observation.seen, item, &PoseEstimate::item);
  return found == observation.seen.end() ? nullptr : &*found;
}

const char* name_of(LookFault fault) {
  switch (fault) {
    case LookFault::None:
      return "none";
    case LookFault::TooFewPoints:
      return "too few points";
    case LookFault::ViewBlocked:
      return "view blocked";
    case LookFault::NoFrame:
      return "no frame";
  }
  return "";
}

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::Exact:
      return "exact";
    case Kind::Noisy:
      return "noisy";
    case Kind::DeadReckoning:
      return "dead-reckoning";
    case Kind::Camera:
      return "camera";
    case Kind::Frames:
      return "frames";
  }
  return "";
}

Kind kind_of(std::string_view word) {
  for (const Kind kind : kKinds) {
    if (word == name_of(kind)) return kind;
  }
  throw InputError("command line", "--perception", "'" + std::string(word) + "'",
                   "exact, noisy, dead-reckoning, camera or frames");
}

std::unique_ptr<Perception> make_perception(Kind kind, std::uint64_t seed, const NoiseLevels& noise) {
  SNUG_CHECK(kind != Kind::Camera && kind != Kind::Frames, "a camera has to know the cell that it looks into");
  if (kind == Kind::Noisy) return std::make_unique<Noisy>(seed, noise);
  if (kind == Kind::DeadReckoning) return std::make_unique<DeadReckoning>();
  return std::make_unique<Exact>();
}

}  // namespace snug::perception
