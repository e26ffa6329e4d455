#!/usr/bin/env python3
"""Compares distance solvers with other programs: time per source on one thread, and error.

The table gives medians over the rounds. `canonform` reports the time of its solver; its peers are timed around their solve
call. Setup per mesh is listed separately. Errors are relative to the exact polyhedral distances of
`canonform --method exact`, which tests compare with an independent implementation.

The variable GSP names a program for geodesic source propagation (Trettner, Bommes and Kobbelt 2021) with the arguments
mesh.obj, sources (separated by commas), repeats and output: it writes the distances, one row per source, as 64-bit
floats to the output, and the seconds of every run, one a line, to standard output. Without it, GSP is skipped.
"""
import os
import tempfile

import numpy as np

from support import (DATA, ONE_THREAD, SOLVERS, benchmark, distances, errors, generate, machine, measure_solvers, mesh_table,
                     read_mesh, run, subdivided, table, test_meshes, write_mesh)

METHODS = ["fast-marching", "exact", "heat", "dijkstra"]


def graph_of(vertices, faces):
    """Edge lengths, as a matrix of SciPy."""
    import scipy.sparse as sp

    e = np.unique(np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    lengths = np.linalg.norm(vertices[e[:, 0]] - vertices[e[:, 1]], axis=1)
    half = sp.csr_matrix((lengths, (e[:, 0], e[:, 1])), shape=(len(vertices),) * 2)
    return (half + half.T).tocsr()


def scipy_dijkstra(vertices, faces):
    from scipy.sparse.csgraph import dijkstra

    graph = graph_of(vertices, faces)
    return lambda source: dijkstra(graph, indices=source)


def meshlib(vertices, faces):
    import meshlib.mrmeshnumpy as mn
    import meshlib.mrmeshpy as mr

    mesh = mn.meshFromFacesVerts(faces.astype(np.int32), vertices)

    def solve(source):
        field = mr.computeSurfaceDistances(mesh, mr.MeshTriPoint(mesh.topology, mr.VertId(source)))
        return lambda: np.array([field.vec[i] for i in range(len(vertices))])

    return solve


def in_cache_order(vertices, faces):
    """Renumbers vertices breadth-first, and sorts faces by their first vertex."""
    from scipy.sparse.csgraph import breadth_first_order

    order = breadth_first_order(graph_of(vertices, faces), 0, directed=False, return_predecessors=False)
    order = np.concatenate([order, np.setdiff1d(np.arange(len(vertices)), order)])
    faces = np.argsort(order)[faces]
    return vertices[order], faces[np.argsort(faces.min(axis=1), kind="stable")]


def propagation_meshes(data):
    """Title and mesh of the comparison with GSP: two-manifold, in the order of their files and in cache order."""
    read = lambda name: read_mesh(os.path.join(data, name))
    yield "rocker-arm", *read("single/rocker-arm.obj")
    yield "cat0, full resolution", *read("tosca-hires/cat0.ply")
    mesh = read("single/armadillo.obj")
    yield "armadillo", *mesh
    yield "armadillo in cache order", *in_cache_order(*mesh)
    mesh = subdivided(*mesh)
    yield "armadillo, subdivided", *mesh
    yield "armadillo, subdivided twice", *subdivided(*mesh)


def propagation(gsp, data, rounds):
    """A table beside GSP."""
    names, lines = ["canonform", "GSP"], []
    with tempfile.TemporaryDirectory() as folder:
        path, out = os.path.join(folder, "mesh.obj"), os.path.join(folder, "distances")
        for title, vertices, faces in propagation_meshes(data):
            write_mesh(path, vertices, faces)
            sources = [int(s) for s in np.random.default_rng(0).integers(0, len(vertices), 3)]
            exact, _, _ = distances(path, "exact", sources)
            rows, seconds = {}, {name: [] for name in names}
            for _ in range(rounds):
                found, spent, _ = distances(path, "fast-marching", np.repeat(sources, 3))
                rows["canonform"] = found[::3]
                seconds["canonform"] += spent
                spent = run([gsp, path, ",".join(map(str, sources)), "3", out]).output.split()
                rows["GSP"] = np.fromfile(out).reshape(len(sources), -1)
                seconds["GSP"] += map(float, spent)
            fastest = {name: 1e3 * np.median(np.reshape(seconds[name], (-1, 3)).min(1)) for name in names}
            lines.append((f"{title}, {len(vertices):,}",
                          *(f"{fastest[name]:.1f}, {errors(rows[name], exact)}" for name in names)))
            print(lines[-1], flush=True)
    return table(["mesh, vertices", *names], lines)


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
    if gsp := os.environ.get("GSP"):
        yield ("*Fast marching and geodesic source propagation* (GSP; Trettner, Bommes and Kobbelt 2021), the fastest of three runs "
               "for each of three sources. Cells: milliseconds, mean and largest error in per cent.")
        yield propagation(gsp, args.data, args.rounds)


if __name__ == "__main__":
    benchmark(__doc__, section, rounds=7, data=DATA)
