#!/usr/bin/env python3
"""Times the preparation of a mesh, in milliseconds and in distance maps, over sizes, on one thread and on two.

It leads from vertices and faces in memory to a solver that is ready for its first source: repair, connectivity, edge lengths,
intrinsic Delaunay flips, and the layout of one-rings.
"""
import json
import os

from support import DATA, EXAMPLES, benchmark, machine, run, table, test_meshes


def section(args):
    lines = {}
    meshes = test_meshes(args.data)
    runs = [(title, path, 0) for title, path in meshes.items()]
    runs += [(f"armadillo, subdivided {times}", meshes["armadillo"], count) for count, times in [(1, "once"), (2, "twice")]]
    for title, path, subdivisions in runs:
        rounds = max(3, args.rounds >> subdivisions)
        for line in run([os.path.join(EXAMPLES, "preparation"), path, str(subdivisions), str(rounds)]).output.splitlines():
            row = json.loads(line)
            spent = ", ".join(f"{1e3 * row[part]:.1f}" for part in ("connectivity", "solver", "map"))
            cells = lines.setdefault(f"{title}, {row['vertices']:,}", {})
            cells[row["threads"]] = f"{spent}, {row['both'] / row['map']:.1f}"
            print(title, cells, flush=True)
    threads = sorted({count for cells in lines.values() for count in cells})
    yield "## Preparation of a mesh"
    yield (f"`make bench-preparation` on {machine()}: from vertices and faces in memory to a solver that is ready for its first "
           f"source, medians of {args.rounds} rounds, fewer for subdivided meshes. Cells: milliseconds of connectivity, of the "
           "solver and of one distance map; preparation in maps.")
    yield table(["mesh, vertices", *(f"{count} thread{'s' if count > 1 else ''}" for count in threads)],
                [[title, *(cells.get(count, "-") for count in threads)] for title, cells in lines.items()])


if __name__ == "__main__":
    benchmark(__doc__, section, rounds=9, data=DATA)
