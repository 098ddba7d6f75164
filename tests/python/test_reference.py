"""The reference tasks of env/reference step by step beside Gymnasium's own."""

import gymnasium
import numpy as np
import pytest

from sandwright._native import ReferenceTask

NAMES = ["CartPole-v1", "Acrobot-v1", "Pendulum-v1", "MountainCarContinuous-v0"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("seed", [0, 42, 2**40 + 7])
def test_equal_to_the_last_bit_of_float32(name, seed):
    theirs, ours = gymnasium.make(name), ReferenceTask(name)
    rng = np.random.default_rng(seed)
    for episode in range(3):
        shown = theirs.reset(seed=seed + episode)[0]
        np.testing.assert_array_equal(ours.reset(seed + episode), shown)
        for _ in range(200):
            if isinstance(theirs.action_space, gymnasium.spaces.Discrete):
                action = int(rng.integers(theirs.action_space.n))
                given = action
            else:  # beyond its bounds now and then
                action = rng.uniform(-2.5, 2.5, 1).astype(np.float32)
                given = action[0]
            shown, reward, terminated, *_ = theirs.unwrapped.step(action)
            mine, my_reward, mine_terminated = ours.step(float(given))
            np.testing.assert_array_equal(mine, shown)
            assert np.float32(my_reward) == np.float32(reward)
            assert mine_terminated == terminated
            if terminated:
                break
