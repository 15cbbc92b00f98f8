"""Packing as environments in the form of Gymnasium, which need not be installed: one, and many at once on threads.

    env = snug.env.Packing(snug.load_scenario("box-demonstrator"), mode="executed", sequence="1")
    observation, info = env.reset(seed=7)
    observation, reward, terminated, truncated, info = env.step(0)

An episode is one container. Each step places the item that waits; the reward is the change of the packed volume, as
part of the container's inner volume, so that rewards add up to the filling degree. The episode terminates when all
items are packed, when the next one has no place, and when a placement fails; it is truncated after `max_steps`.
"""
from __future__ import annotations

from typing import Any, Dict, List, Mapping, Optional, Tuple

import numpy as np

from . import _core, spaces
from ._env_parts import action_space, check_options, choices, container_size, observation_space
from ._ray_env import RayVectorPacking
from ._vector_env import VectorPacking

__all__ = ["Packing", "RayVectorPacking", "VectorPacking"]

Observation = Dict[str, np.ndarray]


def _whole(number: Any) -> int:
    """An index, however absurd: those that are none stay none."""
    return max(-1, min(int(number), 10**6))


class Packing(spaces.Env):
    """One container, packed again and again.

    Args:
        scenario: with a container; mode "executed" needs aligner and tool too.
        mode: "geometric": a box is where it was lowered; "statics": it is set down there at rest, with contact, and
            has to stay; "executed": the tool brings it from the aligner, with contact and the compliant cup.
        sequence: items in this order; None: every parcel of the scenario, in an order drawn from the seed.
        observation: "height_map", "boxes" or "both".
        action: "candidate": index of a place that the built-in generator found; "place": [orientation, x, y], where
            orientation counts 8 * axis up (X, Y, Z) + 4 if its negative end is up + quarter turns, and x, y [m, in T]
            are the middle of the box, which is lowered there until it rests.
        resolution: m, edge of a cell of the height map.
        max_candidates: places offered at most; an episode of an item with more goes on with the lowest.
        max_steps: the episode is truncated then.
        max_flips: 1 lets boxes be put on any side (not in mode "executed": the tool brings them as they stand).
        min_support: part of the lower face that has to rest on something for a place to be offered; 0: any.
        planned_interference: m (`squeeze` in earlier scripts), boxes are planned this much smaller along Tx and Ty.
        settle_time: s, in mode "statics".
        time_step: s, how long physics steps may be in modes "statics" and "executed", in whole parts of the controller's
            tick and no shorter than the scenario's; 0: the scenario's. docs/python.md says what 4 ms change.
        max_displacement, max_tilt: m and rad, how far a box may come to rest from where it was put.
        vary: True: the cell is drawn anew for each episode, from the scenario's `uncertainty`: sizes, masses, friction,
            cup, aligner. `scenario.with_values({"uncertainty.size": 0.002})` sets a half width.
        parameters: this environment's own: size_offset (m), friction_scale, cup_scale, mass_scale.

    Observations (each a copy that is yours; m, kg, frame T; float32):
        height_map: (rows, columns), height over the floor, row by row along Ty. Cost and size grow with
            1 / resolution^2: 57 x 37 cells at 10 mm in the demonstrator's container.
        boxes: (items, 7), low corner, high corner, mass; zeros behind the last.
        item: size along Ax, Ay, Az as it arrives, mass, upright only (0 or 1), nothing may stand on it (0 or 1).
        candidates: (max_candidates, 8), low corner, extents, support, orientation; zeros behind the last.
        action_mask: (max_candidates,), int8, 1 where there is a candidate.
    """

    metadata: Dict[str, Any] = {"render_modes": []}

    def __init__(self, scenario: _core.Scenario, mode: str = "geometric", *, sequence: Optional[str] = None,
                 observation: str = "height_map", action: str = "candidate",
                 parameters: Optional[Mapping[str, float]] = None, render_mode: Optional[str] = None,
                 **settings: float):
        self._maps, self._boxes = choices(observation, action)
        inner_size = container_size(scenario)
        self._by_candidate = action == "candidate"
        self.scenario = scenario
        self.mode = mode
        self.render_mode = render_mode
        self._core = _core.Environment(scenario, {"mode": mode, "sequence": sequence, **settings},
                                       dict(parameters or {}), self._maps, self._boxes)
        self.observation_space = observation_space(self._core, self._maps, self._boxes)
        self.action_space = action_space(self._core, action, inner_size)

    def reset(self, *, seed: Optional[int] = None,
              options: Optional[Dict[str, Any]] = None) -> Tuple[Observation, Dict[str, Any]]:
        """A new episode. With a seed the same episodes follow; without, the next of the last seed's (drawn by chance at first).
        There are no options."""
        check_options(options)
        super().reset(seed=seed)
        return self._core.reset(int(self.np_random.integers(2**63))), self._info("", 0.0, True)

    def step(self, action: Any) -> Tuple[Observation, float, bool, bool, Dict[str, Any]]:
        """Places the item that waits. info: reason (why the episode ended, or ""), is_placed, displacement (m),
        packed_percent, time (s, simulated), candidates (how many there are for the next item)."""
        if self._by_candidate:
            index = action.item() if isinstance(action, np.ndarray) else action
            result = self._core.step_candidate(_whole(index))
        else:
            orientation, x, y = np.asarray(action, dtype=float)
            orientation = round(float(orientation)) if np.isfinite(orientation) else -1
            result = self._core.step_place(_whole(orientation), float(x), float(y))
        observation, reward, terminated, truncated, reason, displacement, is_placed = result
        return observation, reward, terminated, truncated, self._info(reason, displacement, is_placed)

    def action_masks(self) -> np.ndarray:
        """(max_candidates,), bool: which candidates there are for the item that waits; the `action_mask` of the last observation,
        as MaskablePPO of sb3-contrib asks for it."""
        return np.arange(self._core.max_candidates) < self._core.candidates

    def __repr__(self) -> str:
        return f"<snug.env.Packing of {self.scenario.name}: mode {self.mode}, {self._core.packed_percent:.1f} % packed>"

    def snapshot(self) -> Any:
        """All that changes, for `restore`; going on from it gives the same bytes."""
        return self._core.copy()

    def restore(self, snapshot: Any) -> Observation:
        """Goes back to a snapshot of this environment, as often as you like."""
        self._core = snapshot.copy()
        return self._core.observe()

    def boxes(self) -> List[Dict[str, Any]]:
        """Boxes in the container: id, size, mass, pose X_TP as they are."""
        return self._core.boxes()

    @property
    def hash(self) -> int:
        """Of everything that has an influence on what comes."""
        return self._core.hash

    def render(self) -> None:
        """Nothing is drawn: `snug.pack(..., record=...)` and `snug.report` show runs."""

    def _info(self, reason: str, displacement: float, is_placed: bool) -> Dict[str, Any]:
        core = self._core
        return {"reason": reason, "is_placed": is_placed, "displacement": displacement,
                "packed_percent": core.packed_percent, "time": core.time, "candidates": core.candidates}
