"""The reference tasks of env/reference step by step beside Gymnasium's own."""

from pathlib import Path

import gymnasium
import mujoco
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from sandwright._native import ReferenceVecEnv, reference_task_names, standard_normals

ROOT = Path(__file__).parents[2]
COUNT, SEEDS = 3, [0, 42, 2**40 + 7]


class Pair:
    """The same environments from Gymnasium and from us, stepped by the same actions."""

    def __init__(self, name, threads=1):
        self.theirs = gymnasium.make_vec(
            name, COUNT, "sync", vector_kwargs={"autoreset_mode": AutoresetMode.SAME_STEP}
        )
        self.ours = ReferenceVecEnv(name, COUNT, threads)
        self.spec = self.ours.spec()

    def reset(self, seed):
        shown = self.theirs.reset(seed=seed)[0].astype(np.float32)
        np.testing.assert_array_equal(self.ours.reset(seed), shown)

    def step(self, actions):
        """Takes actions of Gymnasium's; returns which episodes were terminated, which truncated."""
        given = np.float32(actions).reshape(COUNT, -1) / np.float32(self.spec["action_limit"])
        shown, reward, terminated, truncated, infos = self.theirs.step(actions)
        mine, my_reward, my_terminated, my_truncated, my_final = self.ours.step(given)
        np.testing.assert_array_equal(mine, shown.astype(np.float32))
        np.testing.assert_array_equal(my_reward, reward.astype(np.float32))
        np.testing.assert_array_equal(my_terminated, terminated)
        np.testing.assert_array_equal(my_truncated, truncated & ~terminated)
        for i in range(COUNT):
            ended = terminated[i] or truncated[i]
            last = np.float32(infos["final_obs"][i]) if ended else np.zeros_like(mine[i])
            np.testing.assert_array_equal(my_final[i], last)
        return terminated, truncated

    def actions(self, rng):
        """Random ones, beyond the bounds now and then."""
        if self.spec["choices"]:
            return rng.integers(self.spec["choices"], size=COUNT)
        limit = 1.25 * self.spec["action_limit"]
        return rng.uniform(-limit, limit, (COUNT, self.spec["action_size"])).astype(np.float32)


@pytest.mark.filterwarnings("ignore:.*out of date")  # v4
@pytest.mark.parametrize("name", reference_task_names())
@pytest.mark.parametrize("seed", SEEDS)
def test_equal_to_the_last_bit_of_float32(name, seed):
    pair, rng = Pair(name), np.random.default_rng(seed)
    pair.reset(seed)
    for _ in range(400):
        pair.step(pair.actions(rng))
    pair.reset(seed + 1)  # in the middle of an episode
    pair.step(pair.actions(rng))


@pytest.mark.parametrize("name", ["Pendulum-v1", "Acrobot-v1", "HalfCheetah-v5"])
def test_episodes_are_cut_off_where_gymnasium_cuts_them_off(name):
    pair, rng = Pair(name), np.random.default_rng(0)
    pair.reset(5)
    cut = np.zeros(COUNT, int)
    for _ in range(pair.spec["max_steps"] + 10):
        rest = np.ones(COUNT, int) if pair.spec["choices"] else 0 * pair.actions(rng)
        cut += pair.step(rest)[1]
    np.testing.assert_array_equal(cut, 1)


def test_fallen_hoppers_are_paid_by_version_4_alone():
    last = {}
    for name in ("Hopper-v4", "Hopper-v5"):
        env, terminated = ReferenceVecEnv(name, 1), [0]
        env.reset(3)
        while not terminated[0]:
            _, last[name], terminated, _, _ = env.step(np.ones((1, 3), np.float32))
    assert last["Hopper-v4"] - last["Hopper-v5"] == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize("seed", SEEDS)
def test_normals_are_numpys(seed):
    count = 1_000_000
    theirs = np.random.default_rng(seed).standard_normal(count)
    np.testing.assert_array_equal(standard_normals(seed, count), theirs)


@pytest.mark.parametrize("name, total_kg", [("half_cheetah", 14), ("hopper", None)])
def test_the_models_are_gymnasiums(name, total_kg):
    assets = Path(gymnasium.__file__).parent / "envs/mujoco/assets"
    theirs = mujoco.MjModel.from_xml_path(str(assets / f"{name}.xml"))
    ours = mujoco.MjModel.from_xml_path(str(ROOT / f"env/reference/{name}.xml"))
    if total_kg:
        mujoco.mj_setTotalmass(ours, total_kg)
        mujoco.mj_setConst(ours, mujoco.MjData(ours))
    unseen = ("tex", "mat_", "light", "cam_", "name", "geom_rgba", "geom_matid", "geom_user")
    sizes = ("narena", "nbuffer", "ncam", "nlight", "nmat", "nnames", "ntex", "nuser_geom", "signature")
    compared = 0
    for part in ("", "opt"):  # MuJoCo: `stat` does not affect the simulation
        model, other = (getattr(m, part) if part else m for m in (theirs, ours))
        for field in dir(model):
            value = getattr(model, field)
            if field.startswith(unseen + sizes + ("_",)) or not isinstance(value, (int, float, np.ndarray)):
                continue
            np.testing.assert_array_equal(value, getattr(other, field), err_msg=field)
            compared += 1
    assert compared > 300


@pytest.mark.parametrize("name", ["CartPole-v1", "HalfCheetah-v5"])
def test_results_do_not_depend_on_the_thread_count(name):
    envs = [ReferenceVecEnv(name, 7, threads) for threads in (1, 2, 3, 16)]
    size = envs[0].spec()["action_size"]
    rng = np.random.default_rng(1)
    for env in envs:
        env.reset(1)
    for _ in range(60):
        actions = rng.integers(0, 2, (7, size)).astype(np.float32)
        results = [env.step(actions) for env in envs]
        for other in results[1:]:
            for a, b in zip(results[0], other):
                np.testing.assert_array_equal(a, b)


def test_bad_input_is_refused_and_changes_nothing():
    with pytest.raises(ValueError, match="unknown task 'Sandpit-v0'; allowed: CartPole-v1, "):
        ReferenceVecEnv("Sandpit-v0", 1)
    with pytest.raises(ValueError, match="CartPole-v1: 0 environments; allowed: 1 or more"):
        ReferenceVecEnv("CartPole-v1", 0)
    with pytest.raises(ValueError, match="CartPole-v1: 0 threads; allowed: 1 or more"):
        ReferenceVecEnv("CartPole-v1", 1, 0)
    for name, bad, message in [
        ("CartPole-v1", 2, "CartPole-v1: action 2; allowed: 0..1, whole"),
        ("CartPole-v1", 0.5, "CartPole-v1: action 0.5; allowed"),
        ("CartPole-v1", np.nan, "CartPole-v1: action nan; allowed"),
        ("Hopper-v5", np.nan, "Hopper-v5: action nan; allowed: finite numbers"),
        ("Pendulum-v1", np.inf, "Pendulum-v1: action inf; allowed: finite numbers"),
    ]:
        env, other = ReferenceVecEnv(name, 2), ReferenceVecEnv(name, 2)
        good = np.ones((2, env.spec()["action_size"]), np.float32)
        actions = good.copy()
        actions[1, -1] = bad
        with pytest.raises(ValueError, match=message):
            env.step(actions)
        with pytest.raises(ValueError, match=r"step: actions of shape \[2, 9\]; expected \[2, "):
            env.step(np.zeros((2, 9), np.float32))
        with pytest.raises(TypeError):
            env.step(np.zeros(2, np.float32))
        # A step before the first reset goes on from reset(0).
        other.reset(0)
        for a, b in zip(env.step(good), other.step(good)):
            np.testing.assert_array_equal(a, b)
