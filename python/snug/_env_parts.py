"""What environments of packing have in common: their spaces, and what their arguments may be."""
from __future__ import annotations

from typing import Any, List, Tuple

import numpy as np

from . import _core, spaces
from ._errors import refused

_ORIENTATIONS = 24
_FAR = 100.0  # m or kg: more than any number of an observation


def observation_space(core: Any, maps: bool, boxes: bool) -> Any:
    def numbers(*shape: int) -> Any:
        return spaces.Box(-_FAR, _FAR, shape, np.float32)

    parts = {"item": numbers(6), "candidates": numbers(core.max_candidates, 8),
             "action_mask": spaces.Box(0, 1, (core.max_candidates,), np.int8)}
    if maps:
        parts["height_map"] = numbers(core.rows, core.columns)
    if boxes:
        parts["boxes"] = numbers(core.most_boxes, 7)
    return spaces.Dict(parts)


def action_space(core: Any, action: str, inner_size: np.ndarray) -> Any:
    if action == "candidate":
        return spaces.Discrete(core.max_candidates)
    half = 0.5 * np.asarray(inner_size[:2])
    return spaces.Box(np.array([0.0, -half[0], -half[1]], np.float32),
                      np.array([_ORIENTATIONS - 1, half[0], half[1]], np.float32), dtype=np.float32)


def choices(observation: str, action: str) -> Tuple[bool, bool]:
    if observation not in ("height_map", "boxes", "both"):
        raise refused("observation", f"'{observation}'", "height_map, boxes or both")
    if action not in ("candidate", "place"):
        raise refused("action", f"'{action}'", "candidate or place")
    return observation != "boxes", observation != "height_map"


def container_size(scenario: _core.Scenario) -> np.ndarray:
    if scenario.container is None:
        raise refused("scenario", f"{scenario.source} without a target", "a container to be packed")
    return scenario.container["inner_size"]


def check_options(options: Any, *known: str) -> None:
    """Options of a reset: only those that are known."""
    for key in options or {}:
        if key not in known:
            raise refused("options", f"'{key}'", f"one of: {', '.join(known)}" if known else "none")


def seeds_of(seed: Any, count: int) -> List[Any]:
    """One for each environment: a number counts up from the first on, a list has its own, None stays None."""
    if seed is None:
        return [None] * count
    seeds = [int(seed) + i for i in range(count)] if np.ndim(seed) == 0 else list(seed)
    if len(seeds) != count:
        raise refused("seed", f"{len(seeds)} of them", f"one for each of {count}")
    return seeds


def reset_mask(given: Any, count: int) -> np.ndarray:
    """Which environments a reset is for: all, unless options name them."""
    if given is None:
        return np.ones(count, bool)
    which = np.asarray(given)
    if which.shape != (count,) or which.dtype != bool:
        raise refused("options", f"a reset_mask of {which.dtype}, shape {which.shape}", f"true or false for each of {count}")
    return which.copy()


def refuse_ended(has_ended: np.ndarray) -> None:
    """For a step where nothing begins anew by itself."""
    if has_ended.any():
        raise refused("actions", f"environments {np.flatnonzero(has_ended).tolist()} that have ended",
                      'reset(options={"reset_mask": ...}) first')
