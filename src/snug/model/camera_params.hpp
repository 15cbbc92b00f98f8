// CameraParams: a depth camera over the cell, and its errors in the terms in which makers state them.
#pragma once

#include <string>
#include <vector>

#include "snug/core/field.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::model {

/// Pinhole without distortion (frames of makers' software are rectified). Pixel centres lie at whole numbers: a point
/// (x, y, z) in C is seen at column cx + fx x / z and row cy + fy y / z.
struct CameraIntrinsics {
  double fx = 902.0;  ///< px
  double fy = 902.0;  ///< px
  double cx = 485.5;  ///< px
  double cy = 299.5;  ///< px

  template <class Archive>
  void fields(Archive& a) {
    a("fx", fx, Range::Positive);
    a("fy", fy, Range::Positive);
    a("cx", cx, Range::Any);
    a("cy", cy, Range::Any);
  }
  bool operator==(const CameraIntrinsics&) const = default;
};

/// Distances along the optical axis, m.
struct CameraRange {
  double near = 0.3;   ///< nothing is seen nearer
  double far = 1.5;    ///< nor farther
  double focus = 0.9;  ///< to which the stated errors refer, and about which scale errors are zero

  template <class Archive>
  void fields(Archive& a) {
    a("near", near, Range::Positive);
    a("far", far, Range::Positive);
    a("focus", focus, Range::Positive);
  }
  bool operator==(const CameraRange&) const = default;
};

/// Noise of one point along the optical axis: another one in each frame.
struct PointNoise {
  double precision = 0.0;    ///< m at the focus, standard deviation; grows with the square of the distance
  double correlation = 0.0;  ///< px, standard deviation of the Gaussian that makes neighbours alike; 0: independent

  template <class Archive>
  void fields(Archive& a) {
    a("precision", precision, Range::NotNegative);
    a("correlation", correlation, Range::NotNegative);
  }
  bool operator==(const PointNoise&) const = default;
};

/// Smooth errors along the optical axis: a plane is seen wavy. Distances are between knots of a cubic spline.
struct Planarity {
  double local = 0.0;            ///< m, standard deviation of waves that are others in each frame
  double local_length = 12.0;    ///< px
  double global = 0.0;           ///< m, standard deviation of waves that belong to the camera
  double global_length = 180.0;  ///< px

  template <class Archive>
  void fields(Archive& a) {
    a("local", local, Range::NotNegative);
    a("local_length", local_length, Range::Positive);
    a("global", global, Range::NotNegative);
    a("global_length", global_length, Range::Positive);
  }
  bool operator==(const Planarity&) const = default;
};

/// What stays the same for one camera, drawn once: standard deviations.
struct Trueness {
  double dimension = 0.0;  ///< of lengths, as a fraction
  double position = 0.0;   ///< m, of the whole cloud, each coordinate

  template <class Archive>
  void fields(Archive& a) {
    a("dimension", dimension, Range::NotNegative);
    a("position", position, Range::NotNegative);
  }
  bool operator==(const Trueness&) const = default;
};

/// Points that are missing.
struct PointLoss {
  double random = 0.0;          ///< probability of any point
  double edge = 0.0;            ///< probability of a point at an edge of depth; falls with exp(-(d / width)^2)
  double edge_width = 1.0;      ///< px
  double grazing_onset = 1.31;  ///< rad, angle between ray and surface normal from which points are lost
  double grazing_full = 1.5;    ///< rad, at which all are

  template <class Archive>
  void fields(Archive& a) {
    a("random", random, Range::Fraction);
    a("edge", edge, Range::Fraction);
    a("edge_width", edge_width, Range::Positive);
    a("grazing_onset_deg", Degrees{grazing_onset}, Range::NotNegative);
    a("grazing_full_deg", Degrees{grazing_full}, Range::NotNegative);
  }
  bool operator==(const PointLoss&) const = default;
};

/// Of two surfaces at different depths beside each other, a point between them.
struct MixedPixels {
  double probability = 0.0;  ///< of a point beside an edge of depth that is not lost

  template <class Archive>
  void fields(Archive& a) {
    a("probability", probability, Range::Fraction);
  }
  bool operator==(const MixedPixels&) const = default;
};

/// Light between the surfaces of a corner bends them toward each other: points of both move toward the camera.
struct Interreflection {
  double bias = 0.0;     ///< m, in the corner itself, along the surface's normal
  double reach = 0.015;  ///< m, distance from the corner in which it falls to 1/e

  template <class Archive>
  void fields(Archive& a) {
    a("bias", bias, Range::NotNegative);
    a("reach", reach, Range::Positive);
  }
  bool operator==(const Interreflection&) const = default;
};

/// How far the camera may be from where the scenario says: standard deviations, each coordinate, drawn once.
struct HandEye {
  double position = 0.0;  ///< m
  double rotation = 0.0;  ///< rad, about the camera's own axes

  template <class Archive>
  void fields(Archive& a) {
    a("position", position, Range::NotNegative);
    a("rotation_deg", Degrees{rotation}, Range::NotNegative);
  }
  bool operator==(const HandEye&) const = default;
};

struct CameraErrors {
  PointNoise noise;
  Planarity planarity;
  Trueness trueness;
  PointLoss loss;
  MixedPixels mixed_pixels;
  Interreflection interreflection;
  HandEye hand_eye;

  template <class Archive>
  void fields(Archive& a) {
    a("noise", noise);
    a("planarity", planarity);
    a("trueness", trueness);
    a("loss", loss);
    a("mixed_pixels", mixed_pixels);
    a("interreflection", interreflection);
    a("hand_eye", hand_eye);
  }
  bool operator==(const CameraErrors&) const = default;
};

/// Frame C: z along the optical axis into the scene, x along rows to the right, y along columns downward.
struct CameraParams {
  std::string name;
  Pose X_WC;         ///< as the cell's calibration says; the true one differs by `hand_eye` and `trueness.position`
  int width = 972;   ///< px
  int height = 600;  ///< px
  CameraIntrinsics intrinsics;
  CameraRange range;
  Vector3 p_CL = Vector3::Zero();  ///< m, of the projector: what it does not light is not seen; zero: no projector
  CameraErrors errors;

  template <class Archive>
  void fields(Archive& a) {
    a("intrinsics", intrinsics);
    a("working_range", range);
    errors.fields(a);
  }
  bool operator==(const CameraParams&) const = default;
};

/// "structured_light" (the class of the demonstrator's camera), "active_stereo" (cheaper), "ideal".
[[nodiscard]] std::vector<std::string> camera_presets();
/// A camera of that kind, in the world's origin. There must be such a preset.
[[nodiscard]] CameraParams make_camera(const std::string& preset);

}  // namespace snug::model
