// CupParams: everything the suction cup model needs to know.
#include "snug/model/cup_params.hpp"

namespace snug::model {

void scale(CupElasticity& elasticity, double factor) {
  for (double* part :
       {&elasticity.lateral, &elasticity.axial, &elasticity.bend, &elasticity.torsion, &elasticity.coupling})
    *part *= factor;
}

void scale_stiffness(CupParams& cup, double factor) {
  scale(cup.stiffness, factor);
  cup.law.scale(factor);
}

CupElasticity undeformed_stiffness(const CupLaw& law) {
  return {law.lateral(0.0).value, law.axial(0.0).curvature, law.bend(0.0).value, law.torsion(0.0).value,
          law.coupling(0.0).value};
}

}  // namespace snug::model
