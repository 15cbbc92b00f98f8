// measure_camera: what rendering and estimating cost, and how near the estimates come to the truth.
#pragma once

#include <cstdint>

#include "bench/figures/bench.hpp"
#include "bench/figures/internal/tote_scenes.hpp"

namespace snug::bench::internal {

/// What a run of frames showed. Errors are of boxes of which the truth has enough in view (kVisiblePart).
struct CameraScore {
  int frames = 0;
  std::vector<double> position_mm, angle_deg;  ///< of visible boxes that were reported seen, sorted
  std::vector<double> chi_square;              ///< of the same, six degrees of freedom
  int visible = 0, visible_seen = 0;
  int hidden = 0, hidden_seen = 0;            ///< the truth has (almost) nothing in view: kHiddenPixels
  int disturbed = 0, disturbed_found = 0;     ///< visible ones that were moved, tipped or taken away, and those noticed
  int wrong = 0;                              ///< reported seen, more than 20 mm off
  int foreign = 0, foreign_frames = 0;        ///< obstacles reported where there are none; frames with any
  double render_ms = 0.0, estimate_ms = 0.0;  ///< CPU time, the median
};

struct CameraTrial {
  std::uint64_t first_seed = 0;
  int scenes = 20;
  int boxes = 15;
  Disturbance disturbance = Disturbance::None;
  bool print = false;  ///< each bad box, on stderr
};

/// Scenes of the scenario's first camera. Every frame has a camera of its own, drawn by the seed.
[[nodiscard]] CameraScore score_camera(const model::Scenario& scenario, const model::CameraParams& camera,
                                       const CameraTrial& trial);

/// Figures whose names begin with "camera".
void measure_camera(const BenchOptions& options, std::vector<Figure>& figures);

}  // namespace snug::bench::internal
