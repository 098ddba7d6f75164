"""One sand bed as a gymnasium.Env."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from sandwright import scenes

RESULT_KEYS = (
    "goal_error_mm",
    "moved_volume_cm3",
    "reward_progress",
    "reward_stroke",
    "reward_outside",
    "reward_rejected",
)


class ShapeEnv(gymnasium.Env):
    """Seven numbers in [-1, 1] are a stroke of the blade; the goal error's drop is its reward.

    scene: "small" (300 x 300 mm) or "box" (1200 x 800 mm, goals of 300 x 300 mm in it).
    world: "default" or "fast" (the shipped surrogates), "heightfield", "dem", "none" or a .safetensors file.
    workcell: whose arm's gate refuses strokes; None: the scene's, "": no arm.
    tasks: a task file to draw from; "": tasks without end.
    observation: "maps", Dict(map float32 [5, rows, columns], vec float32 [4]), or "image", uint8.
    config: further keys, nested by section (docs/python.md).
    ValueError names a wrong argument or key, its value and what is allowed.
    """

    metadata = {"render_modes": ["rgb_array", "human"], "render_fps": 4}

    def __init__(
        self,
        scene: str = "small",
        *,
        world: str = "default",
        workcell: str | None = None,
        tasks: str = "",
        observation: str = "maps",
        render_mode: str | None = None,
        config: dict[str, Any] | None = None,
    ) -> None:
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            raise ValueError(f"render_mode {render_mode!r}; allowed: rgb_array, human")
        self.render_mode = render_mode
        self.native = scenes.make_native(
            scene,
            num_envs=1,
            autoreset="disabled",
            threads=1,
            observation=observation,
            world=world,
            workcell=workcell,
            tasks=tasks,
            config=config,
        )
        self._observation = observation
        self.action_space = scenes.action_space(self.native)
        self.observation_space = scenes.observation_space(self.native, observation)
        self._started = False
        self._window = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None):
        super().reset(seed=seed)
        if seed is not None or not self._started:
            engine_seed = int(self.np_random.integers(0, 2**64, dtype=np.uint64))
            shown = self.native.reset(engine_seed)
        else:
            shown = self.native.reset_rows(np.ones(1, np.uint8), [None])
        self._started = True
        if self.render_mode == "human":
            self.render()
        return self._show(shown), {}

    def step(self, action: np.ndarray):
        if not self._started:
            raise gymnasium.error.ResetNeeded("step: call reset first")
        step = self.native.step(np.asarray(action, np.float32).reshape(1, -1))
        info = {key: float(step[key][0]) for key in RESULT_KEYS}
        info["accepted"] = bool(step["accepted"][0])
        info["rejected_for"] = step["rejected_for"][0] or []
        if step["finished"]:
            info["metrics"] = step["finished"][0][2]
        if self.render_mode == "human":
            self.render()
        return (
            self._show(step["observation"]),
            float(step["reward"][0]),
            bool(step["terminated"][0]),
            bool(step["truncated"][0]),
            info,
        )

    def render(self) -> np.ndarray | None:
        """Left the sand with the last stroke; right what is too high (red) and too low (blue)."""
        if self.render_mode is None:
            gymnasium.logger.warn('render: give render_mode="rgb_array" or "human" to make()')
            return None
        picture = self.native.render(0, 480)
        if self.render_mode == "rgb_array":
            return picture
        self._draw(picture)
        return None

    def close(self) -> None:
        if self._window is not None:
            import pygame

            pygame.display.quit()
            self._window = None

    def save(self):
        """The state of the world, to `restore` here or in another environment like this one."""
        return self.native.save()

    def restore(self, state):
        """Goes on from a saved state, bit for bit. Returns what it shows."""
        self._started = True
        return self._show(self.native.restore(state))

    def _show(self, arrays):
        return scenes.row_of(scenes.show(self.native, self._observation, arrays), 0)

    def _draw(self, picture: np.ndarray) -> None:
        try:
            import pygame
        except ImportError as error:
            raise gymnasium.error.DependencyNotInstalled(
                'render_mode "human" needs pygame: pip install pygame'
            ) from error
        size = (picture.shape[1], picture.shape[0])
        if self._window is None:
            pygame.display.init()
            pygame.display.set_caption("sandwright")
            self._window = pygame.display.set_mode(size)
        surface = pygame.surfarray.make_surface(np.swapaxes(picture, 0, 1))
        self._window.blit(surface, (0, 0))
        pygame.event.pump()
        pygame.display.flip()
