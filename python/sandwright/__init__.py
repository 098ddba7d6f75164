"""Sand shaping as Gymnasium environments; see docs/python.md.

>>> import gymnasium, sandwright
>>> env = gymnasium.make("sandwright/ShapeSmall-v0", world="heightfield")
"""

import gymnasium

from sandwright.env import ShapeEnv
from sandwright.vector import ShapeVectorEnv

__all__ = ["ShapeEnv", "ShapeVectorEnv", "register_envs"]

_IDS = {
    "sandwright/Shape-v0": {"scene": "box"},
    "sandwright/ShapeSmall-v0": {"scene": "small"},
    "sandwright/ShapeImage-v0": {"scene": "small", "observation": "image"},
    "sandwright/ShapeCells-v0": {"scene": "small", "action": "cells"},
}


def register_envs() -> None:
    """Registers the ids above; called by Gymnasium, and when this package is imported."""
    for name, arguments in _IDS.items():
        if name in gymnasium.registry:
            continue
        gymnasium.register(
            id=name,
            entry_point="sandwright.env:ShapeEnv",
            vector_entry_point="sandwright.vector:ShapeVectorEnv",
            kwargs=arguments,
        )


register_envs()
