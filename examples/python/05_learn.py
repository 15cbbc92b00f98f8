"""Learns where to put boxes: MaskablePPO of sb3-contrib on generated orders, judged on others. Words: steps (20000), file (learnt.zip).

    pip install sb3-contrib                       # with snug installed
    python 05_learn.py 200000 learnt.zip
    SNUG_PYTHON=$(which python) snug pack box-demonstrator --sequence 1 --agent 05_learn:Learnt      # in this folder

An order is every box of the scenario in an order drawn from a seed. The policy gives each place that the generator found a mark by one small network
that is the same for all of them: what it has learnt of one place holds for the others, too.
"""
import os
import sys
import time

import numpy as np

FEATURES = 13
JUDGED_SEED = 10**6  # of the first order that is judged; orders that are trained on have lower ones


def contact(low, extents, container, boxes):
    """(places,): the part of each place's surface that touches walls, floor or boxes, to a millimetre."""
    high, area, (x, y) = low + extents, np.zeros(len(low)), 0.5 * container[:2]
    walls = [[-9, -9, -9, -x, 9, 9], [x, -9, -9, 9, 9, 9], [-9, -9, -9, 9, -y, 9], [-9, y, -9, 9, 9, 9], [-9, -9, -9, 9, 9, 0]]
    for other in np.array([*walls, *(box[:6] for box in boxes)], float):
        shared = np.clip(np.minimum(high, other[3:]) - np.maximum(low, other[:3]), 0, None)
        for axis in range(3):
            faces = (np.abs(low[:, axis] - other[3 + axis]) < 1e-3).astype(float) + (np.abs(high[:, axis] - other[axis]) < 1e-3)
            area += faces * np.delete(shared, axis, axis=1).prod(axis=1)
    return area / np.maximum(2 * (extents * np.roll(extents, 1, axis=1)).sum(axis=1), 1e-9)  # rows without a place have no size


def features(low, extents, support, item, container, boxes):
    """(places, FEATURES): what the policy sees of each place; lengths as parts of the container's."""
    low, extents, container = (np.asarray(x, float) for x in (low, extents, container))
    middle = low[:, :2] + 0.5 * extents[:, :2]
    half = 0.5 * container[:2]
    gaps = half - np.abs(middle) - 0.5 * extents[:, :2]  # to the nearer wall along each edge
    top = max((box[5] for box in boxes), default=0.0)
    above = low[:, 2] + extents[:, 2]
    filled = sum(float(np.prod(np.subtract(box[3:6], box[:3]))) for box in boxes) / float(np.prod(container))
    same = np.ones(len(low))
    return np.column_stack([
        low[:, 2] / container[2], above / container[2], (above - top) / container[2], extents / container, gaps / container[:2],
        np.asarray(support, float), same * float(np.prod(item[:3])) / np.prod(container) * 10, same * item[3] / 10, same * filled,
        contact(low, extents, container, boxes),
    ]).astype(np.float32)


def make_env(scenario, seed):
    """snug.env.Packing with `features` and the mask as its observation."""
    import gymnasium

    import snug

    class Marked(gymnasium.ObservationWrapper):
        def __init__(self):
            super().__init__(snug.env.Packing(scenario, observation="boxes"))
            places = self.env.observation_space["candidates"].shape[0]
            self.observation_space = gymnasium.spaces.Box(-100, 100, (places, FEATURES), np.float32)
            self.inner_size = scenario.container["inner_size"]
            self.next_seed = seed

        def reset(self, *, seed=None, options=None):  # every episode is an order of its own, known by its number
            seed, self.next_seed = self.next_seed, self.next_seed + 1
            return super().reset(seed=seed, options=options)

        def observation(self, observation):
            places = observation["candidates"]
            boxes = observation["boxes"][observation["boxes"][:, 6] > 0]
            seen = features(places[:, :3], places[:, 3:6], places[:, 6], observation["item"], self.inner_size, boxes)
            return seen * observation["action_mask"][:, None]

        def action_masks(self):
            masks = self.env.action_masks()
            return masks if masks.any() else np.ones_like(masks)  # the episode is over

    return Marked()


def policy_class():
    """One network marks each place; the value is that of the best-marked features in all."""
    import torch
    from sb3_contrib.common.maskable.policies import MaskableActorCriticPolicy
    from stable_baselines3.common.torch_layers import BaseFeaturesExtractor

    class Marks(BaseFeaturesExtractor):
        """(batch, places + 32): a mark for each place, and what the places have in common."""

        def __init__(self, observation_space):
            places = observation_space.shape[0]
            super().__init__(observation_space, places + 32)
            self.mark = torch.nn.Sequential(torch.nn.Linear(FEATURES, 32), torch.nn.Tanh(), torch.nn.Linear(32, 1))
            self.pool = torch.nn.Sequential(torch.nn.Linear(FEATURES, 32), torch.nn.Tanh())

        def forward(self, seen):
            return torch.cat([self.mark(seen)[..., 0], self.pool(seen).mean(dim=1)], dim=1)

    class First(torch.nn.Module):
        """The marks of the places as they are."""

        def __init__(self, places):
            super().__init__()
            self.places = places

        def forward(self, latent):
            return latent[:, :self.places]

    class Policy(MaskableActorCriticPolicy):
        def __init__(self, observation_space, action_space, lr_schedule, **settings):
            settings.update(features_extractor_class=Marks, net_arch=[])
            super().__init__(observation_space, action_space, lr_schedule, **settings)
            self.action_net = First(int(action_space.n))
            self.optimizer = self.optimizer_class(self.parameters(), lr=lr_schedule(1), **self.optimizer_kwargs)

    return Policy


def judge(scenario, choose, episodes):
    """Mean filling [%] and its standard error over orders that nobody trained on."""
    env, filled = make_env(scenario, JUDGED_SEED), []
    for _ in range(episodes):
        seen, _ = env.reset()
        ended = False
        while not ended:
            seen, _, terminated, truncated, info = env.step(choose(seen, env.action_masks()))
            ended = terminated or truncated
        filled.append(info["packed_percent"])
    return float(np.mean(filled)), float(np.std(filled, ddof=1) / np.sqrt(episodes))


def flattest(seen, masks):
    """What a person would write first: the place whose top is lowest, of those the one nearest to the walls."""
    return int(np.lexsort((seen[:, 6] + seen[:, 7], np.round(seen[:, 1], 2), ~masks))[0])


def most_contact(seen, masks):
    """The rule of one line that is hard to beat: the place that touches most."""
    return int(np.lexsort((seen[:, 0], -np.round(seen[:, 12], 6), ~masks))[0])


class Learnt:
    """The agent for `snug pack --agent 05_learn:Learnt`; SNUG_LEARNT names the file (learnt.zip)."""

    def begin(self, settings, container, future):
        from sb3_contrib import MaskablePPO

        self.model = MaskablePPO.load(os.environ.get("SNUG_LEARNT", "learnt.zip"), device="cpu",
                                      custom_objects={"policy_class": policy_class()})
        self.inner_size = container["inner_size"]

    def decide(self, state, item, candidates):
        import torch

        places = self.model.observation_space.shape[0]
        shown = candidates[:places]
        if not shown:
            return []
        boxes = [[*box.low, *box.high] for box in state.boxes]
        seen = np.zeros((1, places, FEATURES), np.float32)
        seen[0, :len(shown)] = features([c.low for c in shown], [c.extents for c in shown], [c.support for c in shown],
                                        [*item.size, item.mass], self.inner_size, boxes)
        with torch.no_grad():
            marks = self.model.policy.extract_features(torch.as_tensor(seen))[0, :len(shown)].numpy()
        return [shown[i] for i in np.argsort(-marks, kind="stable")]


def main(steps=20000, file="learnt.zip", episodes=200):
    import torch
    from sb3_contrib import MaskablePPO
    from stable_baselines3.common.callbacks import BaseCallback
    from stable_baselines3.common.vec_env import DummyVecEnv

    import snug

    torch.set_num_threads(1)
    scenario = snug.load_scenario("box-demonstrator")
    count = 8

    class Curve(BaseCallback):
        def _on_step(self):
            return True

        def _on_rollout_start(self):
            mean, error = judge(scenario, chosen, 20)
            print(f"{self.num_timesteps}\t{mean:.2f}\t{error:.2f}\t{time.process_time() - begin:.0f}", flush=True)

    envs = DummyVecEnv([lambda first=i: make_env(scenario, first * 10**5) for i in range(count)])
    model = MaskablePPO(policy_class(), envs, n_steps=256, batch_size=256, learning_rate=1e-3, gamma=1.0, gae_lambda=0.98,
                        ent_coef=0.005, seed=1, device="cpu")

    def chosen(seen, masks):
        return int(model.predict(seen, action_masks=masks, deterministic=True)[0])

    random = np.random.default_rng(0)
    print("steps\tfilling [%]\tstandard error\tCPU s")
    begin = time.process_time()
    model.learn(int(steps), callback=Curve())
    model.save(file)
    for name, choose in (("learnt", chosen), ("lowest first", lambda _, masks: int(np.argmax(masks))),
                         ("most contact", most_contact), ("flattest, then to the walls", flattest), ("by chance", lambda _, masks: int(random.choice(np.flatnonzero(masks))))):
        mean, error = judge(scenario, choose, int(episodes))
        print(f"{name}: {mean:.2f} +- {error:.2f} % of the container, {episodes} orders")


if __name__ == "__main__":
    main(*sys.argv[1:])
