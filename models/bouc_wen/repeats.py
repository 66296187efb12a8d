#!/usr/bin/env python3
"""The tables of README.md: records of other seeds, selected from as printed or with the defaults.

  models/bouc_wen/repeats.py printed    twenty seeds of as_printed.sysid
  models/bouc_wen/repeats.py defaults   ten seeds of bouc_wen.sysid, polished, and a long `mh` run of n = 2 beside each

Each record is made by `simulate` with the seed that it is then selected from with. `--seeds 1 2 3` repeats others, `--sysid PATH`
takes another program; nothing but Python's standard library is needed.
"""
import argparse
import json
import pathlib
import re
import subprocess
import tempfile

here = pathlib.Path(__file__).resolve().parent
truth = {"m": 1, "c": 20, "alpha": 1.5, "beta": -1.5, "A": 6680}
right = "bouc_wen(n = 2)"
chains = "\nchains = fit bouc_wen(n = 2) to bench.train with mh(samples = 60000)\n"


def short(model):
    return model if model == "linear" else model[len("bouc_wen("):-1]


def run(sysid, folder, verb, text, seed, *options):
    file = folder / "case.sysid"
    file.write_text(text)
    done = subprocess.run([sysid, verb, str(file), "-o", str(folder / "results"), "--force", "--seed", str(seed), "--no-figures", *options],
                          capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise SystemExit(f"seed {seed}: {done.stderr}")


def summary(folder, task):
    return json.loads((folder / "results" / task / "summary.json").read_text())


def make_record(sysid, folder, seed):
    run(sysid, folder, "simulate", (here / "bouc_wen.sysid").read_text(), seed)
    (folder / "results/truth/bouc_wen_1pct.csv").rename(folder / "bouc_wen_1pct.csv")


def printed(sysid, folder, seed):
    make_record(sysid, folder, seed)
    run(sysid, folder, "select", (here / "as_printed.sysid").read_text(), seed)
    found = summary(folder, "selection")
    populations, models = found["populations"], found["models"]
    dead = sorted((entry["died_in_population"], short(name)) for name, entry in models.items() if entry["died_in_population"])
    alive = [f"{short(name)}: {entry['probability']:.2f} ({entry['share']:.2f})" for name, entry in models.items()
             if not entry["died_in_population"]]
    return (f"| {seed} | {populations['count']} | {populations['threshold']:.4f} / {populations['noise_floor']:.4f} "
            f"| {populations['simulations'] / 1e6:.2f} | {', '.join(f'{name} ({t})' for t, name in dead)} | {', '.join(alive)} |")


def defaults(sysid, folder, seed):
    make_record(sysid, folder, seed)
    text = (here / "bouc_wen.sysid").read_text()
    run(sysid, folder, "select", text, seed)
    run(sysid, folder, "fit", re.sub(r"(?ms)^forecast.*?\Z", "", text) + chains, seed)
    found = summary(folder, "selection")
    populations, model = found["populations"], found["models"][right]
    off = max(abs(model["parameters"][name]["mean"] - value) / model["parameters"][name]["sd"] for name, value in truth.items())
    exact = summary(folder, "chains")["parameters"]
    worst = max((model["polished"][name]["sd"] / exact[name]["sd"] for name in truth), key=lambda ratio: abs(ratio - 1))
    return (f"| {seed} | {populations['count']} | {populations['simulations'] / 1e6:.2f} "
            f"| {populations['threshold'] / populations['noise_floor']:.3f} | {model['probability']:.3f} ({model['share']:.3f}) "
            f"| {off:.1f} | {worst:.3f} |")


tables = {
    "printed": (printed, 20, "| seed | populations | last threshold / noise floor | 10⁶ simulations | died (in population) "
                             "| alive: probability (share) |\n|---|---|---|---|---|---|"),
    "defaults": (defaults, 10, "| seed | populations | 10⁶ simulations | last threshold / noise floor | n = 2: probability (share) "
                               "| truth off by at most [sd] | sd polished / `mh`, worst |\n|---|---|---|---|---|---|---|"),
}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", choices=tables)
    parser.add_argument("--seeds", type=int, nargs="+")
    parser.add_argument("--sysid", default=str(here.parent.parent / "sysid"))
    arguments = parser.parse_args()
    row, count, head = tables[arguments.table]
    print(head)
    for seed in arguments.seeds or range(1, count + 1):
        with tempfile.TemporaryDirectory() as folder:
            print(row(arguments.sysid, pathlib.Path(folder), seed), flush=True)
