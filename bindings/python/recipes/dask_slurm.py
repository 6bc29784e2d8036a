"""Traces a folder of recordings with Dask on a Slurm cluster. Each job has one worker for each core.

    pip install mesh-damper pandas pyarrow distributed dask-jobqueue
    python dask_slurm.py recordings/ rows.jsonl outcomes.parquet --jobs 20 --cores 16 --queue standard
    python dask_slurm.py --dry-run        # prints the job's script and submits nothing

The recordings and this folder are on a file system that all nodes can access.
"""

from __future__ import annotations

import argparse
import os

from dask_jobqueue import SLURMCluster
from dask_local import trace_all
from distributed import Client
from rows import Rows, recordings


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?")
    parser.add_argument("rows", nargs="?")
    parser.add_argument("outcomes", nargs="?")
    parser.add_argument("--jobs", type=int, default=4, help="jobs that Slurm is asked for")
    parser.add_argument("--cores", type=int, default=8, help="cores of a job, and workers in it")
    parser.add_argument("--memory", default="8GB", help="memory of a job: a trace of 1e6 rows takes half a gigabyte")
    parser.add_argument("--queue", help="Slurm's partition")
    parser.add_argument("--account", help="the account that pays")
    parser.add_argument("--walltime", default="04:00:00")
    parser.add_argument("--dry-run", action="store_true", help="print the job's script and submit nothing")
    options = parser.parse_args()
    here = os.path.dirname(os.path.abspath(__file__))
    cluster = SLURMCluster(
        cores=options.cores,
        processes=options.cores,
        memory=options.memory,
        queue=options.queue,
        account=options.account,
        walltime=options.walltime,
        # The workers find `rows.py` there.
        job_script_prologue=[f"export PYTHONPATH={here}:$PYTHONPATH"],
    )
    if options.dry_run:
        print(cluster.job_script())
        return
    if options.outcomes is None:
        parser.error("give the folder, the file of rows and the table")
    rows = Rows(options.rows, recordings(options.folder, [options.rows, options.outcomes]))
    cluster.scale(jobs=options.jobs)
    with cluster, Client(cluster) as client:
        made = trace_all(client, rows)
    print(f"{made} rows made, {rows.to_parquet(options.outcomes)} in {options.outcomes}")


if __name__ == "__main__":
    main()
