"""sandwright.sb3: the contract of Stable-Baselines3, and that its PPO learns on it."""

import numpy as np
import torch
from stable_baselines3 import PPO

from sandwright.sb3 import MapExtractor, VecEnv


def test_ends_carry_the_last_observation(fast):
    envs = VecEnv(3, **fast)
    envs.seed(3)
    envs.reset()
    for _ in range(4):
        observation, rewards, dones, infos = envs.step(np.zeros((3, 7), np.float32))
    assert dones.all()
    assert rewards.dtype == np.float32
    for row, info in enumerate(infos):
        assert info["terminal_observation"]["map"].shape == observation["map"][row].shape
        assert (info["terminal_observation"]["vec"] != observation["vec"][row]).any()
        assert info["TimeLimit.truncated"] is False
        assert info["episode"]["l"] == 4


def test_the_same_seed_gives_the_same_bytes(fast):
    shown = []
    for _ in range(2):
        envs = VecEnv(2, **fast)
        envs.seed(8)
        shown.append(envs.reset()["map"])
    np.testing.assert_array_equal(shown[0], shown[1])


def test_masks_are_found_as_sb3_contrib_looks_for_them(fast):
    envs = VecEnv(2, action="cells", **fast)
    envs.seed(8)
    envs.reset()
    assert envs.has_attr("action_masks")  # is_masking_supported
    masks = np.stack(envs.env_method("action_masks"))  # get_action_masks
    assert masks.shape == (2, envs.action_space.nvec.sum())
    envs.step(np.zeros((2, 6), np.int64))


def test_ppo_learns(fast):
    """Random strokes do harm; PPO unlearns that within some thousand of them."""
    torch.set_num_threads(1)  # more of them wait for each other where other work runs
    envs = VecEnv(16, workcell="", **fast)
    envs.seed(1)
    agent = PPO(
        "MultiInputPolicy",
        envs,
        n_steps=32,
        batch_size=128,
        n_epochs=5,
        learning_rate=1e-3,
        gamma=0.9,
        policy_kwargs={
            "features_extractor_class": MapExtractor,
            "features_extractor_kwargs": {"features_dim": 64},
        },
        seed=1,
    )
    returns = []

    def keep(values, _):
        returns.extend(info["episode"]["r"] for info in values["infos"] if "episode" in info)
        return True

    agent.learn(8192, callback=lambda values, names: keep(values, names))
    first, last = np.mean(returns[:300]), np.mean(returns[-300:])
    assert last > first + 0.5 * abs(first), (first, last)
