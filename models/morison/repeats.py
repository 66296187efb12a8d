#!/usr/bin/env python3
"""The table of README.md: morison.sysid on the four records beside it and on four more, made by the same recipe.

  models/morison/repeats.py                the table
  models/morison/repeats.py --lags         the table of log evidences of one to six lags
  models/morison/repeats.py --statistics   sds of all records, given and made, by which the recipe can be judged

`--sysid PATH` takes another program, `--keep DIR` keeps the records that are made; nothing but Python's standard library is needed.

The recipe: the particle velocity U is a sum of 150 waves with random phases, of spectrum w^-2.7 exp(-1.25 (0.74/w)^4) up to 0.35 Hz
(which has the low end and the acceleration of the given records) and an sd of 1.2 m/s. The wake oscillator is van der Pol's, at the
shedding frequency of a column of 1.5 m and Strouhal number 0.2, driven by the acceleration:

  q'' + 0.3 w_s (q^2 - 1) q' + w_s^2 q = 1.5 U',    w_s = 2 pi 0.2 |U|/1.5,    q(0) = 0, q'(0) = 0.5

(0.3 and 1.5 to the nearest 0.05 from the wake of strong_0.csv). Force and noise are those of README.md. Seeds 2 and 3.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import re
import shutil
import subprocess
import tempfile

here = pathlib.Path(__file__).resolve().parent
forecasts = ["white_forecast", "black_one_step", "black_free", "force_one_step", "force_free", "residual_one_step", "residual_free"]
rows, step = 2200, 0.25


class Sea:
    """A sum of waves with random phases: velocity and acceleration at any time."""

    def __init__(self, draw, waves=150, lowest=0.3, highest=2 * math.pi * 0.35):
        width = (highest - lowest) / waves
        frequencies = [lowest + (i + draw.random()) * width for i in range(waves)]
        power = [w**-2.7 * math.exp(-1.25 * (0.74 / w) ** 4) for w in frequencies]
        scale = 1.2 * math.sqrt(2 / sum(power))
        self.waves = [(scale * math.sqrt(p), w, 2 * math.pi * draw.random()) for p, w in zip(power, frequencies)]

    def velocity(self, t):
        return sum(a * math.cos(w * t + phase) for a, w, phase in self.waves)

    def acceleration(self, t):
        return sum(-a * w * math.sin(w * t + phase) for a, w, phase in self.waves)


def wake_of(sea, substeps=4):
    """q at every row, by the classical Runge-Kutta method."""
    h = step / substeps
    at = [(sea.velocity(0.5 * h * i), sea.acceleration(0.5 * h * i)) for i in range(2 * substeps * rows + 1)]

    def slope(q, v, half_step):
        velocity, acceleration = at[half_step]
        shedding = 2 * math.pi * 0.2 * abs(velocity) / 1.5
        return v, 1.5 * acceleration - 0.3 * shedding * (q * q - 1) * v - shedding**2 * q

    q, v, values = 0.0, 0.5, []
    for i in range(substeps * rows):
        if i % substeps == 0:
            values.append(q)
        a = slope(q, v, 2 * i)
        b = slope(q + h / 2 * a[0], v + h / 2 * a[1], 2 * i + 1)
        c = slope(q + h / 2 * b[0], v + h / 2 * b[1], 2 * i + 1)
        d = slope(q + h * c[0], v + h * c[1], 2 * i + 2)
        q += h / 6 * (a[0] + 2 * (b[0] + c[0]) + d[0])
        v += h / 6 * (a[1] + 2 * (b[1] + c[1]) + d[1])
    return values


def deviation(values):
    mean = sum(values) / len(values)
    return math.sqrt(sum((v - mean) ** 2 for v in values) / len(values))


def make(seed, strength):
    """Columns of a record."""
    draw = random.Random(seed)
    sea = Sea(draw)
    columns = {"t": [step * i for i in range(rows)]}
    columns["U"] = [sea.velocity(t) for t in columns["t"]]
    columns["dU"] = [sea.acceleration(t) for t in columns["t"]]
    columns["wake"] = [strength * (0.27 * abs(U) * U * math.tanh(q) + 0.25 * q * abs(U)) for U, q in zip(columns["U"], wake_of(sea))]
    columns["force_clean"] = [U * abs(U) + 1.2 * dU + wake for U, dU, wake in zip(columns["U"], columns["dU"], columns["wake"])]
    noise = 0.02 * deviation(columns["force_clean"])
    columns["force"] = [clean + noise * draw.gauss(0, 1) for clean in columns["force_clean"]]
    return columns


def write(columns, path):
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows([f"{value:.9g}" for value in row] for row in zip(*columns.values()))


def read(path):
    with path.open() as file:
        table = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in table] for name in table[0]}


def statistics(record, columns):
    noise = [a - b for a, b in zip(columns["force"], columns["force_clean"])]
    shares = [f"{100 * deviation(part) / deviation(columns['force_clean']):.2f}" for part in (columns["wake"], noise)]
    print(record, *(f"{deviation(columns[name]):.3f}" for name in ["U", "dU", "force_clean", "wake"]), *shares, sep=" | ")


def run(program, text, source):
    """Summaries by task of the text run on a record."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shutil.copy(source, folder / "weak_0.csv")
        (folder / "case.sysid").write_text(text)
        subprocess.run([program, "run", str(folder / "case.sysid"), "-o", str(folder / "results"), "--no-figures"],
                       capture_output=True, check=True)
        return {path.parent.name: json.loads(path.read_text()) for path in folder.glob("results/*/summary.json")}


def errors_of(record, source, program):
    summary = run(program, (here / "morison.sysid").read_text(), source)
    errors = [f"{summary[task]['fit']['nmse']:.2f}" for task in forecasts]
    drag = [f"{summary[task]['parameters']['Cd']['mean']:.3f}" for task in ["white_fit", "force_fit", "residual_fit"]]
    print(record, *errors, *drag, sep=" | ", flush=True)


def lags_of(record, source, program):
    blocks = re.findall(r"^(?:model grey_residual|data flume) .*?^}\n", (here / "morison.sysid").read_text(), re.DOTALL | re.MULTILINE)
    text = "".join(blocks).replace("model grey_residual", "model grey_residual(n)").replace("0..4", "0..n").replace("1..4", "1..n")
    for n in range(1, 7):
        text += f"lags_{n} = fit grey_residual(n = {n}) to flume.train with map, seed = 1\n"
        text += f"free_{n} = predict lags_{n} on flume.test with draws(20), prediction = free_run, seed = 1\n"
    summary = run(program, text, source)
    evidences = [summary[f"lags_{n}"]["evidence"]["log_evidence"] for n in range(1, 7)]
    best = evidences.index(max(evidences)) + 1
    probability = 1 / sum(math.exp(each - max(evidences)) for each in evidences)
    errors = [f"{summary[f'free_{n}']['fit']['nmse']:.2f}" for n in (best, 4)]
    print(record, *(f"{each:.1f}" for each in evidences), f"{best} ({probability:.2f})", *errors, sep=" | ", flush=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--sysid", default=str(here.parent.parent / "sysid"))
    arguments.add_argument("--keep", type=pathlib.Path)
    arguments.add_argument("--lags", action="store_true")
    arguments.add_argument("--statistics", action="store_true")
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = given.keep or pathlib.Path(name)
        folder.mkdir(parents=True, exist_ok=True)
        records = {each: here / f"{each}.csv" for each in ["weak_0", "weak_1", "strong_0", "strong_1"]}
        for seed in (2, 3):
            for kind, strength in (("weak", 0.3), ("strong", 1.0)):
                records[f"{kind}_{seed}"] = folder / f"{kind}_{seed}.csv"
                write(make(seed, strength), records[f"{kind}_{seed}"])
        ordered = sorted(records, key=lambda each: (each.startswith("strong"), each))
        if given.statistics:
            print("record", "sd of U", "U'", "force", "wake", "wake [% of force]", "noise [%]", sep=" | ")
            for record in ordered:
                statistics(record, read(records[record]))
            return
        if given.lags:
            print("record", *range(1, 7), "most probable", "free run there", "free run of 4", sep=" | ")
            for record in ordered:
                lags_of(record, records[record], given.sysid)
            return
        print("record", *forecasts, "C_d white", "C_d grey_force", "C_d grey_residual", sep=" | ")
        for record in ordered:
            errors_of(record, records[record], given.sysid)


main()
