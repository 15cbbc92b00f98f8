"""Many containers at once, on threads, as a vector environment of Gymnasium."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from . import _core, spaces
from ._env_parts import (action_space, check_options, choices, container_size, observation_space, refuse_ended, reset_mask,
                         seeds_of)
from ._errors import refused

Observation = Dict[str, np.ndarray]
_MODES = ("next_step", "same_step", "disabled")


class VectorPacking(spaces.VectorEnv):
    """Many containers at once, each with its own scenario, settings, parameters and seed, stepped on threads without
    the interpreter's lock. What happens does not depend on the number of threads.

    Args:
        scenario: one for all, or a list of `count`; their containers must have one shape.
        count: how many environments.
        threads: at work in a step.
        parameters: a mapping for all, or a list of `count` (see Packing).
        autoreset_mode: what becomes of an environment whose episode has ended, in Gymnasium's words (or a member of its
            AutoresetMode). "next_step": it begins anew in the next step, whose action it does not look at and whose reward is 0.
            "same_step": at once; the observation is the first of the new episode, the last one is in info["final_obs"].
            "disabled": it waits for `reset(options={"reset_mask": which})`.
        The rest as of Packing, for all.

    The same as `gymnasium.vector.SyncVectorEnv` of `Packing` environments: the same seeds give the same episodes.
    Arrays that a step returns are new ones: nothing is written into those that were returned before.
    """

    def __init__(self, scenario: Any, count: int, mode: str = "geometric", *, threads: int = 1,
                 sequence: Optional[str] = None, observation: str = "height_map", action: str = "candidate",
                 parameters: Any = None, autoreset_mode: Any = "next_step", **settings: float):
        maps, boxes = choices(observation, action)
        scenarios = list(scenario) if isinstance(scenario, (list, tuple)) else [scenario] * count
        own = list(parameters) if isinstance(parameters, (list, tuple)) else [parameters or {}] * count
        if len(scenarios) != count or len(own) != count:
            raise refused("count", str(count), f"as many scenarios ({len(scenarios)}) and parameters ({len(own)})")
        self._mode = str(getattr(autoreset_mode, "name", autoreset_mode)).lower()
        if self._mode not in _MODES:
            raise refused("autoreset_mode", f"'{autoreset_mode}'", ", ".join(_MODES))
        inner_size = container_size(scenarios[0]) if scenarios else np.zeros(3)
        self.num_envs = count
        self.metadata = {"render_modes": [], "autoreset_mode": spaces.autoreset_mode(self._mode)}
        self.render_mode = None
        self._by_candidate = action == "candidate"
        self._core = _core.VectorEnvironment(scenarios, [{"mode": mode, "sequence": sequence, **settings}] * count,
                                             [dict(one) for one in own], threads, maps, boxes)
        self.single_observation_space = observation_space(self._core, maps, boxes)
        self.single_action_space = action_space(self._core, action, inner_size)
        self.observation_space = spaces.batch_space(self.single_observation_space, count)
        self.action_space = spaces.batch_space(self.single_action_space, count)
        self._random: List[Optional[np.random.Generator]] = [None] * count
        self._has_ended = np.zeros(count, bool)

    def reset(self, *, seed: Any = None,
              options: Optional[Dict[str, Any]] = None) -> Tuple[Observation, Dict[str, Any]]:
        """New episodes.

        Args:
            seed: a number, from which those of the environments count up, or a list with one (or None) for each; None: each
                goes on with the next episode of its last seed, drawn by chance at first.
            options: {"reset_mask": (count,) bool}: only these begin anew.
        """
        check_options(options, "reset_mask")
        which = reset_mask((options or {}).get("reset_mask"), self.num_envs)
        self._seed(seed, which)
        observation = self._core.reset(which.astype(np.uint8), self._draw(which))
        self._has_ended &= ~which
        return observation, {}

    def step(self, actions: Any) -> Tuple[Observation, np.ndarray, np.ndarray, np.ndarray, Dict[str, Any]]:
        """Observations with the environments along the first axis; rewards, terminated, truncated of shape (count,).

        info has `reason` and `packed_percent` of environments whose episode has just ended, `_reason` and `_packed_percent` tell
        which these are; in mode "same_step" also `final_obs` (an array of their last observations) and `final_info`.
        """
        if self._mode == "disabled":
            refuse_ended(self._has_ended)
        seeds = self._draw(self._has_ended)
        step = self._core.step_candidates if self._by_candidate else self._core.step_places
        observation, reward, terminated, truncated = step(actions, seeds)
        self._has_ended = terminated | truncated
        info: Dict[str, Any] = {}
        if self._has_ended.any():
            ended = self._has_ended.copy()
            info = {"reason": np.array(self._core.reasons, object), "_reason": ended,
                    "packed_percent": self._core.packed_percent, "_packed_percent": ended}
            if self._mode == "same_step":
                observation = self._begin_anew(ended, observation, info)
        return observation, reward, terminated, truncated, info

    def _begin_anew(self, ended: np.ndarray, last: Observation, info: Dict[str, Any]) -> Observation:
        final = np.full(self.num_envs, None, object)
        for i in np.flatnonzero(ended):
            final[i] = {key: value[i].copy() for key, value in last.items()}
        info.update(final_obs=final, _final_obs=ended, _final_info=ended,
                    final_info={key: info[key] for key in ("reason", "_reason", "packed_percent", "_packed_percent")})
        self._has_ended = np.zeros(self.num_envs, bool)
        return self._core.reset(ended.astype(np.uint8), self._draw(ended))

    def _seed(self, seed: Any, which: np.ndarray) -> None:
        """New random numbers for environments of `which` that are given a seed."""
        seeds = seeds_of(seed, self.num_envs)
        for one in seeds:
            if one is not None and not 0 <= int(one) < 2**64:
                raise refused("seed", str(one), "whole numbers from 0, below 2^64")
        for i in np.flatnonzero(which):
            if seeds[i] is not None:
                self._random[i] = spaces.generator(int(seeds[i]))

    def _draw(self, which: np.ndarray) -> np.ndarray:
        """The next episode's seed of each of `which`, as Packing.reset draws it."""
        seeds = np.zeros(self.num_envs, np.uint64)
        for i in np.flatnonzero(which):
            random = self._random[i]
            if random is None:
                random = self._random[i] = spaces.generator(None)
            seeds[i] = random.integers(2**63)
        return seeds

    def action_masks(self) -> np.ndarray:
        """(count, max_candidates), bool: which candidates there are for each item that waits."""
        return np.arange(self._core.max_candidates) < np.asarray(self._core.candidates)[:, None]

    @property
    def reasons(self) -> List[str]:
        """Why each episode ended in the last step; "" while it goes on."""
        return self._core.reasons

    @property
    def packed_percent(self) -> np.ndarray:
        """Of each container."""
        return self._core.packed_percent

    @property
    def hashes(self) -> List[int]:
        """As Packing.hash, of each."""
        return self._core.hashes

    def __repr__(self) -> str:
        return f"<snug.env.VectorPacking: {self.num_envs} environments, autoreset {self._mode}>"

    def render(self) -> None:
        """Nothing is drawn: `snug.pack(..., record=...)` and `snug.report` show runs."""
