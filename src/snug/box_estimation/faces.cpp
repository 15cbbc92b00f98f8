// fit_faces: a plane through the points of each face that is seen.
#include <algorithm>
#include <array>
#include <cmath>

#include "snug/box_estimation/internal/features.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::box_estimation::internal {
namespace {

constexpr int kCells = 5;  // a side: the waves' covariance is summed over this many parts of a face

struct Sums {
  int face = -1;
  double count = 0.0;
  Vector3 e = Vector3::Zero();  // e, e s, e t
  Matrix3 G = Matrix3::Zero();  // of (1, s, t)
  double depth = 0.0;
  std::array<double, kCells * kCells> number{}, s{}, t{}, col{}, row{};
};

struct FaceFrame {
  Vector3 centre, u, v, n;  // in C
  double half_u = 0.0, half_v = 0.0;
};

FaceFrame frame_of(const TrackedBox& box, int face) {
  const int axis = face / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
  const double sign = face % 2 == 1 ? 1.0 : -1.0;
  FaceFrame f;
  f.n = sign * box.X_CP.R.col(axis);
  f.centre = box.X_CP.p + box.half(axis) * f.n;
  f.u = box.X_CP.R.col(a);
  f.v = box.X_CP.R.col(b);
  f.half_u = box.half(a);
  f.half_v = box.half(b);
  return f;
}

void add_point(Sums& sums, const FaceFrame& f, const Vector3& p, double e, int col, int row) {
  const double s = f.u.dot(p - f.centre), t = f.v.dot(p - f.centre);
  const Vector3 a(1.0, s, t);
  sums.count += 1.0;
  sums.e += e * a;
  sums.G += a * a.transpose();
  sums.depth += p.z();
  const auto cell = [](double x, double half) {
    return std::clamp(static_cast<int>((0.5 + 0.5 * x / half) * kCells), 0, kCells - 1);
  };
  const auto k = static_cast<std::size_t>(cell(s, f.half_u) * kCells + cell(t, f.half_v));
  sums.number[k] += 1.0;
  sums.s[k] += s;
  sums.t[k] += t;
  sums.col[k] += col;
  sums.row[k] += row;
}

/// Covariance of offset and tilts: points' own noise, and waves that neighbours share.
Matrix3 covariance_of(const Sums& sums, const FaceFrame& f, const Matrix3& inverse, double facing,
                      const FitContext& context) {
  const ErrorModel& errors = context.errors;
  const FaceSettings& settings = context.settings.faces;
  const double noise = errors.point_noise(sums.depth / sums.count) * facing;
  Matrix3 shared = Matrix3::Zero();
  for (std::size_t i = 0; i < sums.number.size(); ++i) {
    if (sums.number[i] == 0.0) continue;
    for (std::size_t j = 0; j < sums.number.size(); ++j) {
      if (sums.number[j] == 0.0) continue;
      const double covariance = errors.wave_covariance(sums.col[i] / sums.number[i] - sums.col[j] / sums.number[j],
                                                       sums.row[i] / sums.number[i] - sums.row[j] / sums.number[j]) *
                                facing * facing;
      shared += covariance * Vector3(sums.number[i], sums.s[i], sums.t[i]) *
                Vector3(sums.number[j], sums.s[j], sums.t[j]).transpose();
    }
  }
  Matrix3 result = noise * noise * errors.likeness() * inverse + inverse * shared * inverse;
  const bool is_side = facing < settings.side_facing;
  const double left =
      (is_side ? settings.side_bias_left : settings.bias_left) * context.frame.camera.errors.interreflection.bias;
  result(0, 0) += left * left + 1e-10;  // single precision
  result(1, 1) += 1e-10;
  result(2, 2) += 1e-10;
  if (is_side) {
    result(1, 1) += std::pow(2.0 * left / f.half_u, 2);
    result(2, 2) += std::pow(2.0 * left / f.half_v, 2);
  }
  return result;
}

/// For each surface, the offset within the wide gate around which most of its points lie: a belief is off by more than
/// what lies beside a box may be lower or higher.
std::vector<double> common_offsets(const camera::Frame& frame, const Prediction& prediction, double wide_gate) {
  constexpr double kBin = 1e-3;
  constexpr int kBinsOfWindow = 5;  // bins
  const camera::Cast& cast = prediction.cast;
  const auto bins = static_cast<std::size_t>(2.0 * wide_gate / kBin) + 1;
  std::vector<std::vector<int>> counts(cast.surfaces.size());
  for (int r = 0; r < prediction.range.rows(); r += 2)
    for (int c = 0; c < prediction.range.cols(); c += 2) {
      const std::int32_t s = cast.surface(r, c);
      const double depth = frame.depth(r + prediction.range.first_row, c + prediction.range.first_col);
      if (s < 0 || depth == 0.0) continue;
      const camera::Surface& surface = cast.surfaces[static_cast<std::size_t>(s)];
      if (surface.body < prediction.first_box) continue;
      const double e = surface.offset * (depth * cast.inverse_depth(r, c) - 1.0);
      if (std::abs(e) > wide_gate) continue;
      std::vector<int>& own = counts[static_cast<std::size_t>(s)];
      if (own.empty()) own.assign(bins, 0);
      ++own[static_cast<std::size_t>((e + wide_gate) / kBin)];
    }
  std::vector<double> offsets(counts.size(), 0.0);
  for (std::size_t s = 0; s < counts.size(); ++s) {
    int most = 0;
    for (std::size_t i = 0; i + kBinsOfWindow <= counts[s].size(); ++i) {
      int sum = 0;
      for (std::size_t k = i; k < i + kBinsOfWindow; ++k) sum += counts[s][k];
      if (sum <= most) continue;
      most = sum;
      offsets[s] = (static_cast<double>(i) + 0.5 * kBinsOfWindow) * kBin - wide_gate;
    }
  }
  return offsets;
}

}  // namespace

std::vector<FaceFeature> fit_faces(const FitContext& context, const Prediction& prediction,
                                   const std::vector<TrackedBox>& boxes, const FitStep& step) {
  const camera::Frame& frame = context.frame;
  const FaceSettings& settings = context.settings.faces;
  const int border = settings.border;
  const camera::Cast& cast = prediction.cast;
  std::vector<Sums> sums(cast.surfaces.size());
  std::vector<FaceFrame> frames(cast.surfaces.size());
  for (std::size_t i = 0; i < cast.surfaces.size(); ++i) {
    const camera::Surface& surface = cast.surfaces[i];
    if (surface.body < prediction.first_box + step.first_box) continue;
    sums[i].face = surface.face;
    frames[i] = frame_of(boxes[static_cast<std::size_t>(surface.body - prediction.first_box)], surface.face);
  }
  std::vector<double> offsets(sums.size(), 0.0);
  if (step.wide_gate > 0.0) offsets = common_offsets(frame, prediction, step.wide_gate);
  const PixelRange& range = prediction.range;
  for (int r = border; r < range.rows() - border; ++r) {
    const float* const depth = frame.depth.row(r + range.first_row) + range.first_col;
    const std::int32_t* const surface = cast.surface.row(r);
    const std::int32_t *const above = cast.surface.row(r - border), *const below = cast.surface.row(r + border);
    const float* const w = cast.inverse_depth.row(r);
    for (int c = border; c < range.cols() - border; ++c) {
      const std::int32_t s = surface[c];
      if (s < 0 || sums[static_cast<std::size_t>(s)].face < 0 || depth[c] == 0.0F) continue;
      if (surface[c - border] != s || surface[c + border] != s || above[c] != s || below[c] != s) continue;
      const double e = cast.surfaces[static_cast<std::size_t>(s)].offset * (static_cast<double>(depth[c]) * w[c] - 1.0);
      if (std::abs(e - offsets[static_cast<std::size_t>(s)]) > step.gate) continue;
      const int col = c + range.first_col, row = r + range.first_row;
      add_point(sums[static_cast<std::size_t>(s)], frames[static_cast<std::size_t>(s)],
                static_cast<double>(depth[c]) * camera::pixel_ray(frame.camera.intrinsics, col, row), e, col, row);
    }
  }
  std::vector<FaceFeature> features;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (sums[i].face < 0 || sums[i].count < settings.least_points) continue;
    const camera::Surface& surface = cast.surfaces[i];
    const FaceFrame& f = frames[i];
    // Tilts of what is only a strip are not told by it: 0.2 mm over its width is what a small prior says.
    Matrix3 G = sums[i].G;
    if (!(symmetric_eigenpairs(G / sums[i].count).values(0) > 1e-8)) continue;
    FaceFeature feature;
    feature.box = surface.body - prediction.first_box;
    feature.face = surface.face;
    feature.points = static_cast<int>(sums[i].count);
    const Matrix3 inverse = G.inverse();
    feature.rows.measured = inverse * sums[i].e;
    if (feature.rows.measured.tail<2>().cwiseAbs().maxCoeff() > settings.most_tilt) continue;
    const double facing = std::abs(surface.offset) / f.centre.z();  // n . ray at the middle of the face
    feature.rows.covariance = covariance_of(sums[i], f, inverse, facing, context);
    const Vector3 arm = f.centre - boxes[static_cast<std::size_t>(feature.box)].X_CP.p;
    feature.rows.J.row(0) << f.n.transpose(), arm.cross(f.n).transpose();
    feature.rows.J.row(1) << Vector3::Zero().transpose(), f.u.cross(f.n).transpose();
    feature.rows.J.row(2) << Vector3::Zero().transpose(), f.v.cross(f.n).transpose();
    features.push_back(feature);
  }
  return features;
}

}  // namespace snug::box_estimation::internal
