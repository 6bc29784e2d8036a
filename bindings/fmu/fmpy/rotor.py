"""A mass and a rotor on the damper, co-simulated with its FMU.

The mass is the problem that `hil respond` solves monolithically: the co-simulation has to converge to it.
"""

import csv
import math
import tempfile
from pathlib import Path

import numpy as np

import damper
from damper import MOTION, Damper

# Largest part by which the co-simulated motion may be off from the monolithic one at the shortest step, and by which it has to fall
# each time that the step is halved.
CLOSE = 0.01
FALLS = 0.75

TICK_RATE = 40_000
# kg, N, s, Hz
MASS, FORCE, DURATION, SWEEP = 300.0, 800.0, 1.0, (10.0, 60.0)


def chirp(t):
    """N, from rest."""
    first, last = SWEEP
    phase = 2 * math.pi * (first * t + 0.5 * (last - first) * t * t / DURATION)
    return FORCE * min(t / 0.1, 1.0) * math.sin(phase)


def co_simulated_mass(fmu, ticks):
    """Displacement of the mass in m at every ms, with steps of so many ticks. The force of a step's begin holds for the mass, and the
    motion of its end for the damper."""
    spring = Damper(fmu)
    size = ticks / TICK_RATE
    x = v = 0.0
    force = spring.begin(MOTION, [0.0] * 3)
    every = round(1e-3 / size)
    motion = [0.0]
    for step in range(round(DURATION / size)):
        t = step * size
        a = (chirp(t + 0.5 * size) - force) / MASS
        x, v = x + size * (v + 0.5 * size * a), v + size * a
        force = spring.step(t, size, MOTION, [x, v, a])
        if (step + 1) % every == 0:
            motion.append(x)
    return np.array(motion)


def monolithic_mass(model, work):
    excitation, response = work / "force.csv", work / "response.csv"
    with open(excitation, "w") as out:
        out.write("time_s,force_N\n")
        for sample in range(round(DURATION * 4000) + 1):
            t = sample / 4000
            out.write(f"{t:.5f},{chirp(t):.9f}\n")
    damper.hil("respond", "--model", model, "--mass", MASS, "--force", excitation, "--out", response, "--tolerance", "1e-5")
    with open(response) as rows:
        table = csv.DictReader(row for row in rows if not row.startswith("#"))
        return np.array([float(row["mass_displacement_mm"]) for row in table][::4]) / 1e3


# A rotor on a vertical shaft: disc, shaft, and a bearing that the damper carries in each of two directions. kg, N/m, N·s/m, m.
DISC, BEARING, SHAFT = 200.0, 50.0, 20e6
DAMPING = 2 * 0.005 * math.sqrt(SHAFT * DISC)
# Of quality G 6.3 at 34 Hz.
ECCENTRICITY = 30e-6
RUN_UP, SPEEDS = 6.0, (10.0, 70.0)


def exponential(matrix):
    """By its series, for a matrix far below 1."""
    term = total = np.eye(len(matrix))
    for order in range(1, 20):
        term = term @ matrix / order
        total = total + term
    return total


def run_up(fmu, size):
    """Speed in Hz, and radius of disc and bearing in m, at every step; on a rigid bearing without an FMU."""
    rigid = fmu is None
    k, c = SHAFT, DAMPING
    # Disc and bearing displacement, their velocities; then unbalance and damper force, which a step holds.
    rates = np.zeros((6, 6))
    rates[0, 2] = 1.0
    rates[2] = [-k / DISC, k / DISC, -c / DISC, 0, 1 / DISC, 0]
    if not rigid:
        rates[1, 3] = 1.0
        rates[3] = [k / BEARING, -k / BEARING, 0, 0, 0, -1 / BEARING]
    whole = exponential(rates * size)
    state = np.zeros((6, 2))
    planes = [] if rigid else [Damper(fmu, name) for name in "xy"]
    forces = [plane.begin(MOTION, [0.0] * 3) for plane in planes] or [0.0, 0.0]
    first, last = SPEEDS
    slope = 2 * math.pi * (last - first) / RUN_UP
    speeds, discs, bearings = [], [], []
    for step in range(round(RUN_UP / size)):
        t = step * size
        middle = t + 0.5 * size
        speed = 2 * math.pi * first + slope * middle
        phase = 2 * math.pi * first * middle + 0.5 * slope * middle**2
        pull = DISC * ECCENTRICITY
        state[4] = [
            pull * (speed**2 * math.cos(phase) + slope * math.sin(phase)),
            pull * (speed**2 * math.sin(phase) - slope * math.cos(phase)),
        ]
        state[5] = forces
        state = whole @ state
        for place, plane in enumerate(planes):
            disc, bearing, _, velocity = state[:4, place].tolist()
            acceleration = (k * (disc - bearing) - forces[place]) / BEARING
            forces[place] = plane.step(t, size, MOTION, [bearing, velocity, acceleration])
        speeds.append(speed / (2 * math.pi))
        discs.append(math.hypot(*state[0]))
        bearings.append(math.hypot(*state[1]))
    return np.array(speeds), np.array(discs), np.array(bearings)


def draw(path, steps, errors, damped, rigid):
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "mesh-damper", "font.size": 10, "axes.grid": True, "grid.color": "#E4E4E4"})
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(9.5, 3.8), width_ratios=[3, 2], layout="constrained")
    # A point in 5 ms: a run-up has more than a figure shows.
    thin = lambda values: values[:: max(1, len(values) // 1200)]
    speeds, discs, bearings = damped
    left.semilogy(thin(rigid[0]), 1e3 * thin(rigid[1]), color="#999999", label="disc, rigid bearing")
    left.semilogy(thin(speeds), 1e3 * thin(discs), color="#1F5FA8", label="disc, on the damper")
    left.semilogy(thin(speeds), 1e3 * thin(bearings), color="#C4572B", label="bearing, on the damper")
    left.set(xlabel="speed, Hz", ylabel="radius of the orbit, mm", title="Run-up of a rotor", xlim=SPEEDS, ylim=(1e-4, 10))
    left.legend(loc="upper left")
    right.loglog([1e3 * size for size in steps], [100 * error for error in errors], "o-", color="#1F5FA8")
    right.set_xticks([1e3 * size for size in steps], [f"{1e3 * size:g}" for size in steps])
    right.minorticks_off()
    ticks = [value for value in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50) if 0.7 * 100 * min(errors) < value < 140 * max(errors)]
    right.set_yticks(ticks, [f"{value:g}" for value in ticks])
    right.set(xlabel="communication step, ms", ylabel="off from hil respond, % of RMS", title="Mass on the damper")
    figure.savefig(path, metadata={"Date": None})


def check(root, figure):
    failures = []
    model = root / "examples/c/model.json"
    with tempfile.TemporaryDirectory() as work:
        work = Path(work)
        fmu = work / "damper.fmu"
        damper.export(model, TICK_RATE, fmu)
        whole = monolithic_mass(model, work)
        steps, errors = [], []
        for ticks in (8, 4, 2, 1):
            motion = co_simulated_mass(fmu, ticks)
            error = float(np.sqrt(np.mean((motion - whole) ** 2) / np.mean(whole**2)))
            print(f"mass: steps of {1e3 * ticks / TICK_RATE:g} ms: off from `hil respond` by {100 * error:.2f} % of the RMS")
            if errors and error > FALLS * errors[-1]:
                failures.append(f"mass: halving the step leaves {error / errors[-1]:.2f} of the error")
            steps.append(ticks / TICK_RATE)
            errors.append(error)
        row = f"| displacement off, % of its RMS | {' | '.join(f'{100 * error:.2f}' for error in errors)} |"
        if row not in (root / "docs/fmu.md").read_text():
            failures.append(f"mass: docs/fmu.md lacks {row}")
        if errors[-1] > CLOSE:
            failures.append(f"mass: off by {errors[-1]:.4f} at the shortest step, beyond {CLOSE}")
        coarse, damped = [run_up(fmu, ticks / TICK_RATE) for ticks in (2, 1)]
        rigid = run_up(None, 2 / TICK_RATE)
        peak = lambda run: (1e3 * float(run[1].max()), float(run[0][run[1].argmax()]))
        for name, run in [("on a rigid bearing", rigid), ("on the damper", damped), ("the same in twice the step", coarse)]:
            print(f"rotor {name}: radius of the disc at most {peak(run)[0]:.4f} mm, at {peak(run)[1]:.1f} Hz")
        print(f"rotor on the damper: radius of the bearing at most {1e3 * float(damped[2].max()):.4f} mm")
        if abs(peak(coarse)[0] / peak(damped)[0] - 1) > 0.05:
            failures.append("rotor: the largest radius changes by more than 5 % with the step")
        if figure:
            draw(figure, steps, errors, damped, rigid)
    return failures
