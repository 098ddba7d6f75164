"""Scenes by name, and native beds of sand with the spaces that follow from their specification."""

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
        "observation": {"reach": True},
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
        "observation": {"reach": True},
    },
}
OBSERVATIONS = ("maps", "image")
ACTIONS = ("box", "cells")
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


class Beds:
    """N native beds of sand, and how a library of agents sees them.

    scene: "small" (300 x 300 mm) or "box" (1200 x 800 mm, goals of 300 x 300 mm in it).
    world: "default" or "fast" (the shipped surrogates), "heightfield", "dem", "none", a .safetensors file, or
        several of these separated by commas: each bed is one of them.
    workcell: whose arm's gate refuses strokes; None: the scene's, "": no arm.
    tasks: a task file to draw from; "": tasks without end.
    observation: "maps", Dict(map float32 [6, rows, columns], vec float32 [4]), or "image", uint8.
    action: "box", seven numbers in [-1, 1], or "cells", MultiDiscrete with `action_masks`.
    config: further keys, nested by section (docs/python.md).
    ValueError names a wrong argument or key, its value and what is allowed.
    """

    def __init__(
        self,
        scene: str = "small",
        *,
        num_envs: int,
        autoreset: str,
        threads: int = 1,
        world: str = "default",
        workcell: str | None = None,
        tasks: str = "",
        observation: str = "maps",
        action: str = "box",
        config: dict[str, Any] | None = None,
    ) -> None:
        for name, value, allowed in (
            ("scene", scene, SCENES),
            ("observation", observation, OBSERVATIONS),
            ("action", action, ACTIONS),
        ):
            if value not in allowed:
                raise ValueError(f"{name} {value!r}; allowed: {', '.join(allowed)}")
        keys = merge(SCENES[scene], {"world": world, "num_envs": num_envs, "threads": threads})
        if workcell is not None:
            keys["workcell"] = workcell
        if tasks:
            keys["tasks"] = str(tasks)
        if observation == "image":
            keys["observation"] = {"rows": IMAGE_SIDE, "columns": IMAGE_SIDE}
        self.native = NativeEnv(json.dumps(merge(keys, config or {})), autoreset)
        self.num_envs = num_envs
        self._spec = self.native.spec()
        self._image = observation == "image"
        self._cells = action == "cells"

    @property
    def action_space(self) -> spaces.Space:
        if self._cells:
            return spaces.MultiDiscrete(self._spec["cell_actions"])
        return spaces.Box(-1.0, 1.0, (len(self._spec["actions"]),), np.float32)

    @property
    def observation_space(self) -> spaces.Space:
        spec = self._spec
        if self._image:
            shape = (spec["rows"], spec["columns"], len(IMAGE_CHANNELS))
            return spaces.Box(0, 255, shape, np.uint8)
        shape = (len(spec["channels"]), spec["rows"], spec["columns"])
        limit = spec["map_limit"]
        return spaces.Dict(
            {
                "map": spaces.Box(-limit, limit, shape, np.float32),
                "vec": spaces.Box(0.0, spec["vec_high"], (len(spec["numbers"]),), np.float32),
            }
        )

    def step(self, actions: np.ndarray) -> dict[str, Any]:
        """One stroke of each bed: what the native step gives, by name."""
        if self._cells:
            return self.native.step_cells(np.ascontiguousarray(actions, np.int64))
        return self.native.step(np.ascontiguousarray(actions, np.float32))

    def action_masks(self) -> np.ndarray:
        """bool [N, sum of the choices]: where the arm cannot start a stroke is False."""
        if not self._cells:
            raise ValueError('action_masks is for action="cells"; this environment has "box"')
        starts = self.native.start_masks().view(bool)
        rest = sum(self._spec["cell_actions"][1:])
        return np.concatenate([starts, np.ones((self.num_envs, rest), bool)], axis=1)

    def show(self, arrays: tuple[np.ndarray, np.ndarray]):
        """What the native arrays (map, vec) of all rows are in the observation space."""
        maps, vec = arrays
        return to_images(self._spec, maps, vec) if self._image else {"map": maps, "vec": vec}


def row_of(shown, row: int):
    """One row of what Beds.show gave."""
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
