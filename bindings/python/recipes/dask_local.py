"""Traces a folder of recordings with Dask, on the cores of this machine.

    pip install mesh-damper pandas pyarrow distributed
    python dask_local.py recordings/ rows.jsonl outcomes.parquet --workers 2

Each path is one task, and each worker has one thread: a trace uses one core.
"""

from __future__ import annotations

import argparse

from distributed import Client, LocalCluster, as_completed
from rows import Rows, recordings, row_of


def trace_all(client: Client, rows: Rows) -> int:
    """Makes the missing rows and returns their number."""
    missing = rows.missing()
    # `pure=False`: a file may have changed since another run of the same scheduler.
    futures = client.map(row_of, missing, pure=False)
    for future, row in as_completed(futures, with_results=True):
        rows.keep(row)
        # The row is on the disk, so the cluster does not have to hold it.
        future.release()
    return len(missing)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("rows", help="one line per row; finished rows are not traced again")
    parser.add_argument("outcomes", help="the table, as Parquet")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    rows = Rows(options.rows, recordings(options.folder, [options.rows, options.outcomes]))
    with LocalCluster(n_workers=options.workers, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        # The workers need `rows.py` next to this file.
        client.upload_file(__file__.replace("dask_local.py", "rows.py"))
        made = trace_all(client, rows)
    print(f"{made} rows made, {rows.to_parquet(options.outcomes)} in {options.outcomes}")


if __name__ == "__main__":
    main()
