"""Environments: the form of Gymnasium, the three modes, many at once."""
from pathlib import Path

import numpy as np
import pytest

import snug
from snug import env, spaces

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def demonstrator():
    return snug.load_scenario(ROOT / "scenarios" / "box-demonstrator.yaml")


def play(environment, seed, choose=lambda n: 0):
    """Observations and rewards of an episode."""
    observation, info = environment.reset(seed=seed)
    history, total, ended = [observation], 0.0, False
    while not ended:
        observation, reward, terminated, truncated, info = environment.step(choose(info["candidates"]))
        history.append(observation)
        total += reward
        ended = terminated or truncated
    return history, total, info


@pytest.mark.parametrize("mode", ["geometric", "statics", "executed"])
def test_rewards_add_up_to_the_filling_degree(demonstrator, mode):
    environment = env.Packing(demonstrator, mode=mode, sequence="1")
    _, total, info = play(environment, 3)
    assert info["reason"]
    assert 100 * total == pytest.approx(info["packed_percent"])
    assert info["packed_percent"] > 20


@pytest.mark.parametrize("observation", ["height_map", "boxes", "both"])
def test_observations_lie_in_their_space(demonstrator, observation):
    environment = env.Packing(demonstrator, observation=observation)
    history, _, _ = play(environment, 1)
    for seen in history:
        assert environment.observation_space.contains(seen)
        for key, space in environment.observation_space.spaces.items():
            assert seen[key].dtype == space.dtype and seen[key].shape == space.shape


def test_same_seed_same_bytes(demonstrator):
    first, second = env.Packing(demonstrator), env.Packing(demonstrator)
    for seed in (0, 1, 2**31):
        a, total_a, _ = play(first, seed)
        b, total_b, _ = play(second, seed)
        assert total_a == total_b and len(a) == len(b)
        for one, other in zip(a, b):
            assert all(np.array_equal(one[key], other[key]) for key in one)


def test_episodes_differ_without_a_seed_and_repeat_with_it(demonstrator):
    environment = env.Packing(demonstrator)
    items = [environment.reset(seed=5)[0]["item"].tolist()] + [environment.reset()[0]["item"].tolist() for _ in range(5)]
    again = [environment.reset(seed=5)[0]["item"].tolist()] + [environment.reset()[0]["item"].tolist() for _ in range(5)]
    assert items == again
    assert len({tuple(item) for item in items}) > 1


def test_what_a_step_returned_is_not_written_again(demonstrator):
    environment = env.Packing(demonstrator, observation="both")
    observation, _ = environment.reset(seed=1)
    kept = {key: value.copy() for key, value in observation.items()}
    for _ in range(4):
        environment.step(0)
    environment.reset(seed=2)
    assert all(np.array_equal(observation[key], kept[key]) for key in kept)


def test_an_action_that_cannot_be_done_ends_the_episode(demonstrator):
    environment = env.Packing(demonstrator)
    for action in (-1, 10**6, environment.action_space.n - 1):
        environment.reset(seed=1)
        _, reward, terminated, truncated, info = environment.step(action)
        assert terminated and not truncated and reward == 0 and info["reason"]


@pytest.mark.parametrize("action, absurd", [("candidate", 2**70), ("candidate", -(2**70)), ("place", [1e30, 0, 0]), ("place", [-1e30, 0, 0])])
def test_absurd_indices_are_actions_that_cannot_be_done(demonstrator, action, absurd):
    environment = snug.env.Packing(demonstrator, action=action)
    environment.reset(seed=1)
    _, reward, terminated, _, info = environment.step(absurd)
    assert terminated and reward == 0.0 and "there is no such" in info["reason"]


def test_places_are_actions_too(demonstrator):
    environment = env.Packing(demonstrator, action="place")
    observation, _ = environment.reset(seed=1)
    low, size, orientation = (observation["candidates"][0][s] for s in (slice(0, 3), slice(3, 6), 7))
    _, reward, terminated, _, info = environment.step(np.array([orientation, *(low + size / 2)[:2]]))
    assert info["is_placed"] and reward > 0 and not terminated
    environment.reset(seed=1)
    assert environment.step([np.nan, np.nan, np.inf])[2]


def test_truncation(demonstrator):
    environment = env.Packing(demonstrator, max_steps=2)
    environment.reset(seed=1)
    assert environment.step(0)[3] is False
    assert environment.step(0)[2:4] == (False, True)


@pytest.mark.parametrize("mode", ["geometric", "executed"])
def test_a_snapshot_goes_on_with_the_same_bytes(demonstrator, mode):
    environment = env.Packing(demonstrator, mode=mode, sequence="1")
    environment.reset(seed=1)
    environment.step(0)
    snapshot = environment.snapshot()
    environment.step(1)
    after = environment.hash
    for _ in range(2):
        environment.restore(snapshot)
        environment.step(1)
        assert environment.hash == after


def test_executed_boxes_are_where_they_came_to_rest(demonstrator):
    environment = env.Packing(demonstrator, mode="executed", sequence="1")
    environment.reset(seed=1)
    _, reward, _, _, info = environment.step(0)
    assert reward > 0 and info["is_placed"] and info["time"] > 1
    assert 0 < info["displacement"] < 0.02


@pytest.mark.parametrize("mode,steps", [("geometric", 60), ("statics", 12)])
def test_threads_change_nothing(demonstrator, mode, steps):
    def roll(threads):
        many = env.VectorPacking(demonstrator, 6, mode=mode, threads=threads,
                                 parameters=[{"friction_scale": 1 + 0.1 * i, "size_offset": 1e-4 * i} for i in range(6)])
        observation, _ = many.reset(seed=11)
        history = []
        for step in range(steps):
            counts = np.maximum(observation["action_mask"].sum(axis=1), 1)
            observation, reward, terminated, truncated, _ = many.step(step % counts)
            history.append((reward.tolist(), terminated.tolist(), truncated.tolist(), list(many.hashes),
                            observation["height_map"].tobytes()))
        return history

    assert roll(1) == roll(2)


def test_one_of_many_is_what_it_would_be_alone(demonstrator):
    many = env.VectorPacking(demonstrator, 3)
    alone = env.VectorPacking(demonstrator, 1)
    all_three, _ = many.reset(seed=[7, 8, 9])
    one, _ = alone.reset(seed=[8])
    for _ in range(20):
        assert all(np.array_equal(all_three[key][1], one[key][0]) for key in one)
        all_three = many.step(np.zeros(3))[0]
        one = alone.step(np.zeros(1))[0]


def test_last_observations_survive_the_reset_in_the_next_step(demonstrator):
    many = env.VectorPacking(demonstrator, 2)
    many.reset(seed=1)
    for _ in range(100):
        observation, _, terminated, _, _ = many.step([0, 0])
        if terminated.any():
            break
    ended = int(np.argmax(terminated))
    kept = observation["height_map"][ended].copy()
    assert kept.max() > 0 and many.reasons[ended]
    after, reward, terminated, _, _ = many.step([0, 0])
    assert after["height_map"][ended].max() == 0 and reward[ended] == 0 and not terminated[ended]
    assert np.array_equal(observation["height_map"][ended], kept)


def test_vector_arguments_are_checked(demonstrator):
    with pytest.raises(snug.InputError):
        env.VectorPacking(demonstrator, 2, parameters=[{}])
    with pytest.raises(snug.InputError):
        env.VectorPacking(demonstrator, 2, threads=0)
    with pytest.raises(snug.InputError):
        env.VectorPacking(demonstrator, 2, parameters={"colour": 1})
    with pytest.raises(snug.InputError):
        env.VectorPacking(demonstrator, 2).step([0, 0, 0])
    for seed in (-1, 2**64, [0, -3]):
        with pytest.raises(snug.InputError, match="whole numbers from 0"):
            snug.env.VectorPacking(demonstrator, 2).reset(seed=seed)


def test_spaces_sample_and_know_what_they_hold():
    box = spaces.Box(-1.0, 1.0, (3,), np.float32)
    assert box.contains(box.sample()) and not box.contains(np.full(3, 2.0, np.float32))
    four = spaces.Discrete(4)
    assert {four.sample() for _ in range(100)} == {0, 1, 2, 3} and not four.contains(4)
    both = spaces.Dict({"box": box, "four": four})
    assert both.contains(both.sample())


def items_of(reset):
    return reset[0]["item"].tolist()


def test_vector_resets_go_on_without_a_seed_and_repeat_with_it(demonstrator):
    many, again = env.VectorPacking(demonstrator, 3), env.VectorPacking(demonstrator, 3)
    first = [items_of(many.reset(seed=5)), items_of(many.reset()), items_of(many.reset(seed=None, options=None))]
    assert first == [items_of(again.reset(seed=[5, 6, 7])), items_of(again.reset()), items_of(again.reset(options={}))]
    assert first[0] != first[1] != first[2]
    # Without any seed chance decides: of 3^4 items in two runs, all equal with probability 15^-12.
    fresh = [[items_of(env.VectorPacking(demonstrator, 3).reset()) for _ in range(4)] for _ in range(2)]
    assert fresh[0] != fresh[1]


def test_one_of_many_has_the_episodes_of_packing(demonstrator):
    many, one = env.VectorPacking(demonstrator, 2), env.Packing(demonstrator)
    seen, _ = many.reset(seed=3)
    alone, _ = one.reset(seed=4)
    for _ in range(60):
        assert all(np.array_equal(seen[key][1], alone[key]) for key in alone)
        assert np.array_equal(many.action_masks()[1], one.action_masks())
        assert np.array_equal(alone["action_mask"].astype(bool), one.action_masks())
        seen, reward, terminated, _, info = many.step([0, 0])
        if alone_ended := one._core.has_ended:
            alone, _ = one.reset()
            assert reward[1] == 0.0 and not terminated[1]
        else:
            alone, alone_reward, alone_terminated, _, alone_info = one.step(0)
            assert (reward[1], terminated[1]) == (alone_reward, alone_terminated)
            if alone_terminated:
                assert info["_reason"][1] and info["reason"][1] == alone_info["reason"]
                assert info["packed_percent"][1] == alone_info["packed_percent"]
    assert not alone_ended or one._core.packed_percent == 0


def test_reset_mask_begins_those_anew_and_no_others(demonstrator):
    many = env.VectorPacking(demonstrator, 3)
    many.reset(seed=1)
    many.step([0, 0, 0])
    before = many.hashes
    seen, _ = many.reset(options={"reset_mask": np.array([False, True, False])})
    after = many.hashes
    assert (after[0], after[2]) == (before[0], before[2]) and after[1] != before[1]
    assert many.packed_percent[1] == 0 < many.packed_percent[0] and seen["height_map"][1].max() == 0
    for options in ({"reset_mask": [1, 0, 0]}, {"reset_mask": np.ones(2, bool)}, {"reset_msk": None}):
        with pytest.raises(snug.InputError, match="reset_m"):
            many.reset(options=options)
    with pytest.raises(snug.InputError, match="options"):
        env.Packing(demonstrator).reset(options={"seed": 1})


def roll_to_an_end(many):
    observation, _ = many.reset(seed=1)
    for _ in range(100):
        observation, reward, terminated, truncated, info = many.step([0, 0])
        if (terminated | truncated).any():
            return observation, reward, terminated | truncated, info
    raise AssertionError("no episode has ended")


def test_same_step_resets_return_the_last_observation_in_info(demonstrator):
    expected, _, ended, _ = roll_to_an_end(env.VectorPacking(demonstrator, 2))
    many = env.VectorPacking(demonstrator, 2, autoreset_mode="same_step")
    seen, _, also_ended, info = roll_to_an_end(many)
    assert np.array_equal(ended, also_ended) and np.array_equal(info["_final_obs"], ended)
    for i in range(2):
        if not ended[i]:
            assert info["final_obs"][i] is None
            continue
        assert all(np.array_equal(info["final_obs"][i][key], expected[key][i]) for key in expected)
        assert seen["height_map"][i].max() == 0 and info["final_info"]["packed_percent"][i] > 20
    many.step([0, 0])
    assert (many.packed_percent[ended] > 0).all()  # the first box of the new episode


def test_without_autoreset_the_ended_wait_for_their_reset(demonstrator):
    many = env.VectorPacking(demonstrator, 2, autoreset_mode="disabled")
    _, _, ended, _ = roll_to_an_end(many)
    with pytest.raises(snug.InputError, match="have ended"):
        many.step([0, 0])
    many.reset(options={"reset_mask": ended})
    many.step([0, 0])
    with pytest.raises(snug.InputError, match="next_step"):
        env.VectorPacking(demonstrator, 2, autoreset_mode="later")


def test_vector_spaces_hold_what_is_observed(demonstrator):
    for action in ("candidate", "place"):
        many = env.VectorPacking(demonstrator, 3, action=action, observation="both")
        observation, _ = many.reset(seed=1)
        assert many.observation_space.contains(observation)
        assert many.action_space.contains(many.action_space.sample())
        many.step(many.action_space.sample())
        assert "3 environments" in repr(many)
        many.close()


def test_the_planned_interference_is_read_under_its_earlier_name_too(demonstrator):
    played = [play(env.Packing(demonstrator, mode="geometric", sequence="1", **{key: value}), 3)[1]
              for key, value in (("planned_interference", 0.003), ("squeeze", 0.003))]
    assert played[0] == played[1]
