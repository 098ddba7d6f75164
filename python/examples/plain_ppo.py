"""PPO in one file over the native vector environment, in the manner of CleanRL: python plain_ppo.py [steps].

Schulman et al., "Proximal policy optimization algorithms", 2017; the details follow Huang et al., "The 37
implementation details of proximal policy optimization", 2022. Episodes end by themselves here (the budget is
part of the task), so no value is bootstrapped beyond an end.
"""

import sys

import gymnasium
import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from torch import nn

import sandwright  # noqa: F401  registers the ids

NUM_ENVS, NUM_STEPS, EPOCHS, MINIBATCHES = 32, 32, 5, 4
GAMMA, LAMBDA, CLIP, ENTROPY = 0.9, 0.95, 0.2, 0.001


class Agent(nn.Module):
    def __init__(self, channels: int, side: int, numbers: int, actions: int) -> None:
        super().__init__()
        self.see = nn.Sequential(
            nn.Conv2d(channels, 16, 3, 2, 1), nn.ReLU(), nn.Conv2d(16, 32, 3, 2, 1), nn.ReLU(), nn.Flatten()
        )
        self.join = nn.Sequential(nn.Linear(32 * (side // 4) ** 2 + numbers, 128), nn.ReLU())
        self.mean, self.value = nn.Linear(128, actions), nn.Linear(128, 1)
        self.log_std = nn.Parameter(torch.full((actions,), -0.5))
        nn.init.orthogonal_(self.mean.weight, 0.01)

    def forward(self, maps: torch.Tensor, vec: torch.Tensor):
        seen = self.join(torch.cat([self.see(maps), vec], 1))
        return torch.distributions.Normal(self.mean(seen), self.log_std.exp()), self.value(seen)[:, 0]


def main(total_steps: int) -> None:
    torch.manual_seed(1)
    envs = gymnasium.make_vec(
        "sandwright/ShapeSmall-v0",
        num_envs=NUM_ENVS,
        vectorization_mode="vector_entry_point",
        world="heightfield",
        autoreset_mode=AutoresetMode.SAME_STEP,
    )
    channels, side, _ = envs.single_observation_space["map"].shape
    agent = Agent(channels, side, envs.single_observation_space["vec"].shape[0], envs.single_action_space.shape[0])
    optimiser = torch.optim.Adam(agent.parameters(), lr=1e-3, eps=1e-5)
    shown, _ = envs.reset(seed=1)
    updates = total_steps // (NUM_ENVS * NUM_STEPS)
    for update in range(updates):
        optimiser.param_groups[0]["lr"] = 1e-3 * (1 - update / updates)
        rows, errors = [], []
        for _ in range(NUM_STEPS):
            maps, vec = torch.from_numpy(shown["map"]), torch.from_numpy(shown["vec"])
            with torch.no_grad():
                policy, value = agent(maps, vec)
                action = policy.sample()
            shown, reward, terminated, truncated, infos = envs.step(action.clamp(-1, 1).numpy())
            done = torch.from_numpy(terminated | truncated).float()
            rows.append((maps, vec, action, policy.log_prob(action).sum(1), torch.from_numpy(reward).float(), done, value))
            if "metrics" in infos:
                metrics = infos["metrics"]
                errors.extend(metrics["in_goal_mean_diff_mm"][metrics["_in_goal_mean_diff_mm"]])
        maps, vec, action, log_prob, reward, done, value = (torch.stack(column) for column in zip(*rows))
        with torch.no_grad():
            following = agent(torch.from_numpy(shown["map"]), torch.from_numpy(shown["vec"]))[1]
            advantage, last = torch.zeros_like(reward), torch.zeros(NUM_ENVS)
            for t in reversed(range(NUM_STEPS)):
                delta = reward[t] + GAMMA * following * (1 - done[t]) - value[t]
                last = delta + GAMMA * LAMBDA * (1 - done[t]) * last
                advantage[t], following = last, value[t]
            target = advantage + value
        flat = [x.flatten(0, 1) for x in (maps, vec, action, log_prob, advantage, target)]
        for _ in range(EPOCHS):
            for chosen in torch.randperm(len(flat[0])).chunk(MINIBATCHES):
                m, v, a, old, adv, goal = (x[chosen] for x in flat)
                policy, now = agent(m, v)
                ratio = (policy.log_prob(a).sum(1) - old).exp()
                adv = (adv - adv.mean()) / (adv.std() + 1e-8)
                loss = -torch.min(ratio * adv, ratio.clamp(1 - CLIP, 1 + CLIP) * adv).mean()
                loss = loss + 0.5 * (now - goal).square().mean() - ENTROPY * policy.entropy().sum(1).mean()
                optimiser.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
                optimiser.step()
        print(f"{(update + 1) * NUM_ENVS * NUM_STEPS} strokes, goal error at the end {np.mean(errors):.2f} mm")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 40_000)
