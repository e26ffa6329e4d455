"""Checks that DuckDB, LanceDB and canonform give the same answers: python check.py INDEX [CANONFORM]

Exports the index, searches with every shape in all three, and compares names and distances.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import pyarrow.parquet as pq

import search_duckdb
import search_lancedb

# Vectors are 32-bit floats; programs add up their squares in different orders.
TOLERANCE = 1e-5


def of_canonform(program, index, shape, n):
    """All shapes by the distance of their signatures."""
    command = [program, "search", index, "--id", shape, "-k", str(n), "--json", "--quiet"]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    rows = [(result["id"], result["fused"]) for result in found["queries"][0]["results"] if result["id"] != shape]
    return sorted(rows, key=lambda row: (row[1], row[0]))


def same(a, b):
    """Whether two rankings agree, but for shapes at the same distance."""
    distances = dict(b)
    gaps = [abs(distance - distances[name]) for name, distance in a]
    in_order = [abs(x[1] - y[1]) for x, y in zip(a, b)]
    return len(a) == len(b) and max(gaps + in_order, default=0) < TOLERANCE


def check(index, program="canonform"):
    """Number of shapes whose neighbors were compared."""
    with tempfile.TemporaryDirectory() as folder:
        parquet = str(Path(folder) / "shapes.parquet")
        subprocess.run([program, "index", "export", index, "-o", parquet], check=True)
        names = pq.read_table(parquet, columns=["id"])["id"].to_pylist()
        table = search_lancedb.load(parquet, str(Path(folder) / "lance"))
        for name in names:
            expected = of_canonform(program, index, name, len(names))
            for store, found in [
                ("DuckDB", search_duckdb.nearest(parquet, name, len(names))),
                ("LanceDB", search_lancedb.nearest(table, name, len(names))),
            ]:
                if not same(found, expected):
                    sys.exit(f"{name}: {store} finds {found[:5]}..., canonform {expected[:5]}...")
    return len(names)


if __name__ == "__main__":
    print(f"{check(*sys.argv[1:])} shapes have the same neighbors in DuckDB, LanceDB and canonform")
