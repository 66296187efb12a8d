#!/usr/bin/env python3
"""Makes wave_06.csv and wave_11.csv from the measured records.

  models/wave_force/prepare.py RECORDS

RECORDS is a folder with fixed_2062.csv and wave_1062.csv (wave 06), fixed_2112.csv and wave_1112.csv (wave 11): equal steps of
0.005 s and columns wm (stroke of the wavemaker), eta4 and eta6 (elevation 1.5 m before and behind the place of the model), and
with the model there Fy, all in SI units. The fixed records give the force, as measured, 20 times a second. The runs without the
model say how the water would move: the elevation of both gauges is carried to the model by linear theory and averaged, and stands
for velocity and acceleration, averaged over the draft, and for the force that potential flow has on a rectangle.
Nothing but Python's standard library is needed.
"""
import argparse
import cmath
import csv
import math
import pathlib

gravity, density, depth = 9.81, 998.0, 1.0
half_beam, draft, length = 0.2, 0.2, 0.586
step, thin = 0.005, 10


def wavenumber(omega):
    """k of omega^2 = g k tanh(k h), by Newton's method."""
    k = max(omega**2/gravity, omega/math.sqrt(gravity*depth))
    for _ in range(50):
        t = math.tanh(k*depth)
        k -= (gravity*k*t - omega**2)/(gravity*t + gravity*k*depth*(1 - t*t))
    return k


def solve(matrix, right):
    """x of matrix x = right, by Gauss's elimination with pivots."""
    rows = [list(row) + [value] for row, value in zip(matrix, right)]
    n = len(rows)
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for r in range(i + 1, n):
            factor = rows[r][i]/rows[i][i]
            rows[r] = [a - factor*b for a, b in zip(rows[r], rows[i])]
    x = [0]*n
    for i in reversed(range(n)):
        x[i] = (rows[i][n] - sum(rows[i][j]*x[j] for j in range(i + 1, n)))/rows[i][i]
    return x


def potential_force(omega, terms=20):
    """Horizontal force on a fixed rectangle for an elevation of 1 m at its middle, linear diffraction, time as exp(i omega t).

    Only the part of the flow that is odd in x pushes. It is matched at x = half_beam between water at the side (a propagating
    wave and evanescent ones) and under the bottom (x, and sinh(m pi x/s) cos(m pi (z + h)/s) for a gap s): potential and velocity
    are continuous in the gap, and the wall lets nothing through. 20 terms are within 0.1 % of 40.
    """
    k, gap = wavenumber(omega), depth - draft
    evanescent = []                                   # q of omega^2 = -g q tan(q h), by bisection
    for n in range(1, terms):
        low, high = (n - 0.5)*math.pi/depth + 1e-12, n*math.pi/depth
        for _ in range(60):
            middle = (low + high)/2
            low, high = (middle, high) if gravity*middle*math.tan(middle*depth) + omega**2 < 0 else (low, middle)
        evanescent.append(low)
    roots = [1j*k] + evanescent                       # cos(q (z + h)) is the shape of all of them, cosh(k (z + h)) of the first
    norm = [cmath.sqrt(depth/2 + cmath.sin(2*q*depth)/(4*q)) for q in roots]

    def overlap(q, m):                                # integral of cos(q z) cos(m pi z/s) from the bed to the bottom of the body
        a = m*math.pi/gap
        return (q*cmath.sin(q*gap)*math.cos(a*gap) - a*cmath.cos(q*gap)*math.sin(a*gap))/(q*q - a*a)

    shared = [[overlap(q, m)/d for m in range(terms)] for q, d in zip(roots, norm)]
    slope = [1/(half_beam*gap)] + [2*m*math.pi/gap**2/math.tanh(m*math.pi*half_beam/gap) for m in range(1, terms)]
    coupling = [[sum(g*a*b for g, a, b in zip(slope, row, column)) for column in shared] for row in shared]
    incident = gravity/(1j*omega)*norm[0]/math.cosh(k*depth)   # time as exp(-i omega t) up to the last line
    odd, rate = 1j*incident*math.sin(k*half_beam), 1j*k*incident*math.cos(k*half_beam)
    matrix = [[-value for value in row] for row in coupling]
    matrix[0][0] += 1j*k
    for n in range(1, terms):
        matrix[n][n] -= roots[n]
    right = [row[0]*odd for row in coupling]
    right[0] -= rate
    waves = solve(matrix, right)
    waves[0] += odd
    wall = [(cmath.sin(q*depth) - cmath.sin(q*gap))/q/d for q, d in zip(roots, norm)]
    force = -2j*omega*density*length*sum(a*b for a, b in zip(waves, wall))
    return force.conjugate()


def responses(omega):
    """Velocity, acceleration (both averaged over the draft) and force for an elevation of 1 m at the middle of the model."""
    k = wavenumber(omega)
    velocity = omega*(math.sinh(k*depth) - math.sinh(k*(depth - draft)))/(k*draft*math.sinh(k*depth))
    return velocity, 1j*omega*velocity, potential_force(omega)


def read(path):
    with open(path) as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def delay(fixed, free, guess, begin, end):
    """Seconds from the clock of `fixed` to that of `free`, in which the wavemaker does the same: least squares, then a parabola."""
    shifts = range(round(guess/step) - 30, round(guess/step) + 31)
    errors = [sum((fixed[i] - free[i + shift])**2 for i in range(begin, end, 3)) for shift in shifts]
    at = errors.index(min(errors))
    before, here, behind = errors[at - 1:at + 2]
    return (shifts[at] + (before - behind)/(before - 2*here + behind)/2)*step


def carried(free, times):
    """The three responses at `times` [s] on the clock of the run without the model, from 0.3 to 1.6 Hz, where the wave lies."""
    count = len(free["t"])
    taper = [1 if i < count - 800 else 0.5 + 0.5*math.cos(math.pi*(i - count + 800)/800) for i in range(count)]
    columns = [[0.0]*len(times) for _ in range(3)]
    for n in range(math.ceil(0.3*count*step), int(1.6*count*step) + 1):
        omega = 2*math.pi*n/(count*step)
        k, elevation = wavenumber(omega), 0
        for gauge, distance in (("eta4", 1.5), ("eta6", -1.5)):
            turn, phase, total = cmath.exp(-1j*omega*step), 1, 0
            for value, weight in zip(free[gauge], taper):
                total += value*weight*phase
                phase *= turn
            elevation += total/count*cmath.exp(-1j*k*distance)       # twice the mean, for half of either gauge
        for column, response in zip(columns, responses(omega)):
            for i, t in enumerate(times):
                column[i] += (elevation*response*cmath.exp(1j*omega*t)).real
    return columns


arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("records", type=pathlib.Path)
given = arguments.parse_args()
here = pathlib.Path(__file__).resolve().parent
# name, records, seconds when the wavemaker starts in both, first and last second kept, what the clock is set forward by
for name, with_body, without, start, start_free, first, last, forward in (
        ("wave_06", "fixed_2062", "wave_1062", 17.31, 19.07, 22, 44, 0),
        ("wave_11", "fixed_2112", "wave_1112", 21.88, 22.77, 30, 50, 1000)):
    fixed, free = read(given.records/f"{with_body}.csv"), read(given.records/f"{without}.csv")
    begin = round(start/step)
    shift = delay(fixed["wm"], free["wm"], start_free - start, begin, begin + 2400)
    rest = sum(fixed["Fy"][:3000])/3000                              # still water: what the transducer shows without a force
    rows = range(round(first/step), round(last/step), thin)
    columns = carried(free, [i*step + shift for i in rows])
    with open(here/f"{name}.csv", "w") as file:
        file.write(f"# forces of {with_body}, kinematics of {without}, made by prepare.py; see README.md for source and licence\n")
        file.write("clock,u,du,potential,force\n")
        for i, u, du, potential in zip(rows, *columns):
            file.write(f"{i*step + forward:.2f},{u:.5g},{du:.5g},{potential:.5g},{fixed['Fy'][i] - rest:.5g}\n")
