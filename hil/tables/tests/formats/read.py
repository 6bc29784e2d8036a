"""Reads one prediction, which `hil predict` wrote in every format, with the programs that are usually used for it.

    python read.py FOLDER

FOLDER contains pred.csv, pred.csv.gz, pred.parquet, pred.mat and pred.mcap. The others are compared with the text, which has nine digits.
"""

import json
import sys
from pathlib import Path

import numpy as np
import pandas
import polars
import pyarrow.parquet
import scipy.io
from mcap.reader import make_reader

folder = Path(sys.argv[1])
with open(folder / "pred.csv") as file:
    comments = [line[1:].strip() for line in file if line.startswith("#")]
truth = pandas.read_csv(folder / "pred.csv", comment="#")
assert len(truth) > 1000 and any(name.startswith("predicted_force_") for name in truth.columns), truth.columns


def compare(name, columns):
    assert list(columns) == list(truth.columns), (name, list(columns))
    worst = 0.0
    for column, values in columns.items():
        expected = truth[column].to_numpy()
        assert len(values) == len(expected), (name, column, len(values))
        worst = max(worst, float(np.max(np.abs(values - expected)) / np.max(np.abs(expected))))
    assert worst < 1e-8, (name, worst)
    print(f"{name}: {len(columns)} columns of {len(truth)} samples, {worst:.1e} off the text's nine digits")


def arrays(frame):
    return {name: frame[name].to_numpy() for name in frame.columns}


gzipped = pandas.read_csv(folder / "pred.csv.gz", comment="#")
compare("pred.csv.gz by pandas", arrays(gzipped))
compare("pred.parquet by pandas", arrays(pandas.read_parquet(folder / "pred.parquet")))
compare("pred.parquet by polars", arrays(polars.read_parquet(folder / "pred.parquet")))
schema = pyarrow.parquet.read_schema(folder / "pred.parquet")
assert schema.field("force_kN").metadata[b"unit"] == b"kN"
own = pyarrow.parquet.read_metadata(folder / "pred.parquet").metadata
assert own[b"comments"].decode().splitlines() == comments
mat = scipy.io.loadmat(folder / "pred.mat")
columns = {name: values[:, 0] for name, values in mat.items() if name in truth.columns}
compare("pred.mat by scipy", columns)
assert mat["units"]["force_kN"][0, 0][0] == "kN"
assert [line.rstrip() for line in mat["comments"]] == comments
with open(folder / "pred.mcap", "rb") as file:
    reader = make_reader(file)
    messages = list(reader.iter_messages(topics=["/recording"]))
    described = json.loads(messages[0][0].data)["properties"]
    said = [each.metadata for each in reader.iter_metadata() if each.name == "comments"]
rows = pandas.DataFrame([json.loads(message.data) for _, _, message in messages])
compare("pred.mcap by mcap", arrays(rows[list(truth.columns)]))
assert described["force_kN"] == {"type": "number", "description": "in kN"}, described
assert list(said[0].values()) == comments
times = np.array([message.log_time for _, _, message in messages]) / 1e9
assert np.max(np.abs(times - truth["time_s"])) < 1e-9
