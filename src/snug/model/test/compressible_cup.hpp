// compressible_cup: a law in which every coefficient counts.
#pragma once

#include "snug/model/cup_law.hpp"

namespace snug::model::test {

inline CupLaw compressible_cup() {
  CupLaw law;
  law.half_range = 0.007, law.middle = -0.009;
  law.axial_1 = 20.0, law.axial_2 = -3.0, law.axial_3 = 2.0, law.axial_4 = 1.0, law.axial_5 = 0.5;
  law.lateral_0 = 1200.0, law.lateral_1 = 300.0, law.lateral_2 = 100.0;
  law.bend_0 = 0.8, law.bend_1 = 0.1, law.bend_2 = 0.05;
  law.coupling_0 = 12.0, law.coupling_1 = 2.0, law.coupling_2 = -1.0;
  law.torsion_0 = 0.2, law.torsion_1 = -0.05;
  return law;
}

}  // namespace snug::model::test
