"""The few spaces that environments need: those of Gymnasium where it is installed, else our own with the same words."""
from __future__ import annotations

from typing import Any, Dict as DictType, Optional, Sequence, Tuple

import numpy as np

try:
    from gymnasium import Env  # type: ignore[import]
    from gymnasium.spaces import Box, Dict, Discrete  # type: ignore[import]
    from gymnasium.utils.seeding import np_random as _np_random  # type: ignore[import]
    from gymnasium.vector import VectorEnv  # type: ignore[import]
    from gymnasium.vector.utils import batch_space  # type: ignore[import]

    HAS_GYMNASIUM = True

    def generator(seed: Optional[int]) -> np.random.Generator:
        """Random numbers of an environment that was reset with a seed."""
        return _np_random(seed)[0]

    def autoreset_mode(mode: str) -> Any:
        """Gymnasium's word for a mode; the text itself before Gymnasium 1.1, which has none."""
        import gymnasium.vector as vector  # type: ignore[import]

        return vector.AutoresetMode[mode.upper()] if hasattr(vector, "AutoresetMode") else mode
except ImportError:
    HAS_GYMNASIUM = False

    class Env:  # type: ignore[no-redef]
        """The base of environments, without Gymnasium."""

        metadata: DictType[str, Any] = {"render_modes": []}
        render_mode: Optional[str] = None
        spec: Any = None

        def reset(self, *, seed: Optional[int] = None, options: Optional[DictType[str, Any]] = None) -> Any:
            if seed is not None or not hasattr(self, "np_random"):
                self.np_random = np.random.default_rng(seed)

        def close(self) -> None:
            """Nothing to be closed."""

        @property
        def unwrapped(self) -> "Env":
            return self

        def __enter__(self) -> "Env":
            return self

        def __exit__(self, *_: Any) -> None:
            self.close()

    class _Space:
        shape: Tuple[int, ...] = ()
        dtype: Any = None

        def __init__(self, seed: Optional[int] = None):
            self._random = np.random.default_rng(seed)

        def seed(self, seed: Optional[int] = None) -> None:
            self._random = np.random.default_rng(seed)

    class Box(_Space):  # type: ignore[no-redef]
        """Arrays of one shape, each number between low and high."""

        def __init__(self, low: Any, high: Any, shape: Optional[Sequence[int]] = None, dtype: Any = np.float32):
            super().__init__()
            self.shape = tuple(shape) if shape is not None else np.shape(low)
            self.dtype = np.dtype(dtype)
            self.low = np.broadcast_to(np.asarray(low, self.dtype), self.shape)
            self.high = np.broadcast_to(np.asarray(high, self.dtype), self.shape)

        def sample(self) -> np.ndarray:
            if np.issubdtype(self.dtype, np.integer):
                return self._random.integers(self.low, self.high, endpoint=True, size=self.shape).astype(self.dtype)
            return self._random.uniform(self.low, self.high).astype(self.dtype)

        def contains(self, x: Any) -> bool:
            x = np.asarray(x)
            return x.shape == self.shape and bool(np.all(x >= self.low) and np.all(x <= self.high))

    class Discrete(_Space):  # type: ignore[no-redef]
        """Whole numbers from 0 to n - 1."""

        def __init__(self, n: int):
            super().__init__()
            self.n = int(n)
            self.dtype = np.dtype(np.int64)

        def sample(self, mask: Optional[np.ndarray] = None) -> int:
            if mask is None or not np.any(mask):
                return int(self._random.integers(self.n))
            return int(self._random.choice(np.flatnonzero(mask)))

        def contains(self, x: Any) -> bool:
            return np.ndim(x) == 0 and 0 <= int(x) < self.n

    class Dict(_Space):  # type: ignore[no-redef]
        """Spaces by name."""

        def __init__(self, spaces: DictType[str, Any]):
            super().__init__()
            self.spaces = dict(spaces)

        def __getitem__(self, key: str) -> Any:
            return self.spaces[key]

        def sample(self) -> DictType[str, Any]:
            return {key: space.sample() for key, space in self.spaces.items()}

        def contains(self, x: Any) -> bool:
            return set(x) == set(self.spaces) and all(space.contains(x[key]) for key, space in self.spaces.items())

    class MultiDiscrete(_Space):
        """Arrays of whole numbers, each from 0 to its `nvec` - 1."""

        def __init__(self, nvec: Any):
            super().__init__()
            self.nvec = np.asarray(nvec, np.int64)
            self.shape = self.nvec.shape
            self.dtype = np.dtype(np.int64)

        def sample(self) -> np.ndarray:
            return self._random.integers(self.nvec)

        def contains(self, x: Any) -> bool:
            x = np.asarray(x)
            return x.shape == self.shape and bool(np.all(x >= 0) and np.all(x < self.nvec))

    class VectorEnv(Env):  # type: ignore[no-redef]
        """The base of vector environments, without Gymnasium."""

        num_envs: int = 0
        closed: bool = False

        def close(self, **_: Any) -> None:
            self.closed = True

    def batch_space(space: Any, n: int) -> Any:
        """The space of n of them, along the first axis."""
        if isinstance(space, Dict):
            return Dict({key: batch_space(part, n) for key, part in space.spaces.items()})
        if isinstance(space, Discrete):
            return MultiDiscrete(np.full(n, space.n))
        return Box(np.stack([space.low] * n), np.stack([space.high] * n), dtype=space.dtype)

    def generator(seed: Optional[int]) -> np.random.Generator:
        """Random numbers of an environment that was reset with a seed."""
        return np.random.default_rng(seed)

    def autoreset_mode(mode: str) -> Any:
        """Gymnasium's word for a mode, where it is installed."""
        return mode
