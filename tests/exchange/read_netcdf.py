"""Compares an exported file with the results that it was made of, as xarray reads it.

read_netcdf.py FILE.nc FOLDER [PREDICTION_FOLDER]: exits with 1 and says what differs; else prints how much was compared.
"""

import csv
import json
import math
import sys
from fractions import Fraction

import netCDF4
import numpy as np
import xarray as xr

compared = 0


def require(condition, message):
    global compared
    compared += 1
    if not condition:
        sys.exit(message)


def table(path):
    """Header and columns of numbers; comment lines stand in the head alone."""
    with open(path, encoding="utf-8") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    return rows[0], np.array([[float(cell) for cell in row] for row in rows[1:]])


def close(ours, theirs, tolerance):
    """Relative, NaN beside NaN."""
    both = np.isnan(ours) & np.isnan(theirs)
    return bool(np.all(both | (np.abs(ours - theirs) <= tolerance * np.abs(theirs))))


def columns_of(group):
    """Per element of each variable its name in summary.json, its values [chains x draws] and its unit."""
    for name, variable in group.data_vars.items():
        own = [d for d in variable.dims if d not in ("chain", "draw")]
        values = variable.transpose("chain", "draw", *own)
        name = variable.attrs.get("long_name", name)  # where that of the file made way for a dimension
        for place in np.ndindex(*[variable.sizes[d] for d in own]):
            labels = ",".join(str(group[d].values[i]) for d, i in zip(own, place))
            yield (f"{name}[{labels}]" if own else name), values.values[(..., *place)], variable.attrs.get("units", "")


def stan_name(name):
    return name.replace(".", ":").replace("[", ".").replace(",", ".").replace("]", "")


def to_the_last_digit(name, values, summary):
    """Mean and standard deviation in exact arithmetic, quantiles by their definition."""
    draws = [Fraction(v) for v in values.ravel()]
    mean = sum(draws) / len(draws)
    variance = sum((d - mean) ** 2 for d in draws) / (len(draws) - 1)
    ordered = np.sort(values.ravel())

    def quantile(p):
        index = (len(ordered) - 1) * p
        low, high = ordered[math.floor(index)], ordered[math.ceil(index)]
        return low if low == high else (1 - (index - math.floor(index))) * low + (index - math.floor(index)) * high

    for key, value in (("mean", float(mean)), ("sd", math.sqrt(variance)), ("median", quantile(0.5)), ("q5", quantile(0.05)),
                       ("q95", quantile(0.95))):
        require(abs(value - summary[key]) <= math.ulp(summary[key]), f"{key} of {name}: {value!r} and {summary[key]!r}")


def main():
    path, folder, predictions = sys.argv[1], sys.argv[2], sys.argv[3:]
    groups = {name: xr.open_dataset(path, group=name) for name in netCDF4.Dataset(path).groups}
    summary = json.load(open(f"{folder}/summary.json", encoding="utf-8"))
    summaries = summary.get("kept_draws", summary["parameters"])
    posterior, stats = groups["posterior"], groups["sample_stats"]
    require(posterior["m" if "m" in posterior else list(posterior.data_vars)[0]].dims[:2] == ("chain", "draw"), "dimensions")
    seen = set()
    for name, values, unit in columns_of(posterior):
        seen.add(name)
        # xarray would read numbers in "days" as spans of time, so the file says "day".
        require(unit == {"days": "day"}.get(summaries[name]["unit"], summaries[name]["unit"]), f"unit of {name}: {unit}")
        if values.size > 1:
            to_the_last_digit(name, values, summaries[name])
        for chain in range(values.shape[0]):
            header, rows = table(f"{folder}/draws_{chain + 1}.csv")
            column = header.index(stan_name(name), 4)
            require(np.array_equal(rows[:, column], values[chain], equal_nan=True), f"draws of {name} in chain {chain}")
            for own, ours in (("lp__", "lp"), ("accept_stat__", "acceptance_rate"), ("log_prior__", "log_prior"),
                              ("log_likelihood__", "log_likelihood")):
                require(np.array_equal(rows[:, header.index(own)], stats[ours].values[chain], equal_nan=True), own)
    require(seen == set(summaries), f"names: {sorted(seen)} and {sorted(summaries)}")
    if "log_likelihood" in groups:
        group, total = groups["log_likelihood"], 0
        for variable in group.data_vars.values():
            total = total + variable.sum([d for d in variable.dims if d not in ("chain", "draw")], skipna=False)
        require(close(total.values, stats["log_likelihood"].sel(chain=group.chain, draw=group.draw).values, 1e-13),
                "the pointwise log likelihoods do not sum to the log likelihood")
        require(set(group.data_vars) == set(groups["observed_data"].data_vars), "channels of log_likelihood")
        require(set(group.data_vars) <= set(groups["posterior_predictive"].data_vars), "channels of posterior_predictive")
    for place in predictions:
        label, folder = place.split("=", 1)
        header, rows = table(folder)
        rows = rows[rows[:, header.index("scored")] == 1]
        group, constant = groups["predictions"], groups["predictions_constant_data"]
        for name in (c[: -len("_measured")] for c in header if c.endswith("_measured")):
            measured = constant[f"{name}_measured{label}"]
            require(np.array_equal(measured.values, rows[:, header.index(f"{name}_measured")], equal_nan=True), f"measured {name}")
            if "t" in header:  # in seconds there
                require(close(measured[f"time{label}"].values, rows[:, header.index("t")], 1e-15), "times")
            for variable, suffix in ((f"{name}_response{label}", ""), (f"{name}{label}", "_noisy")):
                values = group[variable].values[0]
                for column, ours in (("mean", values.mean(0)), ("sd", values.std(0, ddof=1)),
                                     ("q2.5", np.quantile(values, 0.025, axis=0, method="weibull")),
                                     ("q97.5", np.quantile(values, 0.975, axis=0, method="weibull"))):
                    require(close(ours, rows[:, header.index(f"{name}{suffix}_{column}")], 1e-11), f"{column} of {variable}")
    print(f"{compared} comparisons; groups: {' '.join(groups)}")


main()
