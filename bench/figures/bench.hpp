// Bench: how accurate and how fast the physics is on the bench scenes, each figure beside its target.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"

namespace snug::bench {

struct Figure {
  std::string name;
  double value = 0.0;
  std::string unit;
  std::string target;        ///< as text, e.g. "<= 20"; empty: for information
  bool ok = true;            ///< meets the target
  std::string skipped = {};  ///< why it was not measured, or empty
};

struct BenchOptions {
  std::filesystem::path scenes;     ///< folder of the scene files
  std::filesystem::path scenario;   ///< the demonstrator's cell, for the program
  std::filesystem::path program;    ///< a program of the demonstrator's sequence 1; left out when absent
  std::filesystem::path instances;  ///< folder of public loading instances, BR1.txt ...; said to be skipped when absent
  std::filesystem::path sensors;    ///< what virtual experiments are measured with (figures of validation)
  std::filesystem::path cup_data;   ///< folder of the cup's reference data; said to be skipped when absent
  std::filesystem::path hard_scenes;  ///< folder of scenes that solvers fail on; said to be skipped when absent
  int drop_scenes = 40;               ///< random drops; a thousand take ten minutes
  std::string corrections;            ///< for that program, or empty
  std::string only;                   ///< figures whose scene starts so; empty: all
};

/// The inputs in a folder of scenarios that comes with the program; what is not shipped with it is looked for beside
/// its project, and a program, where it is not there, where `make demo` leaves one.
[[nodiscard]] BenchOptions find_inputs(const std::filesystem::path& scenarios);

/// Largest overlap of two boxes by the fifteen axes of the separating-axis test, m; 0 when apart. Independent of the
/// collision code that it measures.
[[nodiscard]] double box_overlap(const Vector3& half_a, const Pose& X_WA, const Vector3& half_b, const Pose& X_WB);

/// What to ask for, one at a time, for all figures whose name starts with `only`: names of scenes, or `only` itself.
[[nodiscard]] std::vector<std::string> bench_scenes(const std::string& only);

/// Runs the scenes with the solver settings that scenarios have by default (checked). Timed figures are CPU time of
/// this process. docs: README.md of this module.
[[nodiscard]] std::vector<Figure> run_bench(const BenchOptions& options);

}  // namespace snug::bench
