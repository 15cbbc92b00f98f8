"""Many containers at once, on the nodes of a Ray cluster, as a vector environment of Gymnasium."""
from __future__ import annotations

import importlib
from typing import Any, Dict, List, Mapping, Optional, Tuple

import numpy as np

from . import _core, spaces
from ._env_parts import check_options, refuse_ended, reset_mask, seeds_of
from ._errors import refused
from ._vector_env import Observation, VectorPacking


class _Part:
    """An actor: some of the environments."""

    def __init__(self, scenarios: List[str], names: List[str], count: int, words: Dict[str, Any]):
        made = [_core.parse_scenario(text, name) for text, name in zip(scenarios, names)]
        self._env = VectorPacking(made if len(made) > 1 else made[0], count, **words)

    def call(self, name: str, arguments: Tuple[Any, ...], words: Dict[str, Any]) -> Any:
        return getattr(self._env, name)(*arguments, **words)

    def read(self, name: str) -> Any:
        return getattr(self._env, name)


class RayVectorPacking(spaces.VectorEnv):
    """As VectorPacking, its environments on `workers` actors of a Ray cluster: the same seeds and actions give the same
    episodes, whatever node they run on. An actor whose node is lost begins again on another: what it was asked since
    the last reset of all its environments with seeds is asked again, so nothing is lost. These calls are kept until
    then: reset with new seeds now and then.

    Args:
        scenario, count, and all others: as of VectorPacking; `threads` of each actor.
        workers: how many actors; each takes `threads` cores.
        address: of the cluster (`ray.init`); None: that which is connected, else one of this machine alone.

    Nodes need snug itself; files that a scenario names (meshes, URDF) have to be where all nodes see them.
    """

    def __init__(self, scenario: Any, count: int, *, workers: int = 2, address: Optional[str] = None, **words: Any):
        ray = importlib.import_module("ray")
        if not 1 <= int(workers) <= count:
            raise refused("workers", str(workers), f"1 to {count}, as many as there are environments")
        self._ray = ray
        if not ray.is_initialized():
            ray.init(address=address, log_to_driver=False, include_dashboard=False if address is None else None)
        scenarios = list(scenario) if isinstance(scenario, (list, tuple)) else [scenario] * count
        own = words.pop("parameters", None)
        parameters = list(own) if isinstance(own, (list, tuple)) else [own or {}] * count
        if len(scenarios) != count or len(parameters) != count:
            raise refused("count", str(count), f"as many scenarios ({len(scenarios)}) and parameters ({len(parameters)})")
        self._shares = np.array_split(np.arange(count), int(workers))
        threads = int(words.get("threads", 1))
        actor = ray.remote(num_cpus=threads, scheduling_strategy="SPREAD")(_Part)
        self._make = []
        for share in self._shares:
            mine = [scenarios[i] for i in share]
            same = all(one is mine[0] for one in mine)
            different = mine[:1] if same else mine
            given = ([one.text for one in different], [one.source for one in different], len(share),
                     {**words, "parameters": [dict(parameters[i]) for i in share]})
            self._make.append(lambda given=given: actor.remote(*given))
        self._actors = [make() for make in self._make]
        self._asked: List[List[Tuple[str, Tuple[Any, ...], Dict[str, Any]]]] = [[] for _ in self._shares]
        self.num_envs = count
        self.metadata, self.single_observation_space, self.single_action_space = (
            self._read_first(name) for name in ("metadata", "single_observation_space", "single_action_space"))
        self.observation_space = spaces.batch_space(self.single_observation_space, count)
        self.action_space = spaces.batch_space(self.single_action_space, count)
        self.render_mode = None
        self._waits = str(getattr(words.get("autoreset_mode"), "name", words.get("autoreset_mode"))).lower() == "disabled"
        self._has_ended, self._has_seed = np.zeros(count, bool), np.zeros(count, bool)

    def reset(self, *, seed: Any = None,
              options: Optional[Mapping[str, Any]] = None) -> Tuple[Observation, Dict[str, Any]]:
        """As VectorPacking.reset. Environments that never had a seed are given one, by chance."""
        check_options(options, "reset_mask")
        which = reset_mask((options or {}).get("reset_mask"), self.num_envs)
        seeds = seeds_of(seed, self.num_envs)
        for i in np.flatnonzero(which):
            if seeds[i] is None and not self._has_seed[i]:  # what an actor draws by itself could not be drawn again
                seeds[i] = int(np.random.default_rng().integers(2**63))
        self._has_seed |= which
        words = []
        for part, share in enumerate(self._shares):
            given = [seeds[i] for i in share]
            if which[share].all() and all(one is not None for one in given):
                self._asked[part] = []  # nothing of before has an influence any more
            words.append({"seed": given, "options": {"reset_mask": which[share]}})
        observations = [one for one, _ in self._ask("reset", [()] * len(words), words)]
        self._has_ended &= ~which
        return self._joined(observations), {}

    def step(self, actions: Any) -> Tuple[Observation, np.ndarray, np.ndarray, np.ndarray, Dict[str, Any]]:
        """As VectorPacking.step."""
        given = np.asarray(actions)
        if given.shape[:1] != (self.num_envs,):
            raise refused("actions", f"an array of shape {given.shape}", f"one for each of {self.num_envs}")
        if self._waits:
            refuse_ended(self._has_ended)
        answers = self._ask("step", [(given[share],) for share in self._shares], [{}] * len(self._shares))
        observation = self._joined([one[0] for one in answers])
        reward, terminated, truncated = (np.concatenate([one[i] for one in answers]) for i in (1, 2, 3))
        self._has_ended = terminated | truncated
        return observation, reward, terminated, truncated, self._joined_info([one[4] for one in answers])

    def action_masks(self) -> np.ndarray:
        """As VectorPacking.action_masks."""
        return np.concatenate(self._each("call", "action_masks", (), {}))

    @property
    def hashes(self) -> List[int]:
        """As VectorPacking.hashes."""
        return [one for part in self._each("read", "hashes") for one in part]

    def close(self, **_: Any) -> None:
        for actor in self._actors:
            self._ray.kill(actor)
        self._actors = []

    def __repr__(self) -> str:
        return f"<snug.env.RayVectorPacking: {self.num_envs} environments on {len(self._shares)} actors>"

    # Actors

    def _revive(self, part: int) -> None:
        """Another actor in the place of one that is lost, brought to where that one was."""
        self._actors[part] = self._make[part]()
        for name, arguments, words in self._asked[part]:
            self._actors[part].call.remote(name, arguments, words)

    def _get(self, part: int, reference: Any, again: Any) -> Any:
        while True:
            try:
                return self._ray.get(reference)
            except self._ray.exceptions.RayActorError:
                self._revive(part)
                reference = again()

    def _ask(self, name: str, arguments: List[Tuple[Any, ...]], words: List[Dict[str, Any]]) -> List[Any]:
        """A call that changes the environments, of all parts at a time."""
        def send(part: int) -> Any:
            return self._actors[part].call.remote(name, arguments[part], words[part])
        references = [send(part) for part in range(len(self._shares))]
        answers = []
        for part, reference in enumerate(references):
            answers.append(self._get(part, reference, lambda part=part: send(part)))
        for part in range(len(self._shares)):  # once all have answered: one that is refused was not asked
            self._asked[part].append((name, arguments[part], words[part]))
        return answers

    def _each(self, method: str, *given: Any) -> List[Any]:
        def send(part: int) -> Any:
            return getattr(self._actors[part], method).remote(*given)
        references = [send(part) for part in range(len(self._shares))]
        return [self._get(part, reference, lambda part=part: send(part)) for part, reference in enumerate(references)]

    def _read_first(self, name: str) -> Any:
        return self._ray.get(self._actors[0].read.remote(name))

    # Arrays

    @staticmethod
    def _joined(parts: List[Observation]) -> Observation:
        return {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}

    def _joined_info(self, parts: List[Dict[str, Any]]) -> Dict[str, Any]:
        keys = [key for part in parts for key in part]
        info: Dict[str, Any] = {}
        for key in dict.fromkeys(keys):
            examples = [part[key] for part in parts if key in part]
            if isinstance(examples[0], dict):
                info[key] = self._joined_info([part.get(key, {}) for part in parts])
                continue
            dtype = np.asarray(examples[0]).dtype
            blank = "" if key == "reason" else None if dtype == object else 0
            joined = np.full((self.num_envs, *np.shape(examples[0])[1:]), blank, dtype)
            for share, part in zip(self._shares, parts):
                if key in part:
                    joined[share] = part[key]
            info[key] = joined
        return info
