"""Compares PySINDy with `cargo hil trace` on the same recordings and the same held-out motion, as a table in Markdown.

    python3 -m venv .venv && .venv/bin/pip install -r comparison/requirements.txt
    .venv/bin/python comparison/pysindy_table.py --seeds 1-12
    .venv/bin/python comparison/pysindy_table.py --pair NAME fitted.csv.gz held-out.csv.gz

HIL=path/to/hil uses an existing build of the command instead of `cargo hil`.

A seed is a simulated specimen of `cargo hil demo`. A second test with other blocks gives the held-out motion. PySINDy gets
the force as the left-hand side, and displacement, smoothed velocity and, if recorded, temperature as states. Each state is
in units of its RMS, and the temperature is relative to its mean, so that a threshold has the same meaning for all. The
library contains polynomials up to the fifth degree of all states and their products, and sgn v, |v|, |v|^a and |v|^a sgn v
for a = 0.25, 0.5, 0.75. "default" is STLSQ with its default settings. "best" has the threshold and the normalization of
columns (on or off) with the smallest error on the held-out motion itself, which favours PySINDy. `trace` lets the law's
coefficients vary with the cycle's amplitude, which is not in the library.
"""

import argparse
import gzip
import json
import os
import pathlib
import shlex
import subprocess
import tempfile
import warnings

# Regressions this small gain nothing from threads.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy
import pysindy

ROOT = pathlib.Path(__file__).resolve().parent.parent
HELD_OUT_BLOCKS = "0.12:3:8,0.18:1.5:6"
THRESHOLDS = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3]
POWERS = [0.25, 0.5, 0.75]


HIL = os.environ.get("HIL", "cargo hil")


def hil(*arguments):
    command = [*shlex.split(HIL), *map(str, arguments)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}: {done.stderr.strip()}")


def read(path):
    """Time, the states' columns, and the force, in the recording's own units."""
    opened = gzip.open(path, "rt") if str(path).endswith(".gz") else open(path)
    with opened as file:
        lines = [line for line in file if line.strip() and not line.startswith("#")]
    names = lines[0].strip().split(",")
    table = numpy.genfromtxt(lines[1:], delimiter=",")
    table = table[numpy.isfinite(table).all(axis=1)]

    def column(quantity):
        found = [i for i, name in enumerate(names) if name.startswith(quantity + "_")]
        return table[:, found[0]] if found else None

    time, displacement = column("time"), column("displacement")
    # A moving polynomial smooths before it is differentiated: PySINDy's own remedy for noise.
    smoothed = pysindy.SmoothedFiniteDifference()
    velocity = smoothed(displacement[:, None], time)[:, 0]
    states = {"y": displacement, "v": velocity}
    if column("temperature") is not None:
        states["T"] = column("temperature")
    return time, states, column("force")


def power(exponent):
    return lambda x: numpy.abs(x) ** exponent


def signed_power(exponent):
    return lambda x: numpy.abs(x) ** exponent * numpy.sign(x)


def library(names):
    functions = [power(1), signed_power(0)]
    function_names = [lambda x: f"|{x}|", lambda x: f"sgn {x}"]
    for exponent in POWERS:
        functions += [power(exponent), signed_power(exponent)]
        function_names += [
            lambda x, e=exponent: f"|{x}|^{e}",
            lambda x, e=exponent: f"|{x}|^{e} sgn {x}",
        ]
    of_all, of_velocity = list(range(len(names))), [names.index("v")]
    return pysindy.GeneralizedLibrary(
        [pysindy.PolynomialLibrary(degree=5), pysindy.CustomLibrary(functions, function_names)],
        inputs_per_library=[of_all, of_velocity],
    )


def error(predicted, measured):
    return numpy.sqrt(numpy.mean((predicted - measured) ** 2) / numpy.mean(measured**2))


class Features:
    """The library's features of a recording, in units of the fitted one's RMS, and the force to be regressed on them."""

    def __init__(self, states, force):
        # A temperature that never changes gives no information.
        self.names = [name for name, x in states.items() if numpy.ptp(x) > 0]
        # Powers of a temperature far from zero would be nearly collinear.
        self.middle = {name: numpy.mean(x) if name == "T" else 0.0 for name, x in states.items()}
        self.scale = {name: numpy.sqrt(numpy.mean((x - self.middle[name]) ** 2)) for name, x in states.items()}
        self.unit = numpy.sqrt(numpy.mean(force**2))
        self.library = library(self.names)
        self.values = numpy.asarray(self.library.fit_transform(self.inputs(states)))
        self.force = force / self.unit

    def inputs(self, states):
        return numpy.column_stack([(states[name] - self.middle[name]) / self.scale[name] for name in self.names])

    def coefficients(self, **choice):
        optimizer = pysindy.STLSQ(**choice).fit(self.values, self.force[:, None])
        return optimizer.coef_[0]

    def terms(self, coefficients):
        """The terms with the largest shares of the force, in descending order, and their number."""
        shares = numpy.sqrt(numpy.mean((self.values * coefficients) ** 2, axis=0))
        names = self.library.get_feature_names(self.names)
        order = [i for i in numpy.argsort(-shares) if coefficients[i] != 0]
        # A bar within a cell of a Markdown table has to be escaped, in code as well.
        return [names[i].replace("|", "\\|") for i in order[:4]], len(order)


def pysindy_columns(fitted, held_out):
    _, states, force = read(fitted)
    _, held_states, held_force = read(held_out)
    features = Features(states, force)
    held_values = numpy.asarray(features.library.transform(features.inputs(held_states)))

    def held_out_error(coefficients):
        return error(held_values @ coefficients, held_force / features.unit)

    choices = [{"threshold": x, "normalize_columns": n} for x in THRESHOLDS for n in (False, True)]
    default = features.coefficients()
    best = min((features.coefficients(**choice) for choice in choices), key=held_out_error)
    named, count = features.terms(best)
    return [
        percent(held_out_error(default)),
        percent(held_out_error(best)),
        f"{count} terms: " + ", ".join(f"`{name}`" for name in named),
    ]


def hil_columns(fitted, held_out, directory):
    hil("trace", fitted, "--held-out", held_out, "--out", directory)
    trace = json.loads((directory / "trace.json").read_text())
    families = ", ".join(f"`{effect['family']}`" for effect in trace["effects"])
    cause = f"`{trace['verdict']}`" + (f" {families}" if families else "")
    return [
        percent(trace["baseline"]["nrmse_held_out"]),
        percent(trace["on_target"]["nrmse_held_out"]),
        cause,
    ]


def percent(value):
    return f"{100 * value:.3g}"


def demo(seed, directory):
    """A specimen's two recordings, and its hidden effect."""
    summary = directory / "demo.json"
    hil("demo", "--seed", seed, "--out", directory / "demo", "--json", summary)
    blocks = ["--blocks", HELD_OUT_BLOCKS]
    hil("run", "--drawn", "--seed", seed, *blocks, "--out", directory / "run")
    hidden = json.loads(summary.read_text())["hidden"]["effect"]
    held_out = without_comments(directory / "run" / "recording.csv.gz")
    return directory / "demo" / "recording.csv.gz", held_out, f"`{hidden['family']}`"


def without_comments(path):
    """`demo` and `run` describe the same specimen in different words, so `trace` would assume two specimens."""
    with gzip.open(path, "rt") as file:
        lines = [line for line in file if not line.startswith("#")]
    bare = path.with_name("held-out.csv")
    bare.write_text("".join(lines))
    return bare


def seeds(text):
    first, _, last = text.partition("-")
    return range(int(first), int(last or first) + 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--seeds", type=seeds, default=[], help="of cargo hil demo, such as 1-12")
    parser.add_argument("--pair", nargs=3, action="append", default=[], metavar=("NAME", "FITTED", "HELD_OUT"))
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    print("| recording | PySINDy, default | PySINDy, best | what it calls it | law before | `hil trace` | what it calls it |")
    print("|---|---:|---:|---|---:|---:|---|")

    def row(name, fitted, held_out, directory):
        columns = pysindy_columns(fitted, held_out) + hil_columns(fitted, held_out, directory)
        print("| " + " | ".join([name, *columns]) + " |", flush=True)

    with tempfile.TemporaryDirectory() as temporary:
        for seed in asked.seeds:
            directory = pathlib.Path(temporary) / str(seed)
            fitted, held_out, hidden = demo(seed, directory)
            row(f"seed {seed}, {hidden}", fitted, held_out, directory / "trace")
        for index, (name, fitted, held_out) in enumerate(asked.pair):
            paths = [pathlib.Path(path).resolve() for path in (fitted, held_out)]
            row(name, *paths, pathlib.Path(temporary) / f"pair-{index}")


if __name__ == "__main__":
    main()
