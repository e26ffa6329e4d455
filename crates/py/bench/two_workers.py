"""Two Dask workers over a folder of meshes: the speed-up over one, and what a lost worker costs.

    python crates/py/bench/two_workers.py FOLDER

Prints the seconds of one worker, of two, and of two of which one is killed in the middle, and whether all indexes export the same bytes as
the index of one process.
"""

from __future__ import annotations

import os
import signal
import sys
import tempfile
import time
from pathlib import Path

from canonform import Index, set_threads
from canonform.distributed import build_index
from distributed import Client, LocalCluster


def exported(index: Index, path: Path) -> bytes:
    index.export(path)
    return path.read_bytes()


def main(folder: str) -> None:
    with tempfile.TemporaryDirectory() as place:
        out = Path(place)
        set_threads(1)
        start = time.perf_counter()
        single = Index.build(folder, out / "single.canonform")
        print(f"one process, one thread: {time.perf_counter() - start:.1f} s, {len(single)} shapes")
        expected = exported(single, out / "single.jsonl")
        for n_workers, kills in [(1, False), (2, False), (2, True)]:
            with (
                LocalCluster(n_workers=n_workers, threads_per_worker=1, dashboard_address=":0") as cluster,
                Client(cluster) as client,
            ):
                victim = next(iter(client.run(os.getpid).values()))
                killed = []

                def kill_in_the_middle(_: str, done: int, total: int) -> None:
                    if kills and not killed and done > total // 2:
                        os.kill(victim, signal.SIGKILL)  # noqa: B023
                        killed.append(done)  # noqa: B023

                start = time.perf_counter()
                index = build_index(folder, client, out / "many.canonform", n_batches=32, progress=kill_in_the_middle)
                seconds = time.perf_counter() - start
            what = f"{n_workers} workers" + (f", one killed after {killed[0]} shapes" if killed else "")
            same = exported(index, out / "many.jsonl") == expected
            assert index.build_report is not None
            print(
                f"{what}: {seconds:.1f} s, {index.build_report['described']} described, "
                f"{index.build_report['unchanged']} found again; same bytes: {same}"
            )


if __name__ == "__main__":
    main(*sys.argv[1:])
