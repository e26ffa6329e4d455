#!/usr/bin/env python3
"""Compares distance solvers with other programs: time per source on one thread, and error.

The table gives medians over the rounds. `canonform` reports the time of its solver; its peers are timed around their solve
call. Setup per mesh is listed separately. Errors are relative to the exact polyhedral distances of
`canonform --method exact`, which tests compare with an independent implementation.
"""
import os
import tempfile

import numpy as np

from support import DATA, ONE_THREAD, SOLVERS, benchmark, distances, generate, machine, measure_solvers, mesh_table, test_meshes

METHODS = ["fast-marching", "exact", "heat", "dijkstra"]


def scipy_dijkstra(vertices, faces):
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import dijkstra

    e = np.unique(np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    lengths = np.linalg.norm(vertices[e[:, 0]] - vertices[e[:, 1]], axis=1)
    half = csr_matrix((lengths, (e[:, 0], e[:, 1])), shape=(len(vertices),) * 2)
    graph = half + half.T
    return lambda source: dijkstra(graph, indices=source)


def meshlib(vertices, faces):
    import meshlib.mrmeshnumpy as mn
    import meshlib.mrmeshpy as mr

    mesh = mn.meshFromFacesVerts(faces.astype(np.int32), vertices)

    def solve(source):
        field = mr.computeSurfaceDistances(mesh, mr.MeshTriPoint(mesh.topology, mr.VertId(source)))
        return lambda: np.array([field.vec[i] for i in range(len(vertices))])

    return solve


def growth(sizes=(4_000, 16_000, 64_000, 256_000, 1_000_000)):
    best = []
    for size in sizes:
        with tempfile.TemporaryDirectory() as folder:
            generate(folder, "david", "--poses", 1, "--vertices", size)
            best.append(min(distances(os.path.join(folder, "david0.off"), "fast-marching", [0] * 5)[1]))
    exponent = np.polyfit(np.log(sizes), np.log(best), 1)[0]
    milliseconds = ", ".join(f"{1e3 * spent:.2f} ({size:,})" for size, spent in zip(sizes, best))
    return (f"Milliseconds per source on a generated body (vertices): {milliseconds}. Time grows with the number of vertices "
            f"to the power {exponent:.2f}.")


def section(args):
    os.environ.update(ONE_THREAD)
    solvers = SOLVERS | {"SciPy Dijkstra": scipy_dijkstra, "MeshLib computeSurfaceDistances": meshlib}
    yield "## Distance solvers"
    yield (f"`make bench-peers` on {machine()}, one thread each, medians over {args.rounds} sources. Cells: milliseconds per source, "
           "milliseconds of setup, mean and largest error in per cent of exact polyhedral distances.")
    meshes = test_meshes(args.data)
    yield mesh_table("solver", meshes, lambda path: measure_solvers(path, args.rounds, METHODS, solvers))
    yield growth()


if __name__ == "__main__":
    benchmark(__doc__, section, rounds=7, data=DATA)
