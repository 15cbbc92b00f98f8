// GripperParams: several suction cups on one tool, and the vacuum source that they share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/model/cup_params.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::model {

/// More cups than any gripper has: area grippers have up to some hundred.
inline constexpr int kMostCups = 256;

/// Between a cup and the manifold: what an open or leaking cup costs the others. Zero port: nothing limits the flow.
struct CupLine {
  double port_diameter = 0.004;  ///< m, narrowest bore between cup and manifold (flow restrictor)
  double leak_diameter = 0.0;    ///< m, of the orifice that lets in as much air as the sealed lip does
  bool check_valve = false;      ///< shuts where no face seals the cup: it then costs nothing

  template <class Archive>
  void fields(Archive& a) {
    a("port_diameter", port_diameter, Range::Positive);
    a("leak_diameter", leak_diameter, Range::NotNegative);
    a("check_valve", check_valve);
  }
  bool operator==(const CupLine&) const = default;
};

/// One cup of several. It points along Ez; C is to this cup what E is to a cup alone, with the axes of E.
struct MountedCup {
  std::string name;                ///< unique, for events and recordings
  Vector3 p_EC = Vector3::Zero();  ///< m
  std::size_t zone = 0;            ///< index into GripperParams::zones
  CupLine line;
  CupParams cup;

  bool operator==(const MountedCup&) const = default;
};

/// Vacuum pump or ejector: what flows falls in proportion from `flow` where there is no vacuum to nothing at
/// `pressure_gauge`.
struct SupplyParams {
  double flow = 0.0;               ///< m^3/s of air at ambient pressure
  double pressure_gauge = -6.0e4;  ///< Pa, with everything shut

  template <class Archive>
  void fields(Archive& a) {
    a("flow", flow, Range::Positive);
    a("pressure_gauge", pressure_gauge, Range::Any);
  }
  bool operator==(const SupplyParams&) const = default;
};

struct GripperParams {
  std::vector<std::string> zones;      ///< names; cups of a zone have one valve
  std::vector<MountedCup> cups;        ///< at least one
  std::optional<SupplyParams> supply;  ///< absent: every sealed cup reaches its own pressure_gauge_hold

  bool operator==(const GripperParams&) const = default;
};

/// What the flow is to a cup of a gripper.
enum class LineState {
  Shut,    ///< its zone is off: no air flows
  Open,    ///< it sucks air
  Sealed,  ///< only its lip's leak flows
};

/// Vacuum, Pa below ambient, of the manifold and of each cup where the supply's curve meets what flows in through the
/// cups: through an orifice of area A flows A sqrt(2 p / rho) at a vacuum of p (docs/theory/cup.md, section 9). A cup's
/// own vacuum is that between its port and its leak; 0 for open and shut ones. `states`: one per cup.
struct SupplyBalance {
  double manifold = 0.0;
  std::vector<double> cups;
};
void balance_supply(const GripperParams& gripper, const std::vector<LineState>& states, SupplyBalance& balance);

/// One cup at E that does, for small motions about E and on one whole face, what all cups do together: plans and checks
/// that know one cup take it for the gripper. Axially symmetric as every cup: of the two bending directions the softer
/// and weaker one counts. Its vacuum is that with all cups sealed.
[[nodiscard]] CupParams equivalent_cup(const GripperParams& gripper);

/// Half extents, m, along Ex and Ey, of all sealing discs about E.
[[nodiscard]] Vector3 footprint(const GripperParams& gripper);

/// These stiffnesses and dampings of every cup times a factor; lengths of every cup longer by this, m.
void vary_cups(double stiffness_factor, double damping_factor, double longer, std::optional<GripperParams>& gripper);

}  // namespace snug::model
