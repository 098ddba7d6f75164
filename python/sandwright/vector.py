"""N sand beds stepped together in C++ as a gymnasium.vector.VectorEnv."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from sandwright import scenes
from sandwright.env import RESULT_KEYS, ShapeEnv

_AUTORESET = {
    AutoresetMode.SAME_STEP: "same_step",
    AutoresetMode.NEXT_STEP: "next_step",
    AutoresetMode.DISABLED: "disabled",
}


class ShapeVectorEnv(VectorEnv):
    """The arguments of scenes.Beds; one call of the sand model a step for all environments.

    Environment i of reset(seed=s) is a ShapeEnv of reset(seed=s + i), whatever num_envs and threads.
    reset(options={"reset_mask": bool [num_envs]}) starts those environments anew and leaves the others.
    """

    metadata = {**ShapeEnv.metadata, "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int = 1,
        scene: str = "small",
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        render_mode: str | None = None,
        **arguments: Any,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode {render_mode!r}; allowed for many beds: rgb_array")
        self.render_mode = render_mode
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {**self.metadata, "autoreset_mode": self.autoreset_mode}
        self.beds = scenes.Beds(
            scene,
            num_envs=num_envs,
            autoreset=_AUTORESET[self.autoreset_mode],
            threads=threads or os.cpu_count() or 1,
            **arguments,
        )
        self.native = self.beds.native
        self.num_envs = num_envs
        self.single_action_space = self.beds.action_space
        self.single_observation_space = self.beds.observation_space
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._started = False

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ):
        mask = self._reset_mask(options)
        seeds = self._engine_seeds(seed)
        self._started = True
        return self._show(self.native.reset_rows(mask.view(np.uint8), seeds)), {}

    def step(self, actions: np.ndarray):
        if not self._started:
            raise gymnasium.error.ResetNeeded("step: call reset first")
        step = self.beds.step(actions)
        terminated, truncated = step["terminated"].view(bool), step["truncated"].view(bool)
        stepped = step["stepped"].view(bool)
        infos: dict[str, Any] = {}
        for key in RESULT_KEYS:
            infos[key], infos["_" + key] = step[key], stepped.copy()
        infos["accepted"], infos["_accepted"] = step["accepted"].view(bool), stepped.copy()
        ended = np.flatnonzero(terminated | truncated)
        for row, (_, _, metrics) in zip(ended, step["finished"], strict=True):
            infos = self._add_info(infos, {"metrics": metrics}, int(row))
        if self.autoreset_mode == AutoresetMode.SAME_STEP and len(ended) > 0:
            self._add_final(step["final_observation"], ended, infos)
        return (
            self._show(step["observation"]),
            step["reward"].astype(np.float64),
            terminated,
            truncated,
            infos,
        )

    def action_masks(self) -> np.ndarray:
        """bool [num_envs, sum of the choices], of action="cells"."""
        return self.beds.action_masks()

    def render(self):
        """One picture an environment."""
        if self.render_mode is None:
            return None
        return tuple(self.native.render(row, 240) for row in range(self.num_envs))

    def save(self):
        """The states of all worlds, to `restore` here or in another environment like this one."""
        return self.native.save()

    def restore(self, state):
        """Goes on from saved states, bit for bit. Returns what they show."""
        self._started = True
        return self._show(self.native.restore(state))

    def _engine_seeds(self, seed) -> list[int | None]:
        if seed is None:
            if self._started:
                return [None] * self.num_envs  # each goes on with its next episode
            seed = int(self.np_random.integers(0, 2**31))
        if np.ndim(seed) == 0:
            self._np_random, self._np_random_seed = seeding.np_random(int(seed))
            seed = [int(seed) + i for i in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise ValueError(f"reset: {len(seed)} seeds for {self.num_envs} environments")
        return [None if s is None else self._engine_seed(int(s)) for s in seed]

    @staticmethod
    def _engine_seed(seed: int) -> int:
        # As ShapeEnv.reset draws it.
        return int(seeding.np_random(seed)[0].integers(0, 2**64, dtype=np.uint64))

    def _reset_mask(self, options: dict[str, Any] | None) -> np.ndarray:
        mask = (options or {}).get("reset_mask")
        if mask is None:
            return np.ones(self.num_envs, bool)
        if not isinstance(mask, np.ndarray) or mask.dtype != bool or mask.shape != (self.num_envs,):
            raise ValueError(f"reset_mask must be a bool array of shape ({self.num_envs},)")
        if not mask.any():
            raise ValueError("reset_mask chooses no environment")
        return mask.copy()

    def _add_final(self, shown, ended: np.ndarray, infos: dict[str, Any]) -> None:
        final = self._show(shown)
        done = np.zeros(self.num_envs, bool)
        done[ended] = True
        observations = np.full(self.num_envs, None, object)
        for row in ended:
            observations[row] = scenes.row_of(final, row)
        infos["final_obs"], infos["_final_obs"] = observations, done
        infos["final_info"] = {
            key: value for key, value in infos.items() if key not in ("final_obs", "_final_obs")
        }
        infos["_final_info"] = done.copy()

    def _show(self, arrays):
        return self.beds.show(arrays)
