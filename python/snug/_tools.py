"""Poses as matrices, and the cup with defaults."""
from __future__ import annotations

from typing import Any, Dict

import numpy as np

from . import _core


def matrix(pose: Any) -> np.ndarray:
    """The 4 x 4 matrix of a pose [x, y, z, qw, qx, qy, qz]."""
    x, y, z, w, i, j, k = np.asarray(pose, dtype=float)
    result = np.eye(4)
    result[:3, :3] = [[1 - 2 * (j * j + k * k), 2 * (i * j - k * w), 2 * (i * k + j * w)],
                      [2 * (i * j + k * w), 1 - 2 * (i * i + k * k), 2 * (j * k - i * w)],
                      [2 * (i * k - j * w), 2 * (j * k + i * w), 1 - 2 * (i * i + j * j)]]
    result[:3, 3] = (x, y, z)
    return result


def pose(transform: Any) -> np.ndarray:
    """The pose [x, y, z, qw, qx, qy, qz] of a 4 x 4 matrix, qw >= 0.

    Raises InputError where its upper left 3 x 3 is no rotation.
    """
    return _core.as_pose(np.asarray(transform, dtype=float))


class Cup(_core.Cup):
    """The suction cup of a scenario as its law describes it: the report's spring on SE(3).

    Frames: S1 is fixed to the lip, S2 to the gripper; both coincide when the cup is not deformed. H = X_S2S1.
    """

    def settle(self, mass: float, com: Any = (0.0, 0.0, 0.0), tool: Any = (0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0),
               gravity: Any = (0.0, 0.0, -9.81)) -> Dict[str, Any]:
        """Where a load comes to rest under the cup that holds it.

        Args:
            mass: kg.
            com: centre of mass seen from the lip, in S (z into the load), m.
            tool: X_WE, of which the orientation counts; pointing down by default.
            gravity: in W, m/s^2.

        Returns:
            status ("converged", ...), lip (pose X_ES), is_stable, residual (N), load_fraction, bend (rad).
        """
        return super().settle(mass, com, tool, gravity)

    def payload(self, times: Any, gripper: Any, wrenches: Any, rigid_lip: bool = False) -> Dict[str, Any]:
        """Mass, centre of mass and inertia of what the cup holds, from a lift of 0.2 s or more (`snug identify payload`).

        Args:
            times: (n,), s, growing.
            gripper: (n, 7), poses X_WE of the gripper's end.
            wrenches: (n, 6), force and torque of the cup on the box, in E about E, N and Nm: up for a hanging box.
            rigid_lip: the lip does not give, as of a hard gripper.

        Returns:
            parameters: a list of name, value, standard_error, unit, verdict ("identified", "weak", "not identifiable") and, where
            it is not identified, what to record instead. Mass in kg, centre of mass in S in m, inertia about it in kg m^2.

        Raises InputError for other shapes, numbers that are not finite, times that do not grow, and too short a lift.
        """
        return super().payload(times, gripper, wrenches, rigid_lip)
