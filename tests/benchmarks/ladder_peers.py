"""The ladder's trainers beside Stable-Baselines3's, in turns on one machine: wall time and score.

    python tests/benchmarks/ladder_peers.py OUT.json ROW...      rows: see ROWS below

Needs stable-baselines3, sb3-contrib (TQC) and a built program (build/sandwright). Each program
trains on one thread with the same task, steps and numbers (rl-baselines3-zoo's, or those of
configs/ladder); what differs by design is said in a row's `differs`. Rounds take turns: ours, theirs,
ours, ... with the round's number as the seed. Training alone is timed, the evaluation of the
deterministic policy is not.
"""

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROGRAM = Path(os.environ.get("SANDWRIGHT_PROGRAM", ROOT / "build/sandwright"))
EPISODES = 100

# `theirs`: keyword arguments of Stable-Baselines3's algorithm; `ours`: overrides of the ladder's file.
ROWS = {
    "cart_pole_ppo": {
        "algorithm": "PPO", "task": "CartPole-v1", "steps": 100_000, "rounds": 1,
        "theirs": {"n_steps": 32, "batch_size": 256, "gae_lambda": 0.8, "gamma": 0.98, "n_epochs": 20,
                   "ent_coef": 0.0, "learning_rate": "linear 1e-3", "clip_range": "linear 0.2"},
        "num_envs": 8,
    },
    "half_cheetah_ppo": {
        "algorithm": "PPO", "task": "HalfCheetah-v4", "steps": 100_000, "rounds": 3, "normalize": True,
        "theirs": {"n_steps": 2048, "batch_size": 64, "gae_lambda": 0.95, "gamma": 0.99, "n_epochs": 10,
                   "ent_coef": 0.0, "learning_rate": "linear 3e-4", "clip_range": 0.2},
        "ours": {"env.num_envs": 1, "ppo.num_steps": 2048, "ppo.minibatch_size": 64, "ppo.epochs": 10,
                 "ppo.gamma": 0.99, "ppo.gae_lambda": 0.95, "ppo.learning_rate": 3e-4,
                 "ppo.learning_rate_schedule": "linear", "ppo.clip_range": 0.2, "network.hidden": 64},
        "num_envs": 1,
        "differs": "CleanRL's numbers for both; ours has a Beta distribution, theirs a Gaussian",
    },
    "pendulum_sac": {
        "algorithm": "SAC", "task": "Pendulum-v1", "steps": 20_000, "rounds": 1,
        "theirs": {"learning_rate": 1e-3}, "ours": {"sac.hidden": 256}, "num_envs": 1,
    },
    "pendulum_tqc": {
        "algorithm": "TQC", "task": "Pendulum-v1", "steps": 20_000, "rounds": 1,
        "theirs": {"learning_rate": 1e-3}, "ours": {"sac.hidden": 256}, "num_envs": 1,
    },
    "mountain_car_sac": {
        "algorithm": "SAC", "task": "MountainCarContinuous-v0", "steps": 50_000, "rounds": 1,
        "theirs": {"learning_rate": 3e-4, "buffer_size": 50_000, "batch_size": 512, "ent_coef": 0.1,
                   "train_freq": 32, "gradient_steps": 32, "gamma": 0.9999, "tau": 0.01,
                   "learning_starts": 0, "use_sde": True,
                   "policy_kwargs": {"log_std_init": -3.67, "net_arch": [64, 64]}},
        "num_envs": 1,
        "differs": "exploration: pink noise in ours, gSDE in theirs",
    },
}


def schedule(value):
    """A number as it is; "linear X" as X times the share of training that is left."""
    if not isinstance(value, str):
        return value
    first = float(value.removeprefix("linear "))
    return lambda left: first * left


def train_theirs(row, seed):
    """Runs in a process of its own; prints one line of JSON."""
    import sb3_contrib
    import stable_baselines3
    import torch
    from stable_baselines3.common.env_util import make_vec_env
    from stable_baselines3.common.evaluation import evaluate_policy
    from stable_baselines3.common.vec_env import VecNormalize

    torch.set_num_threads(1)
    env = make_vec_env(row["task"], row["num_envs"], seed=seed)
    if row.get("normalize"):
        env = VecNormalize(env, gamma=row["theirs"]["gamma"])
    algorithm = sb3_contrib.TQC if row["algorithm"] == "TQC" else getattr(stable_baselines3, row["algorithm"])
    numbers = {key: schedule(value) for key, value in row["theirs"].items()}
    model = algorithm("MlpPolicy", env, seed=seed, device="cpu", **numbers)
    start = time.perf_counter()
    model.learn(row["steps"])
    seconds = time.perf_counter() - start
    judge = make_vec_env(row["task"], 10, seed=seed + 1000)
    if row.get("normalize"):
        judge = VecNormalize(judge, training=False, norm_reward=False)
        judge.obs_rms = env.obs_rms
    mean, deviation = evaluate_policy(model, judge, EPISODES, deterministic=True)
    print(json.dumps({"seconds": seconds, "mean_reward": float(mean), "std_reward": float(deviation)}))


def their_run(name, seed):
    out = subprocess.run([sys.executable, __file__, "--theirs", name, str(seed)], check=True,
                         capture_output=True, text=True)
    return json.loads(out.stdout.splitlines()[-1])


def our_run(name, seed):
    row = ROWS[name]
    with tempfile.TemporaryDirectory() as folder:
        overrides = {"total_steps": row["steps"], "torch_threads": 1, "evaluate_every": 0,
                     "checkpoint_every": 0, "evaluation_tasks": EPISODES, **row.get("ours", {})}
        command = [PROGRAM, "train", "--config", ROOT / f"configs/ladder/{name}.yaml", "--seed", str(seed),
                   "--threads", "1", "--out", f"{folder}/run", "--json", f"{folder}/result.json"]
        subprocess.run([*command, *(f"{key}={value}" for key, value in overrides.items())], check=True,
                       capture_output=True)
        result = json.loads(Path(f"{folder}/result.json").read_text())
    return {"seconds": result["seconds"] - result["evaluation_seconds"],
            "mean_reward": result["mean_reward"], "std_reward": result["std_reward"]}


def with_cpu_time(run, name, seed):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    result = run(name, seed)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"seed": seed, **result, "cpu_seconds_with_evaluation": cpu, "load_average": os.getloadavg()[0]}


def measure(name):
    row = ROWS[name]
    runs = {"ours": [], "stable_baselines3": []}
    for seed in range(1, row["rounds"] + 1):
        for key, run in (("ours", our_run), ("stable_baselines3", their_run)):
            runs[key].append(with_cpu_time(run, name, seed))
            print(name, key, json.dumps(runs[key][-1]), flush=True)
    seconds = {key: statistics.median(run["seconds"] for run in values) for key, values in runs.items()}
    return {"name": name, "task": row["task"], "algorithm": row["algorithm"], "steps": row["steps"],
            "evaluation_episodes": EPISODES, "differs": row.get("differs", ""), "runs": runs,
            "seconds": seconds, "times_faster": seconds["stable_baselines3"] / seconds["ours"]}


def machine():
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    cpu = next(line.split(": ")[1] for line in lines if line.startswith("model name"))
    return {"cpu": cpu, "threads": os.cpu_count()}


def main():
    import gymnasium
    import sb3_contrib
    import stable_baselines3
    import torch

    out, names = Path(sys.argv[1]), sys.argv[2:]
    result = json.loads(out.read_text()) if out.exists() else {"rows": []}
    version = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    for name in names:
        row = {**measure(name), "program": version}
        result["rows"] = [old for old in result["rows"] if old["name"] != name] + [row]
        result["command"] = "python tests/benchmarks/ladder_peers.py docs/results/ladder_peers.json ROW..."
        result["machine"] = machine()
        result["versions"] = {m.__name__: m.__version__
                              for m in (gymnasium, sb3_contrib, stable_baselines3, torch)}
        out.write_text(json.dumps(result, indent=2, sort_keys=True) + "\n")


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "--theirs":
        train_theirs(ROWS[sys.argv[2]], int(sys.argv[3]))
    elif len(sys.argv) < 3 or any(name not in ROWS for name in sys.argv[2:]):
        sys.exit(f"usage: ladder_peers.py OUT.json ROW...; rows: {', '.join(ROWS)}")
    else:
        main()
