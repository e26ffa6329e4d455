"""Searches an export of an index in DuckDB: python search_duckdb.py shapes.parquet ID [K]

    canonform index export shapes.canonform -o shapes.parquet
    pip install duckdb
"""

import json
import sys

import duckdb


def nearest(parquet, shape, k=10):
    """Names of the k shapes nearest to a shape of the index, and their distances."""
    connection = duckdb.connect()
    table = connection.read_parquet(parquet)
    connection.register("shapes", table)
    # Distances need vectors of a fixed length, which is the same for all shapes of an index.
    length = connection.execute("SELECT len(fused) FROM shapes LIMIT 1").fetchone()[0]
    query = f"""
        SELECT s.id, array_distance(s.fused::FLOAT[{length}], q.fused::FLOAT[{length}]) AS distance
        FROM shapes s, shapes q
        WHERE q.id = ? AND s.id <> q.id
        ORDER BY distance, s.id
        LIMIT ?
    """
    return connection.execute(query, [shape, k]).fetchall()


if __name__ == "__main__":
    parquet, shape, *k = sys.argv[1:]
    print(json.dumps(nearest(parquet, shape, *map(int, k)), indent=1))
