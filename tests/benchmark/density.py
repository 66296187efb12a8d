"""10 000 densities of Duffing from NumPy beside the engine's own batch, in turns: milliseconds of one thread, and their ratio.

    PYTHONPATH=build/test/python /usr/bin/python3 tests/benchmark/density.py build/test/tests/benchmark/bench_density
"""

import pathlib
import statistics
import subprocess
import sys
import time

import numpy as np

import sysid

COUNT, ROUNDS = 10000, 9
TRUTH = np.array([1, 20, 1e4, 5e9, 8e10])
model = sysid.load(pathlib.Path(__file__).resolve().parents[2] / "models/duffing/duffing.sysid", threads=1)
values = TRUTH * (1 + 1e-3 * np.sin(0.1 * np.arange(COUNT)[:, np.newaxis] + np.arange(5)))
theta = model.unconstrain(values)

for _ in range(20):  # machine code is there
    model.log_density(theta)
numpy, engine = [], []
for _ in range(ROUNDS):
    engine.append(float(subprocess.run([sys.argv[1], "9"], check=True, capture_output=True, text=True).stdout))
    times = []
    for _ in range(9):
        begin = time.thread_time()
        model.log_density(theta)
        times.append(1e3 * (time.thread_time() - begin))
    numpy.append(statistics.median(times))
ratio = statistics.median(a / b for a, b in zip(numpy, engine))
print(f"from NumPy {statistics.median(numpy):.1f} ms, the engine's batch {statistics.median(engine):.1f} ms, ratio {ratio:.3f}")
