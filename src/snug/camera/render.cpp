// render: cast from where the camera really is, then the errors, each in image space.
#include "snug/camera/render.hpp"

#include <algorithm>
#include <cmath>

#include "snug/camera/cast.hpp"
#include "snug/camera/internal/edges.hpp"
#include "snug/camera/internal/noise.hpp"
#include "snug/camera/loss.hpp"
#include "snug/core/hash.hpp"
#include "snug/core/parallel.hpp"

namespace snug::camera {
namespace {

using internal::low_uniform;
using internal::pixel_bits;

constexpr int kRowsRenderedAtOnce = 32;
constexpr double kReaches = 3.0;      // of interreflection: what is left at that many is 5 %
constexpr int kFarthestCorner = 200;  // px: distances are kept in 8 bits
// m: what the projector sees within this of a point is the point. Its picture is read at the nearest pixel: half of a
// pixel of 1.0 mm (0.9 m, 902 px) on a face 80 degrees from square to the ray makes 2.8 mm.
constexpr double kLitDepth = 3e-3;

/// The camera as it is: pose and focal lengths with their errors.
CastView true_view(const model::CameraParams& camera, const CameraDraw& draw) {
  CastView view{camera.X_WC * draw.X_CD, camera.intrinsics, camera.height, camera.width, 0, 0};
  view.optics.fx *= 1.0 + draw.scale;
  view.optics.fy *= 1.0 + draw.scale;
  return view;
}

/// What the projector lights: a second picture, wide enough for every point between near and far.
struct Projector {
  CastView view;
  Cast cast;
};

Projector make_projector(const Scene& scene, const model::CameraParams& camera, const CastView& view, int threads) {
  Projector projector{view, {}};
  projector.view.X_WC.p += view.X_WC.R * camera.p_CL;
  const auto span = [](double focal, double offset, double near, double far, int count, int& first, int& size) {
    const double a = -focal * offset / near, b = -focal * offset / far;
    first = static_cast<int>(std::floor(std::min({a, b}))) - 1;
    size = count + static_cast<int>(std::ceil(std::max(a, b))) + 2 - first;
    size = std::min(size, 4 * count);
  };
  const double near = std::max(camera.range.near, 0.5 * camera.range.focus);
  span(view.optics.fx, camera.p_CL.x(), near, camera.range.far, view.cols, projector.view.first_col,
       projector.view.cols);
  span(view.optics.fy, camera.p_CL.y(), near, camera.range.far, view.rows, projector.view.first_row,
       projector.view.rows);
  projector.cast = cast(scene, projector.view, threads);
  return projector;
}

/// Grey of a body, from its name: 0.45 .. 0.95.
float grey_of(const std::string& name) {
  Hash hash;
  hash.add(name);
  return 0.45F + 0.5F * static_cast<float>(Rng(hash.value()).uniform());
}

class Shot {
 public:
  Shot(const Scene& scene, const model::CameraParams& camera, const CameraDraw& draw, std::uint64_t shot, int threads)
      : scene_(scene),
        camera_(camera),
        draw_(draw),
        view_(true_view(camera, draw)),
        threads_(threads),
        cast_(cast(scene, view_, threads)),
        grazing_loss_(camera.errors.loss) {
    Rng rng = Rng(shot).split("shot of " + camera.name);
    noise_key_ = rng.next();
    wave_key_ = rng.next();
    loss_key_ = rng.next();
  }

  RenderedFrame take() {
    const model::CameraErrors& errors = camera_.errors;
    if (camera_.p_CL != Vector3::Zero()) projector_ = make_projector(scene_, camera_, view_, threads_);
    borders_ = internal::find_borders(cast_, threads_);
    edge_loss_ = edge_loss(errors.loss);
    const int edge_reach = std::max<int>(1, static_cast<int>(edge_loss_.size()));
    edges_ = internal::edge_distance(borders_, edge_reach, threads_);
    if (errors.interreflection.bias > 0.0) {
      const double pixel = camera_.range.near / std::min(view_.optics.fx, view_.optics.fy);
      corner_reach_ = std::clamp(static_cast<int>(kReaches * errors.interreflection.reach / pixel), 1, kFarthestCorner);
      corners_ = internal::corner_distance(borders_, corner_reach_, threads_);
    }
    if (errors.noise.precision > 0.0)
      noise_ = internal::blurred_noise(view_.rows, view_.cols, noise_key_, errors.noise.correlation, threads_);
    for (const std::string& name : scene_.names) greys_.push_back(grey_of(name));
    return fill();
  }

 private:
  RenderedFrame fill() {
    RenderedFrame out;
    out.frame.camera = camera_;
    out.frame.depth = Grid2<float>(view_.rows, view_.cols);
    out.frame.intensity = Grid2<std::uint8_t>(view_.rows, view_.cols);
    out.truth = {view_.X_WC, Grid2<float>(view_.rows, view_.cols), Grid2<std::int16_t>(view_.rows, view_.cols, -1),
                 scene_.names, scene_.X_WB};
    const model::Planarity& planarity = camera_.errors.planarity;
    std::vector<internal::Waves> waves;
    std::vector<float> scales;
    const auto add_waves = [&](double size, double length, std::uint64_t key) {
      if (!(size > 0.0)) return;
      waves.emplace_back(view_.rows, view_.cols, key, length);
      scales.push_back(static_cast<float>(size));
    };
    add_waves(planarity.local, planarity.local_length, wave_key_);
    add_waves(planarity.global, planarity.global_length, draw_.wave_seed);
    parallel_for((view_.rows + kRowsRenderedAtOnce - 1) / kRowsRenderedAtOnce, threads_, [&](int job, int) {
      std::vector<float> offsets(static_cast<std::size_t>(view_.cols));
      for (int r = job * kRowsRenderedAtOnce; r < std::min(view_.rows, (job + 1) * kRowsRenderedAtOnce); ++r) {
        std::fill(offsets.begin(), offsets.end(), 0.0F);
        for (std::size_t i = 0; i < waves.size(); ++i) waves[i].add_row(r, scales[i], offsets.data());
        fill_row(r, offsets.data(), out);
      }
    });
    return out;
  }

  void fill_row(int row, const float* offsets, RenderedFrame& out) const {
    const auto first = static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(view_.cols);
    const double y = (row - view_.optics.cy) / view_.optics.fy;
    for (int col = 0; col < view_.cols; ++col) {
      const std::int32_t s = cast_.surface(row, col);
      if (s < 0) continue;
      const Surface& surface = cast_.surfaces[static_cast<std::size_t>(s)];
      const float w = cast_.inverse_depth(row, col), z = 1.0F / w;
      out.truth.depth(row, col) = z;
      out.truth.label(row, col) = static_cast<std::int16_t>(surface.body);
      const double x = (col - view_.optics.cx) / view_.optics.fx;
      const float length = std::sqrt(static_cast<float>(1.0 + x * x + y * y));
      const float cosine =
          surface.is_flat() ? static_cast<float>(-surface.offset) * w / length : round_cosine(row, col, length);
      const bool is_lit = !projector_ || sees(*projector_, x, y, z, surface);
      const auto focus = static_cast<float>(camera_.range.focus);
      const float light = 220.0F * greys_[static_cast<std::size_t>(surface.body)] * cosine * (is_lit ? 1.0F : 0.3F) *
                          (focus * focus * w * w);
      out.frame.intensity(row, col) = static_cast<std::uint8_t>(std::clamp(light, 0.0F, 255.0F));
      if (!is_lit) continue;
      const std::uint64_t bits = pixel_bits(loss_key_, first + static_cast<std::uint64_t>(col));
      if (low_uniform(bits) < lost(row, col, cosine)) continue;
      out.frame.depth(row, col) = measured(row, col, z, cosine, offsets[col], bits);
    }
  }

  [[nodiscard]] float round_cosine(int row, int col, float length) const {
    const Vector3 ray = pixel_ray(view_.optics, col, row);
    return std::max(0.0F, static_cast<float>(-normal_at(cast_, scene_, view_, row, col).dot(ray)) / length);
  }

  /// Probability that the point is missing.
  [[nodiscard]] float lost(int row, int col, float cosine) const {
    const model::PointLoss& loss = camera_.errors.loss;
    const std::uint8_t d = edges_(row, col);
    const float edge = d <= edge_loss_.size() ? edge_loss_[d - 1U] : 0.0F;
    return 1.0F - (1.0F - static_cast<float>(loss.random)) * (1.0F - edge) * (1.0F - grazing_loss_(cosine));
  }

  /// The point's depth with all errors; 0 outside the working range.
  [[nodiscard]] float measured(int row, int col, float z, float cosine, float wave, std::uint64_t bits) const {
    const model::CameraErrors& errors = camera_.errors;
    double depth = z;
    if (errors.mixed_pixels.probability > 0.0 && edges_(row, col) == 1) depth = mixed(row, col, z, bits);
    const double relative = depth / camera_.range.focus;
    if (!noise_.values().empty()) depth += errors.noise.precision * relative * relative * noise_(row, col);
    depth += wave;
    if (!corners_.values().empty() && corners_(row, col) <= corner_reach_) {
      const auto per_pixel = static_cast<float>(1.0 / (view_.optics.fx * errors.interreflection.reach));
      const float distance = (static_cast<float>(corners_(row, col)) - 0.5F) * z * per_pixel;  // in reaches
      depth -= errors.interreflection.bias * std::exp(-distance) / std::max(0.2F, cosine);
    }
    depth = camera_.range.focus + (1.0 + draw_.scale) * (depth - camera_.range.focus);
    return depth >= camera_.range.near && depth <= camera_.range.far ? static_cast<float>(depth) : 0.0F;
  }

  /// With the stated probability somewhere between this surface and the one beyond the edge.
  [[nodiscard]] double mixed(int row, int col, float z, std::uint64_t bits) const {
    const std::uint64_t more = pixel_bits(bits, 0);
    if (static_cast<double>(more >> 32) * 0x1.0p-32 >= camera_.errors.mixed_pixels.probability) return z;
    const double part = static_cast<double>(more & 0xffffffffU) * 0x1.0p-32;
    int r = row, c = col;
    const auto has = [this](int a, int b, int border) {
      return borders_.is_inside(a, b) && (borders_(a, b) & border) != 0;
    };
    if (has(row, col, internal::kJumpRight))
      ++c;
    else if (has(row, col - 1, internal::kJumpRight))
      --c;
    else if (has(row, col, internal::kJumpBelow))
      ++r;
    else
      --r;
    if (!borders_.is_inside(r, c) || cast_.surface(r, c) < 0) return z;
    return z + part * (1.0 / cast_.inverse_depth(r, c) - z);
  }

  /// Whether the projector's picture has this surface, or another as deep, where the point is in it.
  [[nodiscard]] bool sees(const Projector& projector, double x, double y, float z, const Surface& surface) const {
    const double z_L = z - camera_.p_CL.z();
    if (!(z_L > 0.0)) return false;
    const CastView& view = projector.view;
    const double col = view.optics.cx + view.optics.fx * (x * z - camera_.p_CL.x()) / z_L - view.first_col;
    const double row = view.optics.cy + view.optics.fy * (y * z - camera_.p_CL.y()) / z_L - view.first_row;
    const int c = static_cast<int>(col + 0.5), r = static_cast<int>(row + 0.5);  // inside, or refused below
    if (col < 0.0 || row < 0.0 || !projector.cast.surface.is_inside(r, c)) return false;
    const std::int32_t s = projector.cast.surface(r, c);
    if (s < 0) return false;
    const Surface& lit = projector.cast.surfaces[static_cast<std::size_t>(s)];
    if (lit.shape == surface.shape && lit.face == surface.face && lit.is_flat()) return true;
    return std::abs(1.0 / std::max(1e-6F, projector.cast.inverse_depth(r, c)) - z_L) < kLitDepth;
  }

  const Scene& scene_;
  const model::CameraParams& camera_;
  const CameraDraw& draw_;
  CastView view_;
  int threads_;
  Cast cast_;
  std::uint64_t noise_key_ = 0, wave_key_ = 0, loss_key_ = 0;
  std::optional<Projector> projector_;
  Grid2<std::uint8_t> borders_, edges_, corners_;
  Grid2<float> noise_;
  int corner_reach_ = 0;
  GrazingLoss grazing_loss_;
  std::vector<float> edge_loss_, greys_;
};

}  // namespace

CameraDraw draw_camera(const model::CameraParams& camera, std::uint64_t seed) {
  Rng rng = Rng(seed).split("camera " + camera.name);
  const auto normals = [&rng](double size) {
    Vector3 v;
    for (int i = 0; i < 3; ++i) v(i) = size * rng.normal();
    return v;
  };
  CameraDraw draw;
  const Vector3 turn = normals(camera.errors.hand_eye.rotation), shift = normals(camera.errors.hand_eye.position);
  draw.X_CD = {exp_rotation(turn), shift + normals(camera.errors.trueness.position)};
  draw.scale = camera.errors.trueness.dimension * rng.normal();
  draw.wave_seed = rng.next();
  return draw;
}

RenderedFrame render(const Scene& scene, const model::CameraParams& camera, const CameraDraw& draw, std::uint64_t shot,
                     int threads) {
  return Shot(scene, camera, draw, shot, threads).take();
}

}  // namespace snug::camera
