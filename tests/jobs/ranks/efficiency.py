#!/usr/bin/env python3
"""How many of a thousand ranks a selection by abc_smc keeps busy, by simulating its batches: tests/jobs/ranks/efficiency.py [RANKS].

A batch of n proposals costs the time of the rank that has most to do, and one exchange:

    T(n) = max over ranks r of sum over its lanes t_i + 2 a ceil(log2 N) + n b / B + n w

with N ranks, simulations of t_i seconds, a seconds for a message, b bytes of a result, B bytes/s, and w seconds of what each rank
does for a proposal whatever their number. A population of P particles takes batches as the program does (src/inference/abc), then
P^2 kernels for its weights. Efficiency: sum of t_i of the proposals that were counted, over N times the time of the population.
"""
import math
import random
import sys

RANKS = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
MESSAGE = 20e-6  # s: Ethernet; shared memory and InfiniBand take 1 to 2e-6
RATE = 1e9  # bytes/s
RESULT = 13  # bytes: one distance, how it ended, where it failed
PROPOSAL, KERNEL = 3e-6, 10e-9  # s
LEAST, MOST, AHEAD = 256, 8192, 64  # src/inference/abc/abc_smc.cpp


def efficiency(particles, acceptance, duration, seed=1):
    source = random.Random(seed)
    accepted = counted = 0
    useful = time = 0.0
    while accepted < particles:
        rate = (accepted + 1) / (counted + 1) if counted else acceptance
        needed = math.ceil((particles - accepted) / rate)
        count = max(min(max(needed, LEAST), MOST), min(needed, AHEAD * RANKS))
        busy = [0.0] * RANKS
        for i in range(count):
            within = source.random() < acceptance
            took = duration(source, within)
            busy[i * RANKS // count] += took
            if accepted < particles:
                useful += took
                counted += 1
                accepted += within
        time += max(busy) + 2 * MESSAGE * math.ceil(math.log2(RANKS)) + count * RESULT / RATE + count * PROPOSAL
    time += particles**2 * KERNEL
    return useful / (RANKS * time)


CASES = {
    "1 s each": lambda source, within: 1.0,
    "1 s each, sd 20 %": lambda source, within: max(0.1, source.gauss(1.0, 0.2)),
    "1 s, given up at a random time unless accepted": lambda source, within: 1.0 if within else source.random(),
}

print(f"{RANKS} ranks, acceptance rate 0.2")
for particles in (1000, 10000, 30000):
    for name, duration in CASES.items():
        print(f"{particles:6} particles, {name}: {efficiency(particles, 0.2, duration):.2f}")
