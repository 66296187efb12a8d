#!/usr/bin/env python3
"""The table of README.md: morison.sysid on each of the four records.

  models/morison/repeats.py

`--sysid PATH` takes another program; nothing but Python's standard library is needed.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import tempfile

here = pathlib.Path(__file__).resolve().parent
forecasts = ["white_forecast", "black_one_step", "black_free", "force_one_step", "force_free", "residual_one_step", "residual_free"]

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("--sysid", default=str(here.parent.parent / "sysid"))
given = arguments.parse_args()
print("record", *forecasts, "C_d white", "C_d grey_force", "C_d grey_residual", sep=" | ")
for record in ["weak_0", "weak_1", "strong_0", "strong_1"]:
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shutil.copy(here / f"{record}.csv", folder / "weak_0.csv")
        shutil.copy(here / "morison.sysid", folder)
        subprocess.run([given.sysid, "run", str(folder / "morison.sysid"), "-o", str(folder / "results"), "--no-figures"],
                       capture_output=True, check=True)

        def summary(task):
            return json.loads((folder / "results" / task / "summary.json").read_text())

        errors = [f"{summary(task)['fit']['nmse']:.2f}" for task in forecasts]
        drag = [f"{summary(task)['parameters']['Cd']['mean']:.3f}" for task in ["white_fit", "force_fit", "residual_fit"]]
        print(record, *errors, *drag, sep=" | ", flush=True)
