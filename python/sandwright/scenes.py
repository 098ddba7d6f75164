"""Scenes by name, and the spaces that follow from the native specification."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from gymnasium import spaces

from sandwright._native import NativeEnv

# The keys of the native environment (docs/python.md); the same scenes as configs/train_ppo_*.yaml.
SCENES: dict[str, dict[str, Any]] = {
    "small": {
        "workcell": "workcell_small.yaml",
        "task": {"width_m": 0.3, "depth_m": 0.3, "max_strokes": 10},
    },
    "box": {
        "workcell": "workcell.yaml",
        "task": {
            "width_m": 1.2,
            "depth_m": 0.8,
            "goal_width_m": 0.3,
            "goal_depth_m": 0.3,
            "max_strokes": 12,
        },
        "episode": {"region_width_m": 0.3, "region_depth_m": 0.3},
    },
}
OBSERVATIONS = ("maps", "image")
# What becomes black and white in an image: half ranges of the maps' own scales (50 mm and 20 mm).
IMAGE_CHANNELS = ("height", "goal_difference", "mask", "budget_left")
IMAGE_SIDE = 48


def merge(base: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    """A copy of `base` with the values of `over`, section by section."""
    merged = dict(base)
    for key, value in over.items():
        nested = isinstance(value, dict) and isinstance(merged.get(key), dict)
        merged[key] = merge(merged[key], value) if nested else value
    return merged


def make_native(
    scene: str,
    *,
    num_envs: int,
    autoreset: str,
    threads: int,
    observation: str,
    world: str,
    workcell: str | None,
    tasks: str,
    config: dict[str, Any] | None,
) -> NativeEnv:
    """Raises ValueError naming the scene, key or file, the value and what is allowed."""
    if scene not in SCENES:
        raise ValueError(f"scene {scene!r}; allowed: {', '.join(SCENES)}")
    if observation not in OBSERVATIONS:
        raise ValueError(f"observation {observation!r}; allowed: {', '.join(OBSERVATIONS)}")
    keys = merge(SCENES[scene], {"world": world, "num_envs": num_envs, "threads": threads})
    if workcell is not None:
        keys["workcell"] = workcell
    if tasks:
        keys["tasks"] = str(tasks)
    if observation == "image":
        keys["observation"] = {"rows": IMAGE_SIDE, "columns": IMAGE_SIDE}
    return NativeEnv(json.dumps(merge(keys, config or {})), autoreset)


def action_space(native: NativeEnv) -> spaces.Box:
    return spaces.Box(-1.0, 1.0, (len(native.spec()["actions"]),), np.float32)


def observation_space(native: NativeEnv, observation: str) -> spaces.Space:
    spec = native.spec()
    if observation == "image":
        return spaces.Box(0, 255, (spec["rows"], spec["columns"], len(IMAGE_CHANNELS)), np.uint8)
    shape = (len(spec["channels"]), spec["rows"], spec["columns"])
    limit = spec["map_limit"]
    return spaces.Dict(
        {
            "map": spaces.Box(-limit, limit, shape, np.float32),
            "vec": spaces.Box(0.0, spec["vec_high"], (len(spec["numbers"]),), np.float32),
        }
    )


def show(native: NativeEnv, observation: str, arrays: tuple[np.ndarray, np.ndarray]):
    """What the native arrays (map, vec) of all rows are in the observation space."""
    maps, vec = arrays
    if observation == "image":
        return to_images(native.spec(), maps, vec)
    return {"map": maps, "vec": vec}


def row_of(shown, row: int):
    """One row of what `show` gave."""
    if isinstance(shown, dict):
        return {key: value[row] for key, value in shown.items()}
    return shown[row]


def to_images(spec: dict[str, Any], maps: np.ndarray, vec: np.ndarray) -> np.ndarray:
    """uint8 [N, rows, columns, 4] of IMAGE_CHANNELS; what lies beyond a scale is black or white."""
    channel = {name: i for i, name in enumerate(spec["channels"])}
    budget = vec[:, spec["numbers"].index("budget_left")] * 20 / 255  # strokes, a grey level each
    planes = [
        0.5 + 0.5 * maps[:, channel["height"]],
        0.5 + 0.5 * maps[:, channel["goal_difference"]],
        maps[:, channel["mask"]],
        np.broadcast_to(budget[:, None, None], maps[:, 0].shape),
    ]
    return np.rint(255 * np.clip(np.stack(planes, axis=-1), 0, 1)).astype(np.uint8)
