"""Writes one recording in many formats, with the programs that are usually used for them.

    pip install -r requirements.txt && python write.py FOLDER [FUNCTION…]

FOLDER gets the files and `files.json`. For each file, `files.json` contains the program that wrote it, the options that a reader
needs, and the permitted error. The files next to this script are its stored output; the tests read them without Python.
With names of functions below, only their files are written: what FOLDER has of the others stays.
"""

import datetime
import importlib.metadata
import json
import sys
from pathlib import Path

import numpy as np

OUT = Path(sys.argv[1])
OUT.mkdir(parents=True, exist_ok=True)

SAMPLES = 200
TIME = np.arange(SAMPLES) / 1000.0
PHASE = 2 * np.pi * 10 * TIME
DISPLACEMENT = 0.5 * np.sin(PHASE) + 0.01 * np.sin(7 * PHASE)
FORCE = 6.0 * DISPLACEMENT + 0.4 * np.cos(PHASE) + 0.013
TEMPERATURE = 21.0 + 0.5 * TIME
CURRENT = np.full(SAMPLES, 0.25)

FILES = []


def said(name, program, **more):
    """One file's entry. `error` is the permitted error of a value over the channel's largest; 0 requires equality in every bit."""
    entry = {"file": name, "program": program, "error": 0.0}
    entry.update(more)
    FILES.append(entry)
    # Some programs append to an existing file.
    (OUT / name).unlink(missing_ok=True)
    return str(OUT / name)


def version(package):
    return f"{package} {importlib.metadata.version(package)}"


SINGLE = 6e-8
ASKED = {"channels": {"time": "t", "displacement": "y", "force": "F"},
         "units": {"time": "s", "displacement": "mm", "force": "kN"}}


def truth():
    with open(OUT / "truth.csv", "w") as file:
        file.write("time_s,displacement_mm,force_kN\n")
        for row in zip(TIME, DISPLACEMENT, FORCE):
            file.write(",".join(repr(float(value)) for value in row) + "\n")


def mdf():
    from asammdf import MDF, Signal

    program = version("asammdf")

    def signal(samples, name, unit, time=TIME, **more):
        return Signal(samples=samples, timestamps=time, name=name, unit=unit, **more)

    def both(kind=np.float64):
        return [signal(DISPLACEMENT.astype(kind), "Displacement", "mm"), signal(FORCE.astype(kind), "Force", "kN")]

    def save(name, groups, compression=0, mdf_version="4.10", **more):
        file = MDF(version=mdf_version)
        for group in groups:
            file.append(group, common_timebase=True)
        path = said(name, program, **more)
        file.save(path, overwrite=True, compression=compression)
        file.close()

    save("plain.mf4", [both()], guesses=["force is read from column \"Force\" in kN"])
    save("deflated.mf4", [both()], 1)
    save("transposed.mf4", [both()], 2)
    save("columns.mf4", [both()], 0, "4.20")
    save("columns_deflated.mf4", [both()], 2, "4.20")
    save("single.mf4", [both(np.float32)], error=SINGLE)
    save("group_each.mf4", [[each] for each in both()])
    save("newton.mf4", [[both()[0], signal(1e3 * FORCE, "Load", "N")]], error=1e-15)
    step = 1e-4
    raw = np.round((DISPLACEMENT + 2) / step).astype(np.uint16)
    raw_force = np.round((FORCE + 5) / 2e-4).astype(np.uint16)
    linear = [signal(raw, "Weg", "mm", conversion={"a": step, "b": -2.0}),
              signal(raw_force, "Kraft", "kN", conversion={"a": 2e-4, "b": -5.0})]
    save("linear.mf4", [linear], 2, error=1e-4)
    # y = (P4 x² + P5 x + P6 is the denominator): x is raw, (x - 20000) / 10000.
    rational = {f"P{n}": value for n, value in enumerate([0, 1e-4, -2.0, 0, 0, 1], 1)}
    algebraic = {"formula": "X * 0.0002 - 5"}
    save("formulas.mf4", [[signal(raw, "Displacement", "mm", conversion=rational),
                           signal(raw_force, "Force", "kN", conversion=algebraic)]], error=1e-4)
    table = {"raw_0": 0.0, "phys_0": -2.0, "raw_1": 65535.0, "phys_1": -2.0 + 65535 * step, "interpolation": True}
    save("table.mf4", [[signal(raw, "Displacement", "mm", conversion=table), both()[1]]], error=1e-4)
    big = [signal(DISPLACEMENT.astype(">f8"), "Displacement", "mm"), signal(FORCE.astype(">f4"), "Force", "kN")]
    save("big_endian.mf4", [big], error=SINGLE)
    invalid = np.zeros(SAMPLES, dtype=bool)
    invalid[[17, 18]] = True
    save("invalid.mf4", [[both()[0], signal(FORCE, "Force", "kN", invalidation_bits=invalid)]], missing=[17, 18])
    slow = TIME[::20]
    save("two_rates.mf4", [both(), [signal(TEMPERATURE[::20], "Temperature", "°C", slow)]])
    save("apart.mf4", [[both()[0]], [signal(FORCE[::2], "Force", "kN", TIME[::2])]],
         refused=["displacement is in table", "1000 Hz", "force is in table", "500 Hz", "one rate"])
    state = signal(np.arange(SAMPLES) % 3, "State", "", conversion={"val_0": 0, "text_0": b"off", "default": b"on"})
    save("texts.mf4", [both() + [state]], skipped=["State"])
    plain = (OUT / "plain.mf4").read_bytes()
    path = said("unfinished.mf4", program + ", marked as never finalized", guesses=["never finalized"])
    Path(path).write_bytes(b"UnFinMF " + plain[8:])
    file = MDF(version="3.30")
    file.append(both(), common_timebase=True)
    file.save(said("version_3.mdf", program, refused=["MDF of version 3", "convert"]), overwrite=True)
    file.close()


def mat():
    import scipy.io

    program = version("scipy")

    def save(name, variables, **more):
        options = more.pop("options", {})
        scipy.io.savemat(said(name, program, **more), variables, **options)

    named = {"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_kN": FORCE}
    bare = {"t": TIME, "y": DISPLACEMENT, "F": FORCE}
    save("named.mat", named)
    save("deflated.mat", named, options={"do_compression": True})
    save("rows.mat", {key: value.reshape(1, -1) for key, value in named.items()})
    save("columns.mat", {key: value.reshape(-1, 1) for key, value in named.items()})
    save("bare.mat", bare, **ASKED)
    save("bare_unasked.mat", bare, refused=["there is no time column", "\"t\", \"y\", \"F\"", "--channel time="])
    save("single.mat", {key: value.astype(np.float32) if key != "time_s" else value for key, value in named.items()},
         error=SINGLE)
    save("integers.mat", {"time_ms": np.arange(SAMPLES, dtype=np.int32), "displacement_um": np.round(DISPLACEMENT * 1000).astype(np.int16),
                          "force_N": np.round(FORCE * 1000).astype(np.int64)}, error=1.1e-3)
    save("structure.mat", {"test": {"note": "D1 at 20 °C", "time_s": TIME, "displacement_mm": DISPLACEMENT, "force_kN": FORCE, "fs": 1000.0}},
         skipped=["the number test.fs = 1000"], comments=["test.note: D1 at 20 °C"])
    run = {"Signals": {"Time": TIME, "Actuator_Pos": DISPLACEMENT, "Axial_Load": FORCE},
           "Units": {"Time": "s", "Actuator_Pos": "mm", "Axial_Load": "kN"}}
    save("units_beside.mat", {"Run": run}, options={"do_compression": True}, guesses=["\"Axial_Load\" in kN"])
    save("units_twice.mat", {"time_s": TIME, "displacement_mm": DISPLACEMENT, "Load": FORCE, "units": {"Load": "N"}, "Units": {"Load": "kN"}},
         refused=["N beside kN", "--unit force="])
    save("matrix.mat", {"data": np.column_stack([TIME, DISPLACEMENT, FORCE])},
         channels={"time": "data #1", "displacement": "data #2", "force": "data #3"}, units=ASKED["units"])
    channel = [("Name", "O"), ("Data", "O"), ("Unit", "O"), ("XIndex", "O")]
    y = np.zeros((1, 2), dtype=channel)
    y[0, 0] = ("Model Root/Disp", DISPLACEMENT.reshape(1, -1), "mm", 1)
    y[0, 1] = ("Model Root/Force", FORCE.reshape(1, -1), "kN", 1)
    save("dspace.mat", {"exp001": {"X": {"Name": "", "Data": TIME.reshape(1, -1)}, "Y": y}}, guesses=["X of the structure"])
    signals = np.zeros((1, 2), dtype=[("values", "O"), ("dimensions", "O"), ("label", "O")])
    signals[0, 0] = (DISPLACEMENT.reshape(-1, 1), 1.0, "Displacement")
    signals[0, 1] = (FORCE.reshape(-1, 1), 1.0, "Force")
    save("simulink.mat", {"logged": {"time": TIME.reshape(-1, 1), "signals": signals, "blockName": "m/Scope"}},
         units=ASKED["units"])
    cell = np.empty((1, 3), dtype=object)
    cell[0, :] = [TIME, DISPLACEMENT, FORCE]
    save("cell.mat", {"c": cell}, channels={"time": "c{1}", "displacement": "c{2}", "force": "c{3}"}, units=ASKED["units"])
    two = {f"run{n}": {"time_s": TIME + n, "displacement_mm": DISPLACEMENT, "force_kN": FORCE} for n in range(2)}
    save("two_runs.mat", two, table="run0")
    save("two_runs_unasked.mat", two, refused=["2 tables hold a recording", "--table"])
    rated = {"displacement_mm": DISPLACEMENT, "force_kN": FORCE}
    save("rate.mat", {"Fs": 1000.0, **rated}, guesses=["the times are computed from the number Fs = 1000 Hz"], error=1e-15)
    save("step.mat", {"run": {"dt": 1e-3, **rated}, "dt": 5.0}, guesses=["the times are computed from the number run.dt = 0.001 s"], error=1e-15)
    save("rate_said.mat", {"Fs": 2.0, **rated}, rate=1000.0, skipped=["the number Fs = 2"], error=1e-15)
    save("scale.mat", {**named, "force_scale": 1e-4}, guesses=["the number force_scale = 0.0001 is not applied"])
    save("complex.mat", {**named, "z": FORCE + 1j}, skipped=["z (complex numbers)"])
    save("version_4.mat", named, options={"format": "4"}, refused=["MATLAB of version 4", "-v7"])


def parquet():
    import pandas
    import polars
    import pyarrow
    import pyarrow.feather
    import pyarrow.parquet as pq

    columns = {"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_kN": FORCE}
    frame = pandas.DataFrame(columns)
    arrow, pandas_version, polars_version = version("pyarrow"), version("pandas"), version("polars")
    frame.to_parquet(said("pandas.parquet", pandas_version))
    for compression in ["none", "gzip", "zstd", "lz4"]:
        frame.to_parquet(said(f"{compression}.parquet", pandas_version), compression=compression)
    frame.to_parquet(said("brotli.parquet", pandas_version, refused=["brotli"]), compression="brotli")
    polars.DataFrame(columns).write_parquet(said("polars.parquet", polars_version))
    import fastparquet
    fastparquet.write(said("fastparquet.parquet", version("fastparquet")), frame)
    fields = [pyarrow.field("Zeit", "f8", metadata={"unit": "s"}), pyarrow.field("Weg", "f4", metadata={"unit": "mm"}),
              pyarrow.field("Kraft", "f8", metadata={"unit": "kN"})]
    table = pyarrow.table([TIME, DISPLACEMENT.astype("f4"), FORCE], schema=pyarrow.schema(fields, metadata={"specimen": "D1"}))
    guesses = ["displacement is read from column \"Weg\" in mm"]
    pq.write_table(table, said("units.parquet", arrow, error=SINGLE, guesses=guesses, comments=["specimen: D1"]),
                   data_page_version="2.0", version="2.6", use_dictionary=False)
    pq.write_table(table, said("delta.parquet", arrow, error=SINGLE), use_dictionary=False,
                   column_encoding={"Zeit": "BYTE_STREAM_SPLIT", "Weg": "BYTE_STREAM_SPLIT", "Kraft": "PLAIN"}, row_group_size=64)
    mixed = [pyarrow.field("time_s", "f8"), pyarrow.field("displacement_mm", "f8"), pyarrow.field("force_kN", "f8", metadata={"unit": "N"})]
    renamed = pyarrow.table([TIME, DISPLACEMENT, FORCE], schema=pyarrow.schema(mixed))
    pq.write_table(renamed, said("two_units.parquet", arrow, refused=["kN beside N", "--unit force="]))
    with_units = frame.rename(columns={"force_kN": "Load", "time_s": "Time", "displacement_mm": "Stroke"})
    with_units.attrs = {"units": {"Load": "kN", "Time": "s", "Stroke": "mm"}}
    with_units.to_parquet(said("attrs.parquet", pandas_version))
    dated = frame.drop(columns="time_s")
    dated.index = pandas.Timestamp("2026-03-01 12:00:00", tz="UTC") + pandas.to_timedelta(np.arange(SAMPLES), unit="ms")
    dated.to_parquet(said("dates.parquet", pandas_version, guesses=["seconds after the first"], error=1e-15))
    nullable = frame.astype({"force_kN": "Float64"})
    nullable.loc[[17, 18], "force_kN"] = None
    nullable.to_parquet(said("nulls.parquet", pandas_version, missing=[17, 18]))
    nested = pyarrow.table({"time_s": TIME, "rig": pyarrow.StructArray.from_arrays(
        [DISPLACEMENT, pyarrow.array(["x"] * SAMPLES)], ["displacement_mm", "state"]), "force_kN": FORCE})
    pq.write_table(nested, said("nested.parquet", arrow, channels={"displacement": "rig.displacement_mm"}, skipped=["rig.state"]))
    lists = pyarrow.table({"time_s": TIME, "data": pyarrow.FixedSizeListArray.from_arrays(
        np.column_stack([DISPLACEMENT, FORCE]).ravel(), 2)})
    pq.write_table(lists, said("lists.parquet", arrow, channels={"displacement": "data #1", "force": "data #2"},
                               units={"displacement": "mm", "force": "kN"}))
    indexed = pyarrow.table({"time_ms": pyarrow.array(np.arange(SAMPLES), "uint16"),
                             "displacement_mm": pyarrow.array(DISPLACEMENT).dictionary_encode(), "force_kN": FORCE})
    with pyarrow.OSFile(said("file.arrow", arrow, error=1e-15), "wb") as sink, pyarrow.ipc.new_file(sink, indexed.schema) as writer:
        writer.write_table(indexed)
    with pyarrow.OSFile(said("stream.arrows", arrow), "wb") as sink, pyarrow.ipc.new_stream(sink, frame_table(pyarrow, columns).schema) as writer:
        writer.write_table(frame_table(pyarrow, columns), max_chunksize=70)
    pyarrow.feather.write_feather(frame, said("lz4.feather", arrow), compression="lz4")
    pyarrow.feather.write_feather(frame, said("zstd.feather", arrow), compression="zstd")
    pyarrow.feather.write_feather(frame, said("version_1.feather", arrow, refused=["Feather of version 1"]), version=1)
    polars.DataFrame(columns).write_ipc(said("polars.arrow", polars_version))


def frame_table(pyarrow, columns):
    return pyarrow.table(columns)


def hdf5():
    import h5py
    import pandas

    program = version("h5py")

    def file(name, **more):
        options = more.pop("options", {})
        return h5py.File(said(name, program, **more), "w", **options)

    named = {"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_kN": FORCE}
    with file("plain.h5") as each:
        for name, values in named.items():
            each[name] = values
    with file("latest.h5", options={"libver": "latest"}) as each:
        for name, values in named.items():
            each.create_dataset(name, data=values, chunks=(64,), maxshape=(None,), compression="gzip", shuffle=True)
    with file("gzip.h5") as each:
        for name, values in named.items():
            each.create_dataset(name, data=values, chunks=(50,), compression="gzip", shuffle=True, fletcher32=True)
    with file("lzf.h5") as each:
        for name, values in named.items():
            each.create_dataset(name, data=np.repeat(values, 1), chunks=(100,), compression="lzf", shuffle=True)
    with file("big_endian.h5", error=SINGLE) as each:
        each["time_s"] = TIME.astype(">f8")
        each["displacement_mm"] = DISPLACEMENT.astype(">f4")
        each["force_kN"] = FORCE.astype(">f8")
    with file("groups.h5", guesses=["the times of time/t are used for other groups"], comments=["specimen: D1"]) as each:
        each.attrs["specimen"] = "D1"
        for path, values, unit in [("time/t", TIME, "s"), ("signals/stroke", DISPLACEMENT, "mm"), ("signals/load", FORCE, "kN")]:
            each[path] = values
            each[path].attrs["units"] = unit
    with file("compound.h5") as each:
        rows = np.zeros(SAMPLES, dtype=[("time_s", "f8"), ("state", "S4"), ("displacement_mm", "f8"), ("force_kN", "f8")])
        for name, values in named.items():
            rows[name] = values
        each["run/samples"] = rows
    matrix = {"channels": {"time": "data #1", "displacement": "data #2", "force": "data #3"}, "units": ASKED["units"]}
    with file("matrix.h5", **matrix) as each:
        each["data"] = np.column_stack([TIME, DISPLACEMENT, FORCE])
    with file("matrix_of_rows.h5", **matrix) as each:
        each["data"] = np.vstack([TIME, DISPLACEMENT, FORCE])
    with file("scaled.h5", error=1e-4, guesses=["is multiplied by"]) as each:
        each["time_s"] = TIME
        each["displacement_mm"] = np.round(DISPLACEMENT / 1e-4).astype("i2")
        each["displacement_mm"].attrs["scale_factor"] = 1e-4
        each["force_kN"] = FORCE
    with file("two_rates.h5", skipped=["the number 1000"]) as each:
        for name, values in named.items():
            each["fast/" + name] = values
        each["slow/time_s"] = TIME[::20]
        each["slow/temperature_degC"] = TEMPERATURE[::20]
        each["fast/rate"] = 1000.0
    with file("apart.h5", refused=["displacement is in table \"fast\" (1000 Hz", "force is in table \"slow\" (500 Hz"]) as each:
        each["fast/time_s"], each["fast/displacement_mm"] = TIME, DISPLACEMENT
        each["slow/time_s"], each["slow/force_kN"] = TIME[::2], FORCE[::2]
    with file("circle.h5") as each:
        for name, values in named.items():
            each["a/" + name] = values
        each["a/b"] = h5py.SoftLink("/a")
        each["c"] = each["a"]
    for name, more in [("two_runs.h5", {"table": "run2"}), ("two_runs_unasked.h5", {"refused": ["2 tables hold a recording", "run1", "run2"]})]:
        with file(name, **more) as each:
            for run, factor in [("run1", 2.0), ("run2", 1.0)]:
                for channel, values in named.items():
                    each[f"{run}/{channel}"] = values if channel == "time_s" else factor * values
    with file("gain.h5", guesses=["attribute gain of force_kN = 2.5 is not applied", "attribute offset of force_kN = -1 is not applied"]) as each:
        for name, values in named.items():
            each[name] = values
        each["force_kN"].attrs["gain"], each["force_kN"].attrs["offset"] = 2.5, -1.0
        each["displacement_mm"].attrs["gain"] = 1.0
    with file("named_columns.h5") as each:
        each["rig/data"] = np.column_stack([TIME, DISPLACEMENT, FORCE])
        each["rig/data"].attrs["columns"] = list(named)
    with file("matrix_unasked.h5", refused=["--channel time='data #1' or --channel time='data #2'", "--rate"]) as each:
        each["data"] = np.column_stack([TIME, DISPLACEMENT, FORCE])
    with file("rate.h5", guesses=["the times are computed from attribute sample_rate of"], error=1e-15) as each:
        for name in ["displacement_mm", "force_kN"]:
            each[name] = named[name]
            each[name].attrs["sample_rate"] = 1000.0
    with file("two_rates_said.h5", refused=["--rate"]) as each:
        for name, rate in [("displacement_mm", 1000.0), ("force_kN", 500.0)]:
            each[name] = named[name]
            each[name].attrs["sample_rate"] = rate
    frame = pandas.DataFrame(named)
    for kind in ["fixed", "table"]:
        options = {"channels": {f: f"values_block_0 #{n + 1}" for n, f in enumerate(["time", "displacement", "force"])},
                   "units": ASKED["units"]} if kind == "table" else {}
        frame.to_hdf(said(f"pandas_{kind}.h5", version("pandas") + ", " + version("tables"), **options), key="run", format=kind)

    import hdf5storage
    storage = version("hdf5storage")
    hdf5storage.savemat(said("v73_storage.mat", storage), named, format="7.3", oned_as="column", store_python_metadata=False)
    test = {"test": {**named, "note": "D1"}}
    hdf5storage.savemat(said("v73_structure.mat", storage, comments=["test.note: D1"]), test, format="7.3", oned_as="row",
                        store_python_metadata=False, structured_numpy_ndarray_as_struct=True)
    with matlab_73("v73_variables.mat", channels=ASKED["channels"], units=ASKED["units"]) as each:
        for name, values in {"t": TIME, "y": DISPLACEMENT, "F": FORCE}.items():
            matlab_array(each, name, values.reshape(1, -1))
    with matlab_73("v73_dspace.mat", guesses=["X of the structure"]) as each:
        run = each.create_group("exp001")
        run.attrs["MATLAB_class"] = np.bytes_("struct")
        matlab_array(run.create_group("X"), "Data", TIME.reshape(-1, 1))
        references = each.create_group("#refs#")
        channels = run.create_group("Y")
        for group in [run["X"], channels]:
            group.attrs["MATLAB_class"] = np.bytes_("struct")
        fields = {"Data": [DISPLACEMENT.reshape(-1, 1), FORCE.reshape(-1, 1)], "Name": ["Root/Disp", "Root/Force"], "Unit": ["mm", "kN"]}
        for field, values in fields.items():
            made = []
            for index, value in enumerate(values):
                name = f"{field}{index}"
                if isinstance(value, str):
                    codes = np.frombuffer(value.encode("utf-16-le"), "u2").reshape(-1, 1)
                    matlab_array(references, name, codes, "char")
                else:
                    matlab_array(references, name, value)
                made.append(references[name].ref)
            channels.create_dataset(field, data=np.array(made, dtype=h5py.ref_dtype).reshape(-1, 1), dtype=h5py.ref_dtype)
    with matlab_73("v73_object.mat", skipped=["ts (an object of class timeseries)"]) as each:
        for name, values in named.items():
            matlab_array(each, name, values.reshape(1, -1))
        matlab_array(each, "ts", np.zeros((1, 6), "u4"), "timeseries")


def matlab_73(name, **more):
    """A file like MATLAB's own: 512 bytes that begin with its text line, followed by HDF5."""
    import h5py

    path = said(name, version("h5py") + ", laid out as MATLAB R2023b does", **more)

    class File:
        def __enter__(self):
            self.file = h5py.File(path, "w", userblock_size=512)
            return self.file

        def __exit__(self, *_):
            self.file.close()
            line = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Mar  2 10:00:00 2026 HDF5 schema 1.00 ."
            with open(path, "r+b") as file:
                file.write(line.ljust(116) + bytes(8) + b"\x00\x02IM")

    return File()


def matlab_array(group, name, values, kind="double"):
    data = group.create_dataset(name, data=values, compression="gzip", chunks=values.shape)
    data.attrs["MATLAB_class"] = np.bytes_(kind)


def tdms():
    from nptdms import ChannelObject, RootObject, TdmsWriter

    program = version("nptdms")

    def save(name, *segments, **more):
        with TdmsWriter(said(name, program, **more)) as writer:
            for segment in segments:
                writer.write_segment(segment)

    root = RootObject(properties={"specimen": "D1", "rig": "A"})
    units = {"time": {"unit_string": "s"}, "displacement": {"unit_string": "mm"}, "force": {"unit_string": "kN"}}
    names = {"time": "Time", "displacement": "Stroke", "force": "Load"}
    truth = {"time": TIME, "displacement": DISPLACEMENT, "force": FORCE}

    def channels(part=slice(None), group="Rig", kind=np.float64, keys=names):
        return [ChannelObject(group, names[key], truth[key][part].astype(np.float64 if key == "time" else kind), properties=units[key])
                for key in keys]

    save("plain.tdms", [root] + channels(), comments=["specimen: D1"], guesses=["force is read from column \"Load\" in kN"])
    save("segments.tdms", channels(slice(0, 70)), channels(slice(70, 130)), channels(slice(130, None)))
    save("single.tdms", channels(kind=np.float32), error=SINGLE)
    wave = {"wf_increment": 0.001, "wf_start_offset": 0.0, "wf_samples": SAMPLES}
    clocked = [ChannelObject("Rig", names[key], truth[key], properties={**units[key], **wave}) for key in ["displacement", "force"]]
    save("clock.tdms", clocked, error=1e-15, guesses=["there is no time column; the times are computed from wf_increment = 0.001 s"])
    slow = ChannelObject("Rig", "Temperature", TEMPERATURE[::20], properties={"unit_string": "deg C", "wf_increment": 0.02})
    save("two_rates.tdms", clocked + [slow], error=1e-15)
    half = ChannelObject("Rig", "Load", FORCE[::2], properties={"unit_string": "kN", "wf_increment": 0.002})
    save("apart.tdms", [clocked[0], half], refused=["1000 Hz", "500 Hz"])

    def started(name, starts, times=None, **more):
        made = [ChannelObject("Rig", "Time", times, properties=units["time"])] if times is not None else []
        for key, start in zip(["displacement", "force"], starts):
            said = {} if start is None else {"wf_start_time": np.datetime64("2026-03-01T12:00:00") + np.timedelta64(start, "ms")}
            made.append(ChannelObject("Rig", names[key], truth[key], properties={**units[key], **wave, **said}))
        save(name, made, error=1e-15, **more)

    started("start.tdms", [0, 0])
    started("start_apart.tdms", [0, 1000], refused=["displacement is in table", "force is in table", "sampled at different times"])
    started("start_unsaid.tdms", [0, None], guesses=["Rig/Load gives no start time (wf_start_time); it is assumed to start with the others"])
    started("start_beside_times.tdms", [0, 1000], TIME, guesses=["the times of column \"Time\" are used for all columns of its group"])
    late = {"wf_start_time": np.datetime64("2026-03-01T12:00:05")}
    halves = [ChannelObject("Rig", names[key], truth[key][:100], properties={**units[key], **wave, **start})
              for start in [{"wf_start_time": np.datetime64("2026-03-01T12:00:00")}] for key in ["displacement", "force"]]
    rest = [ChannelObject("Rig", names[key], truth[key][100:], properties=late) for key in ["displacement", "force"]]
    save("start_anew.tdms", halves, rest, error=1e-15, guesses=["the clock of Rig/Load restarted within the file"])
    step = 2e-4
    raw = {"displacement": np.round(DISPLACEMENT / step).astype(np.int16), "force": np.round((FORCE + 1) / step).astype(np.int16)}

    def scaled(name, scales, **more):
        made = [ChannelObject("Rig", "Time", TIME, properties=units["time"])]
        for key in ["displacement", "force"]:
            properties = {**units[key], "NI_Number_Of_Scales": len(scales[key]), "NI_Scaling_Status": "unscaled"}
            for index, scale in enumerate(scales[key]):
                properties.update({f"NI_Scale[{index}]_{field}": value for field, value in scale.items()})
            made.append(ChannelObject("Rig", names[key], raw[key], properties=properties))
        save(name, made, error=2e-4, **more)
        # The reference program gives the same values.
        from nptdms import TdmsFile
        group = TdmsFile.read(OUT / name)["Rig"]
        for key in ["displacement", "force"]:
            assert np.max(np.abs(group[names[key]][:] - truth[key])) <= step / 2 + 1e-12, (name, key)

    def linear(slope, offset, source=0xFFFFFFFF):
        from nptdms.types import Uint32
        return {"Scale_Type": "Linear", "Linear_Slope": slope, "Linear_Y_Intercept": offset, "Linear_Input_Source": Uint32(source)}

    def polynomial(*coefficients, source=0xFFFFFFFF):
        from nptdms.types import Uint32
        fields = {f"Polynomial_Coefficients[{n}]": float(value) for n, value in enumerate(coefficients)}
        return {"Scale_Type": "Polynomial", "Polynomial_Coefficients_Size": len(coefficients),
                "Polynomial_Input_Source": Uint32(source), **fields}

    def table(x, y, source=0xFFFFFFFF):
        from nptdms.types import Uint32
        fields = {"Scale_Type": "Table", "Table_Input_Source": Uint32(source),
                  "Table_Pre_Scaled_Values_Size": len(x), "Table_Scaled_Values_Size": len(y)}
        fields.update({f"Table_Pre_Scaled_Values[{n}]": float(value) for n, value in enumerate(x)})
        fields.update({f"Table_Scaled_Values[{n}]": float(value) for n, value in enumerate(y)})
        return fields

    scaled("linear.tdms", {"displacement": [linear(step, 0.0)], "force": [linear(step, -1.0)]})
    scaled("polynomial.tdms", {"displacement": [polynomial(0.0, step, 0.0)], "force": [linear(step, 0.0), polynomial(-1.0, 1.0, source=0)]})
    scaled("table.tdms", {"displacement": [table([-32768, 32767], [-32768 * step, 32767 * step])], "force": [linear(step, -1.0)]})
    strings = ChannelObject("Rig", "Note", ["a", "bc"] * (SAMPLES // 2))
    save("texts.tdms", channels() + [strings], skipped=["Rig/Note"])
    stamps = np.datetime64("2026-03-01T12:00:00.000000") + (np.arange(SAMPLES) * 1000).astype("timedelta64[us]")
    save("dates.tdms", [ChannelObject("Rig", "Time", stamps)] + channels(keys=["displacement", "force"]), error=1e-15,
         guesses=["seconds after the first"])
    index = OUT / "index.tdms_index"
    said("index.tdms_index", program, refused=["index of a TDMS file"])
    with TdmsWriter(str(OUT / "throwaway.tdms"), index_file=True) as writer:
        writer.write_segment(channels())
    (OUT / "throwaway.tdms_index").rename(index)
    (OUT / "throwaway.tdms").unlink()


def tdms_raw():
    """Variants that nptdms reads but does not write: interleaved values, the other byte order, and raw values of a DAQmx logger."""
    import struct

    from nptdms import TdmsFile

    step = 2e-4
    truth = {"Time": TIME, "Stroke": DISPLACEMENT, "Load": FORCE}
    units = {"Time": "s", "Stroke": "mm", "Load": "kN"}

    def save(name, order, bits, objects, raw, **more):
        text = lambda words: struct.pack(order + "I", len(words.encode())) + words.encode()
        meta = struct.pack(order + "I", len(objects))
        for path, index, properties in objects:
            meta += text(path) + index + struct.pack(order + "I", len(properties))
            for key, value in properties.items():
                meta += text(key)
                if isinstance(value, str):
                    meta += struct.pack(order + "I", 0x20) + text(value)
                elif isinstance(value, int):
                    meta += struct.pack(order + "II", 7, value)
                else:
                    meta += struct.pack(order + "Id", 10, value)
        lead = b"TDSm" + struct.pack("<I", bits) + struct.pack(order + "IQQ", 4713, len(meta) + len(raw), len(meta))
        Path(said(name, "a script, as nptdms " + importlib.metadata.version("nptdms") + " reads it", **more)).write_bytes(lead + meta + raw)
        group = TdmsFile.read(OUT / name)["Rig"]
        for channel, values in truth.items():
            assert np.max(np.abs(group[channel][:] - values)) <= step / 2 + 1e-12, (name, channel)

    def plain(order, code, count):
        return struct.pack(order + "IIIQ", 20, code, 1, count)

    rows = np.column_stack(list(truth.values()))
    for name, order, flag in [("interleaved.tdms", "<", 0), ("big_endian.tdms", ">", 0x40)]:
        objects = [(f"/'Rig'/'{key}'", plain(order, 10, 50), {"unit_string": units[key]}) for key in truth]
        # Four chunks of fifty rows.
        save(name, order, 0x2 | 0x4 | 0x8 | 0x20 | flag, objects, rows.astype(order + "f8").tobytes())

    def daqmx(kind, at, scale):
        return struct.pack("<IIIQ", 0x1269, 0xFFFFFFFF, 1, SAMPLES) + struct.pack("<I5I", 1, kind, 0, at, 0, scale) + struct.pack("<II", 1, 8)

    raw = np.zeros(SAMPLES, dtype=[("time", "<i4"), ("stroke", "<i2"), ("load", "<i2")])
    raw["time"] = np.round(TIME / 1e-3)
    raw["stroke"], raw["load"] = np.round(DISPLACEMENT / step), np.round((FORCE + 1) / step)
    objects = []
    for key, kind, at, slope, offset in [("Time", 5, 0, 1e-3, 0.0), ("Stroke", 3, 4, step, 0.0), ("Load", 3, 6, step, -1.0)]:
        scale = {"NI_Number_Of_Scales": 2, "NI_Scaling_Status": "unscaled", "NI_Scale[1]_Scale_Type": "Linear", "NI_Scale[1]_Linear_Slope": slope,
                 "NI_Scale[1]_Linear_Y_Intercept": offset, "NI_Scale[1]_Linear_Input_Source": 0, "unit_string": units[key]}
        objects.append((f"/'Rig'/'{key}'", daqmx(kind, at, 0), scale))
    save("daqmx.tdms", "<", 0x2 | 0x4 | 0x8 | 0x80, objects, raw.tobytes(), error=2e-4)


def json_files():
    import pandas

    frame = pandas.DataFrame({"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_kN": FORCE})
    program = version("pandas")
    for orient in ["split", "records", "columns", "table"]:
        frame.to_json(said(f"{orient}.json", program, error=1e-14), orient=orient, double_precision=15, **({"index": False} if orient == "table" else {}))
    frame.to_json(said("lines.jsonl", program, error=1e-14), orient="records", lines=True, double_precision=15)
    columns = {"time": TIME.tolist(), "displacement": DISPLACEMENT.tolist(), "force": FORCE.tolist()}
    units = {"time": "s", "displacement": "mm", "force": "kN"}
    Path(said("arrays.json", "Python's json")).write_text(json.dumps({"specimen": "D1", "units": units, **columns}))
    gap = {**columns, "force": [None if n in (17, 18) else value for n, value in enumerate(columns["force"])]}
    Path(said("nulls.json", "Python's json", missing=[17, 18], units=units)).write_text(json.dumps({"run": {"data": gap}}, indent=1))
    for name, said_rate in [("rate.json", {"fs": 1000}), ("step.json", {"dt_ms": 1.0})]:
        rated = {"units": units, **said_rate, "displacement": columns["displacement"], "force": columns["force"]}
        words = f"the times are computed from the number {next(iter(said_rate))}"
        Path(said(name, "Python's json", guesses=[words], error=1e-15)).write_text(json.dumps(rated))
    runs = {run: {"units": units, **columns} for run in ["first", "second"]}
    Path(said("two_runs.json", "Python's json", refused=["2 tables hold a recording", "first", "second"])).write_text(json.dumps(runs))
    rows = [list(row) for row in zip(*columns.values())]
    named = {key: f"value #{n + 1}" for n, key in enumerate(columns)}
    Path(said("rows.json", "Python's json", channels=named, units=units)).write_text(json.dumps(rows))
    Path(said("short.json", "Python's json", refused=["force"])).write_text(json.dumps({"units": units, **columns, "force": columns["force"][:-1]}))


def xlsx():
    import openpyxl
    import pandas

    frame = pandas.DataFrame({"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_kN": FORCE})
    with pandas.ExcelWriter(said("pandas.xlsx", version("pandas") + ", " + version("openpyxl"), error=1e-15), engine="openpyxl") as writer:
        frame.to_excel(writer, index=False, sheet_name="Run 1")
    with pandas.ExcelWriter(said("xlsxwriter.xlsx", version("xlsxwriter"), error=1e-15), engine="xlsxwriter") as writer:
        frame.to_excel(writer, index=False)
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.title = "Messung"
    for row in [["Prüfling", "D1"], [], ["Zeit", "Weg", "Kraft"], ["s", "mm", "kN"]]:
        sheet.append(row)
    for row in zip(TIME, DISPLACEMENT, FORCE):
        sheet.append([float(value) for value in row])
    dated = openpyxl.Workbook()
    dated.active.append(["Date", "Displacement [mm]", "Force [kN]"])
    for n, row in enumerate(zip(DISPLACEMENT, FORCE)):
        stamp = datetime.datetime(2026, 3, 1, 12) + datetime.timedelta(milliseconds=n)
        dated.active.append([stamp, *map(float, row)])
    # A date in Excel resolves 2^-37 of a day: 0.6 µs.
    dated.save(said("dates.xlsx", version("openpyxl"), error=1e-5, channels={"time": "Date"}, guesses=["seconds after the first"]))
    def saved(name, rows, *sheets, **more):
        made = openpyxl.Workbook()
        for place, each in enumerate([*sheets, rows]):
            sheet = made.active if place == 0 else made.create_sheet(f"Sheet {place + 1}")
            for row in each:
                sheet.append(row)
        made.save(said(name, version("openpyxl"), **{"error": 1e-15, **more}))

    numbers = [[float(value) for value in row] for row in zip(TIME, DISPLACEMENT, FORCE)]
    head = ["Time [s]", "Disp [mm]", "Force [kN]"]
    preamble = [["Rig 4"], ["Operator", "X"], ["Limits", 1, 2, 3], [], ["Time", "Disp", "Force"], ["s", "mm", "kN"]]
    saved("preamble.xlsx", preamble + numbers, guesses=["the names are in line 5, the units in line 6"], comments=["Operator: X"])
    summary = [["Cycle", "Max Load [kN]", "Max disp [mm]"]] + [[n, 1.0 + n, 2.0] for n in range(5)]
    below = [["Max", float(max(DISPLACEMENT)), float(max(FORCE))]]
    saved("below.xlsx", [head] + numbers + below, summary, refused=["line 202", "\"Max\" is not a number"])
    for name, sign in [("comma_texts.xlsx", ","), ("point_texts.xlsx", ".")]:
        texts = [[repr(value).replace(".", sign) for value in row] for row in numbers]
        words = {",": "comma", ".": "point"}[sign]
        saved(name, [head] + texts, guesses=[f"numbers stored as text are read with a decimal {words}"])
    mixed = [[time, repr(y).replace(".", ","), force] for time, y, force in numbers]
    saved("some_texts.xlsx", [head] + mixed, guesses=["numbers stored as text are read with a decimal comma"])
    thousands = [[time, y, f"{100 + force:.3f}"] for time, y, force in numbers]
    saved("either_texts.xlsx", [["Time [s]", "Disp [mm]", "Force [N]"]] + thousands, refused=["--decimal point or --decimal comma"])
    away = [[], []] + [[None, None, *row] for row in [head] + numbers]
    saved("away.xlsx", away)
    notes = book.create_sheet("Notizen")
    notes.append(["nichts"])
    book.save(said("units.xlsx", version("openpyxl"), error=1e-15, guesses=["force is read from column \"Kraft\" in kN"]))


ALL = [mdf, mat, parquet, hdf5, tdms, tdms_raw, json_files, xlsx]
ONLY = sys.argv[2:]
truth()
for write in ALL:
    if not ONLY or write.__name__ in ONLY:
        write()
if ONLY:
    written = [entry["file"] for entry in FILES]
    stored = json.loads((OUT / "files.json").read_text())
    FILES = [entry for entry in stored if entry["file"] not in written] + FILES
(OUT / "files.json").write_text(json.dumps(FILES, indent=1, ensure_ascii=False) + "\n")
print(f"{len(FILES)} files, {sum(path.stat().st_size for path in OUT.iterdir())} bytes")
