"""Stable-Baselines3 over the native batch: its VecEnv, and a feature extractor for the maps."""

from __future__ import annotations

import os
import time
from typing import Any

import numpy as np
import torch
from gymnasium import spaces
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.vec_env import VecEnv as BaseVecEnv

from sandwright import scenes
from sandwright.env import RESULT_KEYS


class VecEnv(BaseVecEnv):
    """N environments that start anew in the step that ends them, as Stable-Baselines3 wants them.

    The arguments of scenes.Beds. Infos carry "episode" (as Monitor does), "metrics",
    "terminal_observation" and "TimeLimit.truncated" where an episode ended.
    """

    def __init__(
        self, num_envs: int = 8, scene: str = "small", *, threads: int | None = None, **arguments: Any
    ) -> None:
        self.beds = scenes.Beds(
            scene,
            num_envs=num_envs,
            autoreset="same_step",
            threads=threads or os.cpu_count() or 1,
            **arguments,
        )
        self.native = self.beds.native
        self.render_mode = "rgb_array"
        self._actions = np.zeros(0)
        self._start_s = time.time()
        self._started = False
        super().__init__(num_envs, self.beds.observation_space, self.beds.action_space)

    def reset(self):
        seeds = [
            None if seed is None else int(np.random.SeedSequence(seed).generate_state(1, np.uint64)[0])
            for seed in self._seeds
        ]
        if not self._started:
            seeds = [int(np.random.SeedSequence().generate_state(1, np.uint64)[0]) if s is None else s for s in seeds]
        self._started = True
        self.reset_infos = [{} for _ in range(self.num_envs)]
        shown = self._show(self.native.reset_rows(np.ones(self.num_envs, np.uint8), seeds))
        self._reset_seeds()
        self._reset_options()
        return shown

    def step_async(self, actions: np.ndarray) -> None:
        self._actions = actions

    def step_wait(self):
        step = self.beds.step(self._actions)
        terminated, truncated = step["terminated"].view(bool), step["truncated"].view(bool)
        done = terminated | truncated
        infos: list[dict[str, Any]] = [
            {key: float(step[key][row]) for key in RESULT_KEYS} for row in range(self.num_envs)
        ]
        final = self._show(step["final_observation"]) if done.any() else None
        for row, (episode_return, length, metrics) in zip(
            np.flatnonzero(done), step["finished"], strict=True
        ):
            infos[row].update(
                {
                    "terminal_observation": scenes.row_of(final, row),
                    "TimeLimit.truncated": bool(truncated[row]),
                    "metrics": metrics,
                    "episode": {
                        "r": round(episode_return, 6),
                        "l": length,
                        "t": round(time.time() - self._start_s, 6),
                    },
                }
            )
        return self._show(step["observation"]), step["reward"], done, infos

    def close(self) -> None:
        pass

    def get_images(self) -> list[np.ndarray]:
        return [self.native.render(row, 240) for row in range(self.num_envs)]

    def get_attr(self, attr_name: str, indices=None) -> list[Any]:
        # How sb3-contrib looks for masks: each environment would have the method.
        owner = self.beds if attr_name == "action_masks" else self
        return [getattr(owner, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices=None) -> None:
        raise NotImplementedError("the environments of a native batch have no attributes of their own")

    def env_method(self, method_name: str, *arguments, indices=None, **named) -> list[Any]:
        if method_name != "action_masks":
            raise NotImplementedError(f"{method_name}: a native batch has action_masks alone")
        masks = self.beds.action_masks()
        return [masks[row] for row in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class, indices=None) -> list[bool]:
        # VecEnv.step_wait writes what Monitor would.
        return [wrapper_class.__name__ == "Monitor" for _ in self._get_indices(indices)]

    def _show(self, arrays):
        return self.beds.show(arrays)


class MapExtractor(BaseFeaturesExtractor):
    """Convolutions over `map`, joined with `vec`: for the policy "MultiInputPolicy"."""

    def __init__(self, observation_space: spaces.Dict, features_dim: int = 128) -> None:
        super().__init__(observation_space, features_dim)
        channels, rows, columns = observation_space["map"].shape
        self.convolutions = torch.nn.Sequential(
            torch.nn.Conv2d(channels, 16, 3, stride=2, padding=1),
            torch.nn.ReLU(),
            torch.nn.Conv2d(16, 32, 3, stride=2, padding=1),
            torch.nn.ReLU(),
            torch.nn.Conv2d(32, 32, 3, stride=2, padding=1),
            torch.nn.ReLU(),
            torch.nn.Flatten(),
        )
        with torch.no_grad():
            count = self.convolutions(torch.zeros(1, channels, rows, columns)).shape[1]
        numbers = observation_space["vec"].shape[0]
        self.join = torch.nn.Sequential(torch.nn.Linear(count + numbers, features_dim), torch.nn.ReLU())

    def forward(self, observations: dict[str, torch.Tensor]) -> torch.Tensor:
        seen = self.convolutions(observations["map"])
        return self.join(torch.cat([seen, observations["vec"]], dim=1))
