#!/usr/bin/env python3
"""The table of README.md: bridge.sysid on the four shipped records, and on ten more made by the same recipe.

  models/bridge/repeats.py

`--sysid PATH` takes another program; nothing but Python's standard library is needed.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import shutil
import statistics
import subprocess
import tempfile

here = pathlib.Path(__file__).resolve().parent


def make_record(path, curved, seed):
    """Deflection = -3 T - 6 traffic + 0.6 sin(T/2), `curved` adds 0.04 (T - 10)^2; noise of sd 0.8 mm; 8 rows a day for 150 days.
    T is a season that falls by 20 degrees, a daily cycle and weather, an autoregression over a few days; traffic a daily bump, less at
    week-ends."""
    draw = random.Random(seed)
    weather = draw.gauss(0, 2)
    with open(path, "w") as file:
        print("day,temperature,traffic,deflection", file=file)
        for row in range(1200):
            day = row / 8
            weather = 0.97 * weather + draw.gauss(0, 2 * math.sqrt(1 - 0.97**2))
            temperature = 5 + 10 * math.cos(2 * math.pi * (day + 5) / 365) - 10 * day / 150 + 3 * math.sin(2 * math.pi * (day - 0.35)) + weather
            week = 0.6 if int(day) % 7 in (5, 6) else 1.0
            traffic = week * (0.2 + math.exp(-(((day % 1) - 0.5) / 0.2) ** 2)) + draw.gauss(0, 0.05)
            clean = -3 * temperature - 6 * traffic + 0.6 * math.sin(temperature / 2) + (0.04 * (temperature - 10) ** 2 if curved else 0)
            print(f"{day},{temperature:.6f},{traffic:.6f},{clean + draw.gauss(0, 0.8):.6f}", file=file)


def scores(sysid, straight, curved):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        straight(folder / "straight_0.csv")
        curved(folder / "curved_0.csv")
        shutil.copy(here / "bridge.sysid", folder)
        subprocess.run([sysid, "run", str(folder / "bridge.sysid"), "-o", str(folder / "results"), "--no-figures"],
                       capture_output=True, check=False)

        def fit(task):
            return json.loads((folder / "results" / task / "summary.json").read_text())["fit"]

        def inside_bands(task):
            """The share of the fitted samples in their own 95 % bands, given all of them; `coverage_95` leaves each sample out of its own."""
            with open(folder / "results" / task / "predict.csv") as file:
                rows = [row for row in csv.DictReader(line for line in file if not line.startswith("#")) if row["deflection_measured"]]
            within = [float(row["deflection_noisy_q2.5"]) <= float(row["deflection_measured"]) <= float(row["deflection_noisy_q97.5"])
                      for row in rows]
            return sum(within) / len(within)

        rows = []
        for kind in ["straight", "curved"]:
            alone, line = fit(f"alone_{kind}_winter"), fit(f"line_{kind}_winter")
            rows.append((kind, alone["nmse"], line["nmse"], inside_bands(f"alone_{kind}"), inside_bands(f"line_{kind}"),
                         fit(f"alone_{kind}")["coverage_95"], fit(f"line_{kind}")["coverage_95"], alone["coverage_95"],
                         line["coverage_95"]))
        return rows


arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("--sysid", default=str(here.parent.parent / "sysid"))
given = arguments.parse_args()
print("record | outside: process alone | with the line | ratio | 95 % inside: alone | with the line |"
      " each left out: alone | with the line | outside: alone | with the line")
ratios = []
for number in range(7):
    if number < 2:
        made = scores(given.sysid, lambda to: shutil.copy(here / f"straight_{number}.csv", to),
                      lambda to: shutil.copy(here / f"curved_{number}.csv", to))
    else:
        made = scores(given.sysid, lambda to: make_record(to, False, number), lambda to: make_record(to, True, 100 + number))
    for kind, alone, line, *coverage in made:
        ratio = line / alone
        if kind == "straight":
            ratios.append(ratio)
        name = f"{kind}_{number}" if number < 2 else f"simulated, {kind}, seed {number if kind == 'straight' else 100 + number}"
        print(name, f"{alone:.1f}", f"{line:.2f}", f"{ratio:.3f}", *(f"{each:.3f}" for each in coverage), sep=" | ", flush=True)
print(f"median ratio of the straight ones: {statistics.median(ratios):.3f}")
