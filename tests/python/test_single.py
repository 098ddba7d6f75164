"""sandwright.ShapeEnv: the Gymnasium contract, states, pictures, refusals."""

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import sandwright


@pytest.mark.parametrize(
    "name",
    [
        "sandwright/Shape-v0",
        "sandwright/ShapeSmall-v0",
        "sandwright/ShapeImage-v0",
        "sandwright/ShapeCells-v0",
    ],
)
def test_gymnasiums_check_passes(name, fast):
    env = gymnasium.make(name, render_mode="rgb_array", **fast)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped)


def test_sb3s_check_passes_on_images_without_a_warning(fast):
    from stable_baselines3.common.env_checker import check_env as sb3_check

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sb3_check(gymnasium.make("sandwright/ShapeImage-v0", **fast).unwrapped)


def test_the_default_world_is_the_shipped_surrogate():
    env = gymnasium.make("sandwright/ShapeSmall-v0")
    env.reset(seed=1)
    heights, goal, cell_m = env.unwrapped.native.maps(0)
    assert cell_m == pytest.approx(0.004)
    assert heights.shape == goal.shape == (75, 75)
    env.step(np.zeros(7, np.float32))


def test_rewards_add_up_to_the_drop_of_the_goal_error(fast):
    env = sandwright.ShapeEnv("small", workcell="", **fast)
    env.reset(seed=3)
    rng = np.random.default_rng(0)
    total, ended = 0.0, False
    while not ended:
        _, reward, terminated, truncated, info = env.step(rng.uniform(-1, 1, 7))
        terms = sum(info["reward_" + term] for term in ("progress", "stroke", "outside", "rejected"))
        assert reward == pytest.approx(terms, abs=1e-5)
        total += info["reward_progress"]
        ended = terminated or truncated
    metrics = info["metrics"]
    drop_mm = metrics["in_goal_mean_diff_start_mm"] - metrics["in_goal_mean_diff_mm"]
    assert total == pytest.approx(drop_mm, abs=1e-6)
    assert metrics["strokes"] == 4


def test_the_gate_refuses_with_reasons(fast):
    env = sandwright.ShapeEnv("small", **fast)
    env.reset(seed=1)
    outside = np.array([-1, -1, -1, 1, 0, 0, 0], np.float32)  # from a corner through the wall
    _, reward, _, _, info = env.step(outside)
    assert not info["accepted"]
    assert len(info["rejected_for"]) > 0
    assert reward < 0


def test_a_restored_state_goes_on_bit_for_bit(fast):
    env, other = sandwright.ShapeEnv("small", **fast), sandwright.ShapeEnv("small", **fast)
    env.reset(seed=5)
    rng = np.random.default_rng(1)
    env.step(rng.uniform(-1, 1, 7))
    shown = other.restore(env.save())
    action = rng.uniform(-1, 1, 7)
    first, second = env.step(action), other.step(action)
    assert shown["map"].shape == first[0]["map"].shape
    np.testing.assert_array_equal(first[0]["map"], second[0]["map"])
    assert first[1] == second[1]


def test_pictures_show_the_sand_and_what_is_missing(fast):
    env = sandwright.ShapeEnv("small", render_mode="rgb_array", **fast)
    env.reset(seed=2)
    before = env.render()
    env.step(np.zeros(7))
    after = env.render()
    assert before.dtype == np.uint8 and before.shape == after.shape and before.shape[2] == 3
    assert (before != after).any()


def test_cells_are_strokes_that_start_in_their_middle(fast):
    env = gymnasium.make("sandwright/ShapeCells-v0", **fast).unwrapped
    env.reset(seed=4)
    sizes = env.action_space.nvec
    mask = env.action_masks()
    assert mask.dtype == bool and mask.shape == (sizes.sum(),)
    starts = mask[: sizes[0]].reshape(16, 16)
    assert starts[8, 8] and not starts.all()  # at a wall no heading is left
    assert mask[sizes[0] :].all()
    boxes = sandwright.ShapeEnv("small", **fast)
    boxes.reset(seed=4)
    cells = env.step(np.array([8 * 16 + 8, 0, 1, 2, 2, 1]))
    same = boxes.step(np.array([1 / 16, 1 / 16, 0, -1 / 3, 1 / 3, 1 / 3, 0]))
    np.testing.assert_allclose(cells[0]["map"], same[0]["map"], atol=1e-5)
    with pytest.raises(ValueError, match="allowed: 0 to 255"):
        env.step(np.array([256, 0, 0, 0, 0, 0]))
    with pytest.raises(ValueError, match='action="cells"'):
        boxes.action_masks()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"scene": "beach"}, "scene 'beach'; allowed: small, box"),
        ({"world": "water"}, "unknown sand model 'water'"),
        ({"observation": "smell"}, "observation 'smell'"),
        ({"action": "dance"}, "action 'dance'; allowed: box, cells"),
        ({"config": {"tusk": 1}}, "tusk"),
        ({"config": {"task": {"max_strokes": 0}}}, "max_strokes"),
        ({"tasks": "missing.h5"}, "missing.h5"),
        ({"workcell": "missing.yaml"}, "missing.yaml"),
        ({"render_mode": "ascii"}, "render_mode 'ascii'"),
    ],
)
def test_bad_arguments_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        sandwright.ShapeEnv(**arguments)


def test_bad_steps_are_refused_and_change_nothing(fast):
    env = sandwright.ShapeEnv("small", **fast)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(7))
    env.reset(seed=1)
    before = env.native.maps(0)[0]
    for action in (np.full(7, np.nan), np.full(7, 1.01), np.zeros(6)):
        with pytest.raises(ValueError):
            env.step(action)
    np.testing.assert_array_equal(env.native.maps(0)[0], before)
    assert env.step(np.full(7, 1 + 1e-7))[1] is not None  # beyond by rounding: the bound
    for _ in range(3):
        env.step(np.zeros(7))
    with pytest.raises(ValueError, match="reset it before a step"):
        env.step(np.zeros(7))
