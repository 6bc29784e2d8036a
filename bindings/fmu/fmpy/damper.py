"""An FMU of a damper: exported, imported, and held against `hil predict --on f64`."""

import json
import math
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

# Where the command lies; check.py says it.
HIL = Path("hil")
# Of the largest force.
TOLERANCE = 1e-12
MOTION = [0, 1, 2]
FORCE = 16

# Effects that remember, and one of each input that there may be.
RICH = """{ "format": "mesh-damper-model", "version": 1,
  "units": { "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" },
  "law": [ { "amplitude": 0.0, "k1": 8.0, "k3": 180.0, "c": 0.3, "alpha": 0.3 } ],
  "effects": [
    { "family": "temperature", "parameters": { "beta": 0.005, "reference": 20.0 } },
    { "family": "drift", "parameters": { "cycles": 3.0, "elastic_change": 0.2 } },
    { "family": "relaxation", "parameters": { "stiffness": 0.8, "time": 0.05 } },
    { "family": "stick_slip", "parameters": { "stiffness": 8.0, "slip_limit": 0.04 } },
    { "family": "control_input", "parameters": { "stiffness": 2.0, "yield_stretch": 0.04, "rate": 0.3, "viscosity": 0.01 } } ],
  "controls": [ { "name": "current_A", "range": [0.0, 1.0] } ],
  "fitted_range": { "displacement": [-0.3, 0.3], "velocity": [-40.0, 40.0] } }"""


def hil(*arguments):
    subprocess.run([HIL, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def export(model, tick_rate, fmu):
    hil("export", "--model", model, "--format", "fmu", "--tick-rate", tick_rate, "--out", fmu)


class Damper:
    """An instance, with all values in SI units."""

    def __init__(self, fmu, name="damper"):
        self.description = read_model_description(fmu)
        # Beside the FMU, which goes with the folder that it is in.
        self.folder = extract(fmu, unzipdir=tempfile.mkdtemp(dir=Path(fmu).parent))
        self.slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.slave.instantiate()

    def begin(self, references, values):
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.setReal(references, values)
        self.slave.exitInitializationMode()
        return self.force()

    def force(self):
        return self.slave.getReal([FORCE])[0]

    def step(self, time, size, references, values):
        """The force at the end of a step with these inputs."""
        self.slave.setReal(references, values)
        self.slave.doStep(currentCommunicationPoint=time, communicationStepSize=size)
        return self.force()


def recording(path):
    """Two tones at 10 kHz with a temperature and a current. The force is about that of the damper: `predict` looks for faults in it."""
    with open(path, "w") as out:
        out.write("time_s,displacement_mm,force_kN,temperature_degC,current_A\n")
        for row in range(10_000):
            t = row * 1e-4
            tone = lambda frequency: math.sin(2 * math.pi * frequency * t)
            y = 0.14 * min(t / 0.3, 1.0) * tone(6.0) + 0.01 * tone(17.0)
            out.write(f"{t:.4f},{y:.12f},{9.0 * y:.12f},{20 + 30 * t:.4f},{0.5 + 0.4 * tone(2.0):.9f}\n")


def against_predict(model, fmu, work):
    """Largest difference of the FMU's force from that of `predict --on f64`, as a part of the largest force."""
    motion = work / "motion.json"
    hil("predict", "--model", model, work / "recording.csv", "--on", "f64", "--out", work / "predicted.csv", "--motion", motion)
    seen = json.loads(motion.read_text())
    damper = Damper(fmu)
    columns = [np.array(seen[name]) / 1e3 for name in ("displacement", "velocity", "acceleration")]
    references = list(MOTION)
    known = {variable.name: variable.valueReference for variable in damper.description.modelVariables}
    others = [("temperature", seen["temperature"]), ("cycles", seen["cycles"])]
    others += [(control["name"], control["values"]) for control in seen["controls"]]
    for name, values in others:
        if name in known:
            references.append(known[name])
            columns.append(np.array(values))
    rows = np.column_stack(columns).tolist()
    tick = seen["tick"]
    forces = [damper.begin(references, rows[0])]
    for sample, row in enumerate(rows[1:]):
        forces.append(damper.step(sample * tick, tick, references, row))
    predicted = np.array(seen["force"])
    return np.max(np.abs(np.array(forces) / 1e3 - predicted)) / np.max(np.abs(predicted)), len(references)


def states_hold(fmu):
    """Whether what follows a restored state is the same to the last bit, through bytes too."""
    damper = Damper(fmu)
    damper.begin(MOTION, [0.0] * 3)

    def run(first, last):
        motion = lambda t: [1e-4 * math.sin(90 * t), 9e-3 * math.cos(90 * t), 0.0]
        return [damper.step(k * 1e-3, 1e-3, MOTION, motion((k + 1) * 1e-3)) for k in range(first, last)]

    run(0, 40)
    saved = damper.slave.getFMUState()
    as_bytes = damper.slave.serializeFMUState(saved)
    first = run(40, 90)
    damper.slave.setFMUState(saved)
    second = run(40, 90)
    damper.slave.setFMUState(damper.slave.deSerializeFMUstate(as_bytes))
    return first == second == run(40, 90) and len(set(first)) > 40


def refuses_a_step(fmu):
    """Whether a step that is no multiple of the tick is an error."""
    damper = Damper(fmu)
    damper.begin(MOTION, [0.0] * 3)
    try:
        damper.step(0.0, 1.5e-4, MOTION, [0.0] * 3)
    except FMICallException:
        return True
    return False


def simulates(fmu):
    """Largest force in N that FMPy's own master gets from a displacement of 0.1 mm at 10 Hz."""
    time = np.arange(0, 0.2, 1e-3)
    y, v, a, _ = sine(time)
    signals = np.rec.fromarrays([time, y, v, a], names=["time", "displacement", "velocity", "acceleration"])
    result = simulate_fmu(fmu, stop_time=0.2, output_interval=1e-3, input=signals, output=["force"])
    return float(np.max(np.abs(result["force"])))


def sine(t):
    """0.1 mm at 10 Hz: displacement, velocity, acceleration and its rate."""
    rate = 2 * math.pi * 10
    y, v = 1e-4 * np.sin(rate * t), 1e-4 * rate * np.cos(rate * t)
    return [y, v, -(rate**2) * y, -(rate**2) * v]


def holding_costs(fmu):
    """Largest error of the force in N in steps of 1 ms, with inputs of the step's begin: held, and with their derivatives."""
    exact, held, sloped = [Damper(fmu) for _ in range(3)]
    for damper in (exact, held, sloped):
        damper.begin(MOTION, [float(value) for value in sine(0.0)[:3]])
    errors = [0.0, 0.0]
    for step in range(200):
        t = step * 1e-3
        for tick in range(10):
            end = t + (tick + 1) * 1e-4
            force = exact.step(end - 1e-4, 1e-4, MOTION, [float(value) for value in sine(end)[:3]])
        y, v, a, jerk = [float(value) for value in sine(t)]
        sloped.slave.setRealInputDerivatives(MOTION, [1] * 3, [v, a, jerk])
        for place, damper in enumerate((held, sloped)):
            off = abs(damper.step(t, 1e-3, MOTION, [y, v, a]) - force)
            errors[place] = max(errors[place], off)
    return errors


def check(root):
    failures = []
    with tempfile.TemporaryDirectory() as work:
        work = Path(work)
        recording(work / "recording.csv")
        (work / "rich.json").write_text(RICH)
        for name, model in [("plain", root / "examples/c/model.json"), ("rich", work / "rich.json")]:
            fmu = work / f"{name}.fmu"
            export(model, 10_000, fmu)
            problems = validate_fmu(str(fmu))
            print(f"{name}: validate_fmu finds {len(problems)} problems")
            failures += [f"{name}: {problem}" for problem in problems]
            error, inputs = against_predict(model, fmu, work)
            print(f"{name}: {inputs} inputs, force off from `hil predict --on f64` by {error:.1e} of its peak")
            if not error <= TOLERANCE:
                failures.append(f"{name}: force off by {error:.1e} of its peak, beyond {TOLERANCE:.0e}")
            for what, holds in [("states", states_hold), ("a step of 1.5 ticks refused", refuses_a_step)]:
                well = holds(fmu)
                print(f"{name}: {what}: {'well' if well else 'not'}")
                failures += [] if well else [f"{name}: {what}"]
            peak = simulates(fmu)
            held, sloped = holding_costs(fmu)
            print(f"{name}: simulate_fmu: force up to {peak:.1f} N; 1 ms held costs {held:.1f} N, with derivatives {sloped:.1f} N")
            if not 100 < peak < 10_000:
                failures.append(f"{name}: simulate_fmu gives {peak} N")
            if sloped > 0.5 * held:
                failures.append(f"{name}: derivatives of the inputs leave {sloped / held:.2f} of the error")
    return failures
