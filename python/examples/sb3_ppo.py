"""Trains Stable-Baselines3's PPO on a small bed of sand: python sb3_ppo.py [steps]."""

import sys

from stable_baselines3 import PPO

from sandwright.sb3 import MapExtractor, VecEnv

steps = int(sys.argv[1]) if len(sys.argv) > 1 else 40_000
envs = VecEnv(32, "small", world="heightfield")
envs.seed(1)
agent = PPO(
    "MultiInputPolicy",
    envs,
    n_steps=32,
    batch_size=256,
    gamma=0.9,
    learning_rate=1e-3,
    policy_kwargs={"features_extractor_class": MapExtractor},
    seed=1,
    verbose=1,
)
agent.learn(steps)
agent.save("sand_ppo")
