"""What a call from Python costs: beside the same solve in Rust, and on a mesh of four vertices.

Run it with the package and the program `canonform` built with the same profile:

    python crates/py/bench/overhead.py target/release/canonform
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import canonform
import numpy as np

VERTICES, SOURCES, ROUNDS = 28_000, 60, 5


def seconds_of(call) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def main(program: str) -> None:
    shape = canonform.datasets.generate("cat", poses=1, n_vertices=VERTICES)[0]
    sources = np.random.default_rng(0).integers(0, VERTICES, SOURCES).tolist()
    with tempfile.TemporaryDirectory() as folder:
        [mesh] = canonform.datasets.write([shape], folder)
        rust, python = [], []
        surface = canonform.read(mesh)
        surface.distances(0)
        for _ in range(ROUNDS):
            # In turns, so that both see the same load.
            command = [program, "geodesic", mesh, "--source", ",".join(map(str, sources)), "--threads", "1", "--json"]
            command += ["-o", str(Path(folder) / "rows.npy")]
            rust += json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["seconds"]["per_source"]
            python += [seconds_of(lambda source=source: surface.distances(source)) for source in sources]
    # The fastest tenth, which other programs disturbed least.
    in_rust, in_python = np.quantile(rust, 0.1), np.quantile(python, 0.1)
    print(f"{VERTICES} vertices, fastest tenth of {len(rust)} solves: Rust {1e3 * in_rust:.3f} ms, Python {1e3 * in_python:.3f} ms")
    print(f"overhead: {100 * (in_python / in_rust - 1):.1f} %")

    four = canonform.Surface(np.eye(4)[:, :3], np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]))
    calls = [seconds_of(lambda: four.distances(0)) for _ in range(20_000)]
    print(f"4 vertices, {len(calls)} calls: median {1e6 * np.median(calls):.1f} microseconds, 99 % below {1e6 * np.quantile(calls, 0.99):.1f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
