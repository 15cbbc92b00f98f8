"""What Gymnasium itself says: its checkers, its vector environments as second opinion, its wrappers."""
from pathlib import Path

import numpy as np
import pytest

import snug

gymnasium = pytest.importorskip("gymnasium", minversion="1.1")
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def demonstrator():
    return snug.load_scenario(ROOT / "scenarios" / "box-demonstrator.yaml")


@pytest.mark.filterwarnings("ignore:.*symmetric and normalized space:UserWarning")  # advice: places are in m
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("settings", [{}, {"action": "place"}, {"observation": "both", "sequence": "1"}, {"mode": "statics", "max_steps": 3}])
def test_the_checker_is_content(demonstrator, settings):
    from gymnasium.utils.env_checker import check_env

    check_env(snug.env.Packing(demonstrator, **settings), skip_render_check=True)


@pytest.mark.parametrize("mode", list(gymnasium.vector.AutoresetMode))
def test_it_is_the_vector_environment_of_its_parts(demonstrator, mode):
    count = 3
    ours = snug.env.VectorPacking(demonstrator, count, threads=2, autoreset_mode=mode)
    theirs = gymnasium.vector.SyncVectorEnv([lambda: snug.env.Packing(demonstrator)] * count, autoreset_mode=mode)
    assert isinstance(ours, gymnasium.vector.VectorEnv) and ours.metadata["autoreset_mode"] == mode
    for name in ("single_observation_space", "single_action_space", "observation_space", "action_space"):
        assert getattr(ours, name) == getattr(theirs, name), name
    random, ends = np.random.default_rng(1), 0

    def same(a, b):
        assert set(a) == set(b)
        assert all(np.array_equal(a[key], b[key]) and a[key].dtype == b[key].dtype for key in a)

    for seed in (7, None, [3, None, 5]):
        (a, _), (b, _) = ours.reset(seed=seed), theirs.reset(seed=seed)
        same(a, b)
        for _ in range(40):
            actions = random.integers(np.maximum(ours.action_masks().sum(axis=1), 1))
            a, *rest_a, info_a = ours.step(actions)
            b, *rest_b, info_b = theirs.step(actions)
            same(a, b)
            for one, other in zip(rest_a, rest_b):
                assert np.array_equal(one, other) and one.dtype == other.dtype
            ended = rest_a[1] | rest_a[2]
            ends += ended.sum()
            told_a, told_b = (info["final_info"] if mode.name == "SAME_STEP" and ended.any() else info for info in (info_a, info_b))
            for i in np.flatnonzero(ended):
                assert told_a["reason"][i] == told_b["reason"][i]
                assert told_a["packed_percent"][i] == told_b["packed_percent"][i]
                if mode.name == "SAME_STEP":
                    same(info_a["final_obs"][i], info_b["final_obs"][i])
            if mode.name == "DISABLED" and ended.any():
                (a, _), (b, _) = (one.reset(options={"reset_mask": ended}) for one in (ours, theirs))
                same(a, b)
    assert ends > 10


def test_wrappers_of_vector_environments_take_it(demonstrator):
    from gymnasium.wrappers.vector import RecordEpisodeStatistics

    many = RecordEpisodeStatistics(snug.env.VectorPacking(demonstrator, 2))
    many.reset(seed=1)
    for _ in range(40):
        *_, info = many.step(np.zeros(2, int))
        if "episode" in info:
            ended = np.flatnonzero(info["_episode"])
            assert 100 * info["episode"]["r"][ended] == pytest.approx(info["packed_percent"][ended])
            return
    raise AssertionError("no episode has ended")
