"""Searches an export of an index in LanceDB: python search_lancedb.py shapes.parquet ID [K]

    canonform index export shapes.canonform -o shapes.parquet
    pip install lancedb pyarrow
"""

import json
import math
import sys
import tempfile

import lancedb
import pyarrow as pa
import pyarrow.parquet as pq


def with_fixed_vectors(table, column="fused"):
    """The table with a vector column of fixed length, as LanceDB indexes it."""
    lists = table[column].combine_chunks()
    length = len(lists[0])
    vectors = pa.FixedSizeListArray.from_arrays(lists.flatten(), length)
    return table.set_column(table.schema.get_field_index(column), column, vectors)


def load(parquet, folder):
    """Makes a LanceDB table of an export."""
    database = lancedb.connect(folder)
    return database.create_table("shapes", with_fixed_vectors(pq.read_table(parquet)))


def nearest(table, shape, k=10):
    """Names of the k shapes nearest to a shape of the table, and their distances."""
    name = shape.replace("'", "''")
    query = table.search().where(f"id = '{name}'").limit(1).to_arrow()["fused"][0].as_py()
    found = table.search(query, vector_column_name="fused").distance_type("l2").limit(k + 1).to_list()
    # LanceDB returns squared distances.
    rows = [(row["id"], math.sqrt(max(row["_distance"], 0))) for row in found if row["id"] != shape]
    return rows[:k]


if __name__ == "__main__":
    parquet, shape, *k = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        print(json.dumps(nearest(load(parquet, folder), shape, *map(int, k)), indent=1))
