"""sandwright.ShapeVectorEnv: rows against single environments, the three ways to start anew."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import RecordEpisodeStatistics

import sandwright


def make(mode, fast, num_envs=3, **more):
    return sandwright.ShapeVectorEnv(num_envs, "small", autoreset_mode=mode, **fast, **more)


def test_a_row_is_a_single_environment_whatever_the_threads(fast):
    envs = make(AutoresetMode.DISABLED, fast, threads=2)
    singles = [sandwright.ShapeEnv("small", **fast) for _ in range(3)]
    shown, _ = envs.reset(seed=10)
    alone = [single.reset(seed=10 + i)[0] for i, single in enumerate(singles)]
    rng = np.random.default_rng(2)
    for _ in range(4):
        for i in range(3):
            np.testing.assert_array_equal(shown["map"][i], alone[i]["map"])
            np.testing.assert_array_equal(shown["vec"][i], alone[i]["vec"])
        actions = rng.uniform(-1, 1, (3, 7)).astype(np.float32)
        shown, rewards, terminated, _, infos = envs.step(actions)
        for i, single in enumerate(singles):
            alone[i], reward, ended, _, info = single.step(actions[i])
            assert rewards[i] == reward
            assert terminated[i] == ended
            assert infos["goal_error_mm"][i] == info["goal_error_mm"]


def test_same_step_shows_the_end_apart(fast):
    envs = make(AutoresetMode.SAME_STEP, fast)
    other = make(AutoresetMode.NEXT_STEP, fast)
    envs.reset(seed=1), other.reset(seed=1)
    actions = np.zeros((3, 7), np.float32)
    for _ in range(4):
        shown, _, terminated, _, infos = envs.step(actions)
        last = other.step(actions)[0]
    assert terminated.all()
    assert infos["_final_obs"].all()
    np.testing.assert_array_equal(infos["final_obs"][1]["map"], last["map"][1])
    assert infos["final_info"]["metrics"]["strokes"].tolist() == [4, 4, 4]
    # The next step there starts anew, ignores its action, and shows what SAME_STEP showed at once.
    anew, rewards, terminated, truncated, infos = other.step(np.ones((3, 7), np.float32))
    np.testing.assert_array_equal(anew["map"], shown["map"])
    assert not rewards.any() and not terminated.any() and not truncated.any()
    assert not infos["_goal_error_mm"].any()


def test_a_reset_mask_starts_some_anew(fast):
    envs = make(AutoresetMode.DISABLED, fast)
    first, _ = envs.reset(seed=4)
    mask = np.array([False, True, False])
    shown, _ = envs.reset(options={"reset_mask": mask})
    np.testing.assert_array_equal(shown["map"][0], first["map"][0])
    assert (shown["map"][1] != first["map"][1]).any()
    again, _ = envs.reset(seed=[None, 5, None], options={"reset_mask": mask})
    np.testing.assert_array_equal(again["map"][1], first["map"][1])  # 4 + 1
    for bad in (np.zeros(3, bool), np.ones(2, bool), [True, False, False]):
        with pytest.raises(ValueError, match="reset_mask"):
            envs.reset(options={"reset_mask": bad})
    for _ in range(4):
        envs.step(np.zeros((3, 7), np.float32))
    with pytest.raises(ValueError, match="reset it before a step"):
        envs.step(np.zeros((3, 7), np.float32))


def test_make_vec_and_gymnasiums_wrappers(fast):
    envs = gymnasium.make_vec(
        "sandwright/ShapeSmall-v0",
        num_envs=3,
        vectorization_mode="vector_entry_point",
        **fast,
    )
    assert isinstance(envs.unwrapped, sandwright.ShapeVectorEnv)
    envs = RecordEpisodeStatistics(envs)
    observation, _ = envs.reset(seed=0)
    assert envs.observation_space.contains(observation)
    for _ in range(4):
        envs.action_space.seed(1)
        observation, rewards, *_, infos = envs.step(envs.action_space.sample())
        assert envs.observation_space.contains(observation)
    assert infos["episode"]["l"].tolist() == [4, 4, 4]


def test_states_of_all_rows_go_on_bit_for_bit(fast):
    envs, other = make(AutoresetMode.SAME_STEP, fast), make(AutoresetMode.SAME_STEP, fast)
    envs.reset(seed=7)
    rng = np.random.default_rng(3)
    envs.step(rng.uniform(-1, 1, (3, 7)))
    other.restore(envs.save())
    for _ in range(6):
        actions = rng.uniform(-1, 1, (3, 7))
        first, second = envs.step(actions), other.step(actions)
        np.testing.assert_array_equal(first[0]["map"], second[0]["map"])
        np.testing.assert_array_equal(first[1], second[1])
