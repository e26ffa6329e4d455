#!/usr/bin/env python3
"""Times the preparation of a mesh, in milliseconds and in distance maps, over sizes, on one thread and on two.

    make bench-preparation      builds the example, writes docs/preparation.md (needs Python with NumPy, and test meshes)

Preparation leads from vertices and faces in memory to a solver that is ready for its first source: repair, connectivity,
edge lengths, intrinsic Delaunay flips, and the layout of one-rings. The unit is one distance map from one source on one
thread.
"""
import json
import os
import platform
import subprocess

from support import mesh_arguments, test_meshes, write_page


def main():
    args = mesh_arguments(__doc__, "target/release/examples/preparation", "docs/preparation.md", rounds=9)
    lines = ["| mesh | vertices | threads | connectivity ms | solver ms | both ms | one map ms | preparation in maps |",
             "|---|---|---|---|---|---|---|---|"]
    with test_meshes(args.data) as meshes:
        runs = [(title, path, 0) for title, path in meshes.items()]
        runs += [(f"armadillo, subdivided {times}", meshes["armadillo"], count)
                 for count, times in [(1, "once"), (2, "twice")]]
        for title, path, subdivisions in runs:
            rounds = max(3, args.rounds >> subdivisions)
            command = [args.program, path, str(subdivisions), str(rounds)]
            for line in subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines():
                row = json.loads(line)
                spent = " | ".join(f"{1e3 * row[part]:.1f}" for part in ("connectivity", "solver", "both", "map"))
                lines.append(f"| {title} | {row['vertices']:,} | {row['threads']} | {spent} "
                             f"| {row['both'] / row['map']:.1f} |")
                print(lines[-1], flush=True)
    page = [
        "# Preparation of a mesh",
        f"\nMeasured by `make bench-preparation` on {platform.machine()}, {os.cpu_count()} cores: medians of {args.rounds} "
        "rounds, fewer for subdivided meshes, one and two threads alternating in one process. Preparation leads from "
        "vertices and faces in memory to a solver that is ready for its first source; the unit is one distance map from "
        "one source. Compare ratios; absolute times depend on the machine.\n",
        "\n".join(lines) + "\n",
    ]
    write_page(args.output, page)


if __name__ == "__main__":
    main()
