"""Kills long runs (SIGKILL) at random moments, continues them, and checks that nothing was lost.

    python tests/benchmarks/kill_and_continue.py build/sandwright --kills 10 --out docs/results/kill_and_continue.json

Each run goes undisturbed first. Then it is killed, continued and killed again; a run that reaches its end
begins anew until there were enough kills. After each kill: what was on disk at the kill before is still there.
At the end: the end was reached, and where the same bytes are promised, they are the undisturbed run's.
Exits with 1 and says what is wrong where a check fails. --small: runs of seconds, for the test suite.
"""

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]


def machine():
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    cpu = next(line.split(": ")[1] for line in lines if line.startswith("model name"))
    return {"cpu": cpu, "threads": os.cpu_count(), "load_average": os.getloadavg()[0]}


def strokes_on_file(program, folder):
    """Every recorded stroke by file and number, with figures that tell whether it is the same."""
    files = sorted(str(f) for f in folder.glob("*.h5") if not f.name.startswith("."))
    files = [f for f in files if Path(f).name == "strokes.h5" or Path(f).name.startswith("bed_")]
    if not files:
        return {}
    result = folder.parent / "score.json"
    run = [program, "score", "--model", "none", "--threads", "1", "--json", str(result), "--data", *files]
    subprocess.run(run, check=True, capture_output=True)
    rows = json.loads(result.read_text())["per_stroke"]
    return {(row["file"], row["stroke"]): (row["cells"], row["change_mm2"]) for row in rows}


def whole_lines(file):
    return file.read_text().rpartition("\n")[0].split("\n") if file.exists() else []


def metadata(safetensors):
    with open(safetensors, "rb") as f:
        size = int.from_bytes(f.read(8), "little")
        return json.loads(f.read(size))["__metadata__"]


class Job:
    """A run in `folder`: its command line, what of it is kept, and the files that must come out the same."""

    name, identical = "", []

    def __init__(self, program, shared, folder, small):
        self.program, self.shared, self.folder, self.small = program, shared, folder, small

    def status_file(self):
        return self.folder / "status.json"

    def check_kept(self, before, now):
        return all(now.get(key) == value for key, value in before.items())


class Collect(Job):
    name = "collect --source heightfield"

    def arguments(self):
        strokes = 100 if self.small else 500
        return ["collect", "--source", "heightfield", "--strokes", strokes, "--sequence", 20, "--seed", 3,
                "--threads", 1, "--out", self.folder]

    def kept(self):
        return strokes_on_file(self.program, self.folder)

    def results(self):
        return sorted(self.folder.glob("bed_*.h5"))


class OnRig(Job):
    """Has a log: lines that are in it stay, and so do recorded strokes."""

    def kept(self):
        events = whole_lines(self.folder / "events.jsonl")
        return dict(enumerate(events)) | strokes_on_file(self.program, self.folder)

    def results(self):
        return []


class CollectSimulated(OnRig):
    name = "collect --source simulated"

    def arguments(self):
        return ["collect", "--source", "simulated", "--strokes", 2 if self.small else 8, "--seed", 3,
                "--threads", 1, "--workcell", ROOT / "configs/workcell_small.yaml", "--out", self.folder]


class Deploy(OnRig):
    name = "deploy --arm simulated"

    def arguments(self):
        if whole_lines(self.folder / "events.jsonl"):
            return ["deploy", "--threads", 1, "--resume", self.folder]
        bed, goal = self.shared / "terrain.h5", self.shared / "goal.h5"
        return ["deploy", "--arm", "simulated", "--agent", "greedy", "--terrain", bed, "--goal", goal,
                "--workcell", ROOT / "configs/workcell_small.yaml", "--mode", "run", "--seed", 3, "--threads", 1,
                "--max-strokes", 2 if self.small else 8, "--log", self.folder]


class Fit(Job):
    name = "fit"

    def file(self):
        return self.folder / "model.safetensors"

    def state(self):
        return self.folder / "model.safetensors.state"

    def status_file(self):
        return self.folder / "model.safetensors.status.json"

    def arguments(self):
        self.folder.mkdir(exist_ok=True)
        beds = ROOT / "data/strokes/dem"
        return ["fit", "--config", ROOT / "configs/fit_surrogate.yaml", "--data", beds / "bed_501.h5",
                "--validation", beds / "bed_503.h5", "--out", self.file(), "--seed", 1, "--threads", 1,
                f"epochs={3 if self.small else 64}", *(["--resume"] if self.state().exists() else [])]

    def kept(self):
        done = json.loads(metadata(self.state())["progress"])["epochs"] if self.state().exists() else 0
        return {"epochs": done}

    def check_kept(self, before, now):
        return self.file().exists() or now["epochs"] >= before.get("epochs", 0)

    def results(self):
        return [self.file()]


class Train(Job):
    name = "train"

    def arguments(self):
        if (self.folder / "config.yaml").exists():
            return ["train", "--resume", self.folder, "--threads", 1]
        steps = 256 if self.small else 1024
        keys = ["env.num_envs=8", "network.channels=8", "network.hidden=32", "expert.evaluations=8",
                "expert.gradient_steps=4", f"total_steps={steps}", f"evaluate_every={steps // 4}",
                f"checkpoint_every={steps // 8}", "evaluation_tasks=2"]
        return ["train", "--config", ROOT / "configs/train_expert_small.yaml", "--out", self.folder, "--seed", 1,
                "--threads", 1, *keys]

    def kept(self):
        checkpoints = [int(f.stem) for f in self.folder.glob("checkpoints/[0-9]*.safetensors")]
        return {"checkpoint": max(checkpoints, default=-1)}

    def check_kept(self, before, now):
        return now["checkpoint"] >= before.get("checkpoint", -1)

    def results(self):
        return [self.folder / "agent.safetensors", self.folder / "best.safetensors"]


def start(job, output):
    return subprocess.Popen([job.program, *map(str, job.arguments())], stdout=output, stderr=output,
                            stdin=subprocess.DEVNULL)


def fail(job, what, output):
    output.flush()
    sys.exit(f"{job.name}: {what}\n{Path(output.name).read_text()[-2000:]}")


def check_end(job, process, output):
    if process.wait() != 0:
        fail(job, "the end was not reached", output)
    state = json.loads(job.status_file().read_text())["state"]
    if state != "done":
        fail(job, f"status.json says {state}", output)


def kill_and_finish(job, moments_s, output):
    """Kills a run after each of the moments, continuing it in between; returns those before its end."""
    before, killed_s = {}, []
    for moment_s in moments_s:
        process = start(job, output)
        try:
            process.wait(moment_s)
            break
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        killed_s.append(round(moment_s, 3))
        if job.status_file().exists() and json.loads(job.status_file().read_text())["state"] != "running":
            fail(job, "status.json speaks of an end that nobody told it", output)
        now = job.kept()
        if not job.check_kept(before, now):
            fail(job, f"something was lost when it was killed after {moment_s:.3f} s", output)
        before = now
    else:
        process = start(job, output)
    check_end(job, process, output)
    if not job.check_kept(before, job.kept()):
        fail(job, "something was lost at the end", output)
    return killed_s


def measure(kind, program, shared, folder, kills, small, stream):
    folder.mkdir()
    output = open(folder / "output.txt", "w")
    undisturbed = kind(program, shared, folder / "undisturbed", small)
    begin = time.monotonic()
    check_end(undisturbed, start(undisturbed, output), output)
    whole_s = time.monotonic() - begin
    killed_s, rounds, strokes = [], 0, None
    while len(killed_s) < kills:
        rounds += 1
        job = kind(program, shared, folder / f"round_{rounds}", small)
        # Within a share of the whole run that leaves room for several kills in one.
        moments_s = [stream.uniform(0.02, 0.4) * whole_s for _ in range(kills - len(killed_s))]
        killed_s += kill_and_finish(job, moments_s, output)
        for ours, other in zip(job.results(), undisturbed.results(), strict=True):
            if ours.read_bytes() != other.read_bytes():
                fail(job, f"{ours.name} differs from the undisturbed run's", output)
        if isinstance(job, OnRig):
            strokes = sum(isinstance(key, tuple) for key in job.kept())
    result = {"name": kind.name, "undisturbed_s": round(whole_s, 2), "kills": len(killed_s), "runs": rounds,
              "killed_after_s": killed_s, "kept": True, "end_reached": True,
              "identical_bytes": True if undisturbed.results() else None}
    return result | ({"strokes_on_file": strokes} if strokes is not None else {})


def make_shared(program, folder):
    """The bed and the goal of a deployment: a heap's sand over a bed of the small cell."""
    folder.mkdir()
    collect = ["collect", "--source", "simulated", "--strokes", 1, "--seed", 5, "--threads", 1, "--workcell",
               ROOT / "configs/workcell_small.yaml", "--out", folder]
    goal = ["goal", "--terrain", folder / "terrain.h5", "--shape", "mound", "--out", folder / "goal.h5"]
    for arguments in (collect, goal):
        subprocess.run([program, *map(str, arguments)], check=True, capture_output=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda p: str(Path(p).resolve()))
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--small", action="store_true")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    stream = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_shared(options.program, folder / "shared")
        results = []
        for number, kind in enumerate([Collect, CollectSimulated, Fit, Train, Deploy]):
            results.append(measure(kind, options.program, folder / "shared", folder / str(number), options.kills,
                                   options.small, stream))
            print(json.dumps(results[-1]), flush=True)
    if options.out:
        options.out.write_text(json.dumps({"machine": machine(), "seed": options.seed, "runs": results}, indent=1) + "\n")


if __name__ == "__main__":
    main()
