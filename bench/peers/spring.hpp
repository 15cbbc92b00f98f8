// Spring: the linear 6D spring-damper of S5 and S6, and the motion of a lone box on it to which all engines are held.
#pragma once

#include "peers/scenes.hpp"

namespace snug::peers {

/// Displacement of the attachment A from the holder's frame E, in E, m.
[[nodiscard]] Vector3 spring_deflection(const Spring& spring, const HolderMotion& holder, const Pose& X_WB);

/// Wrench of the spring on the box, about the box's centre, in W.
[[nodiscard]] Wrench spring_wrench(const Spring& spring, const HolderMotion& holder, const Pose& X_WB,
                                   const Twist& V_WB);

/// Largest length of the deflection when nothing touches the box, m: Runge-Kutta of order 4 at 0.1 ms, which is
/// within 1e-6 of the same at 0.05 ms.
[[nodiscard]] double converged_peak_deflection(const HeldScene& held);

}  // namespace snug::peers
