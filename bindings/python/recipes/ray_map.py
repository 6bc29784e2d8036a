"""Traces a folder of recordings with Ray.

    pip install mesh-damper pandas pyarrow ray
    python ray_map.py recordings/ rows.jsonl outcomes.parquet --workers 2

Each path is one task. It is not a block of Ray Data, which puts several files into one batch: the trace would then be of all of them.
"""

from __future__ import annotations

import argparse

import ray
from rows import Rows, recordings, row_of


def trace_all(rows: Rows, under_way: int) -> int:
    """Makes the missing rows, `under_way` at the same time, and returns their number."""
    remote = ray.remote(num_cpus=1)(row_of)
    missing = rows.missing()
    waiting = list(reversed(missing))
    running: list[ray.ObjectRef] = []
    while waiting or running:
        while waiting and len(running) < under_way:
            running.append(remote.remote(waiting.pop()))
        done, running = ray.wait(running)
        for row in ray.get(done):
            rows.keep(row)
    return len(missing)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("rows", help="one line per row; finished rows are not traced again")
    parser.add_argument("outcomes", help="the table, as Parquet")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    rows = Rows(options.rows, recordings(options.folder, [options.rows, options.outcomes]))
    ray.init(num_cpus=options.workers, include_dashboard=False, log_to_driver=False)
    # With twice as many tasks as workers, no worker waits for its next task.
    made = trace_all(rows, 2 * options.workers)
    ray.shutdown()
    print(f"{made} rows made, {rows.to_parquet(options.outcomes)} in {options.outcomes}")


if __name__ == "__main__":
    main()
