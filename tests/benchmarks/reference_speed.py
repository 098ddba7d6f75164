"""Steps a second of the reference tasks: ours beside Gymnasium's vector environments, in one run.

    PYTHONPATH=build/python python tests/benchmarks/reference_speed.py OUT.json
"""

import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import gymnasium
import mujoco
import numpy as np

from sandwright._native import ReferenceVecEnv, reference_task_names

ROOT = Path(__file__).parents[2]
COUNTS, ROUNDS, SECONDS, STEPS = (8, 64), 3, 0.5, 64


def machine():
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    cpu = next(line.split(": ")[1] for line in lines if line.startswith("model name"))
    return {"cpu": cpu, "threads": os.cpu_count(), "load_average": os.getloadavg()[0]}


def rate(env, actions):
    """Environment steps a second of the wall clock over SECONDS."""
    env.reset(seed=1)
    start, steps = time.perf_counter(), 0
    while (elapsed := time.perf_counter() - start) < SECONDS:
        env.step(actions[steps % STEPS])
        steps += 1
    return steps * len(actions[0]) / elapsed


def measure(name, count):
    """The median of ROUNDS, in each of which all take turns."""
    sync, asynchronous = (gymnasium.make_vec(name, count, mode) for mode in ("sync", "async"))
    sync.action_space.seed(1)
    given = [sync.action_space.sample() for _ in range(STEPS)]
    spec = ReferenceVecEnv(name, 1).spec()
    shares = [np.float32(a).reshape(count, -1) / np.float32(spec["action_limit"]) for a in given]
    runs = {
        "ours_1_thread": (ReferenceVecEnv(name, count, 1), shares),
        "ours_2_threads": (ReferenceVecEnv(name, count, 2), shares),
        "gymnasium_sync": (sync, given),
        "gymnasium_async": (asynchronous, given),
    }
    rates = {key: [] for key in runs}
    for _ in range(ROUNDS):
        for key, (env, actions) in runs.items():
            rates[key].append(rate(env, actions))
    asynchronous.close()
    return {key + "_steps_per_second": statistics.median(values) for key, values in rates.items()}


def main():
    rows = []
    for name in reference_task_names():
        if name.endswith("-v4"):  # the same work as v5
            continue
        for count in COUNTS:
            rows.append({"name": name, "num_envs": count, **measure(name, count)})
            print(json.dumps(rows[-1]), flush=True)
    commit = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]
    result = {
        "command": "python tests/benchmarks/reference_speed.py",
        "commit": subprocess.run(commit, capture_output=True, text=True, check=True).stdout.strip(),
        "machine": machine(),
        "versions": {"gymnasium": gymnasium.__version__, "mujoco": mujoco.__version__},
        "rounds": ROUNDS,
        "seconds_per_round": SECONDS,
        "rows": rows,
    }
    Path(sys.argv[1]).write_text(json.dumps(result, indent=2, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
