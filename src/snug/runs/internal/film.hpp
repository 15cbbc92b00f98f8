// Film: stretch film around a load, as hoops under tension that carry shear between each other.
#pragma once

#include <span>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::runs::internal {

/// All layers together, each per metre of height or of length (docs/decisions/0129). As it is: four layers of 23 um,
/// stretched to three times their length.
struct FilmParams {
  double tension = 350.0;          ///< N/m, around the load at rest
  double stretch_stiffness = 6e3;  ///< N/m, by which the tension grows for each part of its length that a hoop grows
  double shear_stiffness = 2.2e3;  ///< N/m: shear flow for a shear of one
};
/// Every layer adds as much as the one before.
[[nodiscard]] FilmParams film_of(int layers);

struct FilmBox {
  Vector3 size = Vector3::Zero();
  Vector3 p_Pcm = Vector3::Zero();
};

/// The load is cut into bands of equal height. In each the film runs around the convex hull of what stands there; it
/// pulls at the corners of that hull alone, since on a flat side it lies without pressing. Two bands that move past
/// each other shear the film between them, up to a shear flow as large as the tension: then it wrinkles. The lowest
/// band is tied to the pallet.
class Film {
 public:
  explicit Film(std::vector<FilmBox> boxes, const FilmParams& params = {});
  /// While it is wound around the load as it stands, with a part of its tension: the winder pays out what the load does
  /// not take up. Adds to each box what it does, as pull() does.
  void wind(std::span<const Pose> X_TP, double part, std::span<Wrench> wrenches_T) const;
  /// The load as it stands is wound: here the film has its tension and no shear.
  void wrap(std::span<const Pose> X_TP);
  /// Of a box that fell off: the film is not around it any more.
  void leave_out(std::size_t box);
  /// Adds to each box what the film does, about its centre of mass, in T.
  void pull(std::span<const Pose> X_TP, std::span<Wrench> wrenches_T) const;

 private:
  struct Corner {
    Vector3 p_TQ;
    std::size_t box;
  };
  struct Band {
    double length = 0.0;             ///< m, of the hoop at rest
    std::vector<std::size_t> outer;  ///< boxes that the film lies on
    Vector3 extent = Vector3::Zero();
  };

  [[nodiscard]] static double length_of(const std::vector<Corner>& hull);
  [[nodiscard]] std::vector<Corner> hull_at(double height, std::span<const Pose> X_TP) const;
  /// tension: N/m, of this hull.
  void pull_hoop(const std::vector<Corner>& hull, double tension, std::span<const Pose> X_TP,
                 std::span<Wrench> wrenches_T) const;
  void shear(std::span<const Pose> X_TP, std::span<Wrench> wrenches_T) const;
  void push(const Vector3& force, const Vector3& p_TQ, std::size_t box, std::span<const Pose> X_TP,
            std::span<Wrench> wrenches_T) const;

  std::vector<FilmBox> boxes_;
  FilmParams params_;
  std::vector<Pose> rest_;
  std::vector<Band> bands_;  ///< from below
};

}  // namespace snug::runs::internal
