"""Worlds small and fast enough for tests: the heightfield on 10 mm cells."""

import os

import pytest

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")  # render_mode "human" without a screen

FAST = {
    "world": "heightfield",
    "config": {"task": {"max_strokes": 4}, "episode": {"max_rejected_in_a_row": 1000}},
}


@pytest.fixture
def fast():
    return dict(FAST)
