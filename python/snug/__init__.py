"""snug: simulates, plans and measures how a robot with a suction cup packs boxes.

Units are SI and radians. Frames: W world (the robot's base), E the tool at the gripper's end, T the container's inner
floor (middle, z up), P a parcel (middle, axes along its edges). X_AB is the pose of B in A. A pose is an array
[x, y, z, qw, qx, qy, qz] in m, its quaternion of unit length with qw >= 0; `matrix` and `pose` turn it into a 4 x 4
matrix and back. Wrenches are [fx, fy, fz, tx, ty, tz] in N and Nm.

Input that cannot be used raises `InputError` (a ValueError with file, line and key); a simulation that cannot go on
raises RuntimeError; a legitimate "no" is a result.

Objects are used by one thread at a time (a second one is refused); different objects by as many as you like:
stepping, packing and searching release the interpreter's lock. Arrays named as views are read-only, live and free of
copies: they change with the next step and keep their object alive. Everything else that is returned is yours.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _core, agent
from ._core import (Arm, Cell, CellSnapshot, Packer, Program, Scenario, World, WorldSnapshot,
                    agent_names, load_program, parse_program, parse_scenario)
from ._errors import InputError
from ._exports import to_rerun, to_usd
from ._tools import Cup, matrix, pose
from ._results import Result, Recording, pack, report, simulate
from ._scenarios import load_scenario, scenario_names

_core.set_input_error(InputError)

if TYPE_CHECKING:
    from . import env
__version__: str = _core.__version__


def __getattr__(name: str) -> Any:
    """snug.env, which brings Gymnasium where it is installed, when it is asked for."""
    if name == "env":
        import importlib

        return importlib.import_module(".env", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

__all__ = ["Arm", "Cell", "CellSnapshot", "Cup", "InputError", "Packer", "Program", "Recording", "Result", "Scenario",
           "World", "WorldSnapshot", "agent", "agent_names", "env", "load_program", "load_scenario", "matrix", "pack", "parse_program",
           "parse_scenario", "pose", "report", "scenario_names", "simulate",
           "to_rerun", "to_usd"]
