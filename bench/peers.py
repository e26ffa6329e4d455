#!/usr/bin/env python3
"""Compares distance solvers with other programs: time per source on one thread, and error.

    make bench-peers            builds the program, sets up the environment, writes its section of docs/benchmarks.md

Each round runs all solvers on one source, so that other load on the machine affects all of them alike. The table
gives medians over the rounds. `canonform` reports the time of its solver; its peers are timed around their solve
call. Setup per mesh is listed separately. Errors are relative to the exact polyhedral distances of
`canonform --method exact`, which tests compare with an independent implementation. pygeodesic crashes on some meshes,
so it runs in its own process.

The variable GSP names a program for geodesic source propagation (Trettner, Bommes and Kobbelt 2021) with the arguments
mesh.obj, sources (separated by commas), repeats and output: it writes the distances, one row per source, as 64-bit
floats to the output, and the seconds of every run, one a line, to standard output. Without it, GSP is skipped.
"""
import math
import multiprocessing
import os
import statistics
import subprocess
import tempfile
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np

from support import (FINE, bisected, distances, in_cache_order, machine, mesh_arguments, mesh_table, read_mesh, subdivided,
                     table, write_mesh, write_section)

OURS = ["fast-marching", "exact", "heat", "dijkstra"]


def edges_of(faces):
    return np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)


def serve_pygeodesic(pipe, vertices, faces):
    from pygeodesic import geodesic

    solver = geodesic.PyGeodesicAlgorithmExact(vertices, faces)
    pipe.send("ready")
    while True:
        source = pipe.recv()
        start = time.perf_counter()
        row = solver.geodesicDistances(np.array([source]))[0]
        pipe.send((row, time.perf_counter() - start))


class Isolated:
    """A solver in its own process, which may crash."""

    def __init__(self, serve, *args):
        self.pipe, theirs = multiprocessing.Pipe()
        self.process = multiprocessing.Process(target=serve, args=(theirs, *args), daemon=True)
        self.process.start()
        theirs.close()
        self.pipe.recv()

    def __call__(self, source):
        self.pipe.send(source)
        return self.pipe.recv()


def timed(solve):
    def run(source):
        start = time.perf_counter()
        row = solve(source)
        return np.asarray(row, float), time.perf_counter() - start

    return run


def peers(vertices, faces):
    """Name -> (solve, seconds of setup), and name -> error of the solvers that failed."""
    import potpourri3d as pp3d
    import scipy.sparse as sp
    from scipy.sparse.csgraph import dijkstra
    import meshlib.mrmeshpy as mr
    import meshlib.mrmeshnumpy as mn

    def heat():
        solver = pp3d.MeshHeatMethodDistanceSolver(vertices, faces)
        return timed(solver.compute_distance)

    def marching():
        solver = pp3d.MeshFastMarchingDistanceSolver(vertices, faces)
        return timed(lambda s: solver.compute_distance([[(s, [])]]))

    def graph():
        e = np.unique(edges_of(faces), axis=0)
        lengths = np.linalg.norm(vertices[e[:, 0]] - vertices[e[:, 1]], axis=1)
        half = sp.csr_matrix((lengths, (e[:, 0], e[:, 1])), shape=(len(vertices),) * 2)
        both = (half + half.T).tocsr()
        return timed(lambda s: dijkstra(both, indices=s))

    def meshlib():
        mesh = mn.meshFromFacesVerts(faces.astype(np.int32), vertices)

        def run(s):
            start = time.perf_counter()
            field = mr.computeSurfaceDistances(mesh, mr.MeshTriPoint(mesh.topology, mr.VertId(s)))
            seconds = time.perf_counter() - start
            return np.array([field.vec[i] for i in range(len(vertices))]), seconds

        return run

    solvers, failed = {}, {}
    for name, make in [
        ("MeshLib computeSurfaceDistances", meshlib),
        ("potpourri3d heat", heat),
        ("potpourri3d fast marching", marching),
        ("pygeodesic (exact)", lambda: Isolated(serve_pygeodesic, vertices, faces)),
        ("SciPy Dijkstra", graph),
    ]:
        start = time.perf_counter()
        try:
            solvers[name] = make(), time.perf_counter() - start
        except Exception as error:
            failed[name] = str(error).splitlines()[0] if str(error) else "it crashed"
    return solvers, failed


def measure(program, path, rounds):
    vertices, faces = read_mesh(path)
    sources = [int(s) for s in np.random.default_rng(0).integers(0, len(vertices), rounds)]
    solvers, failed = peers(vertices, faces)
    rows, seconds = {}, {}
    setup = {name: prepared for name, (_, prepared) in solvers.items()}
    for source in sources:
        for method in OURS:
            name = f"canonform {method}"
            # Repeats the source, because memory is warm from the second time on, as with the peers.
            row, per_source, prepared = distances(program, path, method, [source] * 4)
            rows.setdefault(name, []).append(row[-1])
            seconds.setdefault(name, []).append(statistics.median(per_source[1:]))
            setup[name] = min(prepared, setup.get(name, math.inf))
        for name, (solve, _) in list(solvers.items()):
            try:
                row, spent = solve(source)
            except (EOFError, BrokenPipeError):
                failed[name] = "it crashed"
                del solvers[name]
                continue
            rows.setdefault(name, []).append(row)
            seconds.setdefault(name, []).append(spent)
    exact = np.array(rows["canonform exact"])
    known = np.isfinite(exact) & (exact > 0)
    cells = {}
    for name in sorted(seconds, key=lambda name: statistics.median(seconds[name])):
        if name in failed:
            continue
        relative = np.abs(np.array(rows[name]) - exact)[known] / exact[known]
        spent = statistics.median(seconds[name])
        cells[name] = (f"{1e3 * spent:.2f}, {1e3 * setup[name]:.0f}, {100 * relative.mean():.3f}, "
                       f"{100 * relative.max():.1f}")
    return len(vertices), cells | {name: f"failed: {why}" for name, why in failed.items()}


def propagation_meshes(data):
    """Title and mesh of the comparison with GSP: two-manifold, in the order of their files and in cache order."""
    single = lambda name: read_mesh(os.path.join(data, "single", name))
    yield "rocker-arm", *single("rocker-arm.obj")
    cat = read_mesh(os.path.join(data, "tosca-lowres", "cat0.vert"))
    yield "cat0, longest edges bisected", *bisected(*cat, FINE)
    mesh = single("armadillo.obj")
    yield "armadillo", *mesh
    yield "armadillo in cache order", *in_cache_order(*mesh)
    mesh = subdivided(*mesh)
    yield "armadillo, subdivided", *mesh
    yield "armadillo, subdivided twice", *subdivided(*mesh)


def propagation(program, data, rounds):
    """A table beside GSP, if the variable GSP names it."""
    gsp = os.environ.get("GSP")
    names = ["canonform"] + (["GSP"] if gsp else [])
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        path, out = os.path.join(folder, "mesh.obj"), os.path.join(folder, "distances")
        for title, vertices, faces in propagation_meshes(data):
            write_mesh(path, vertices, faces)
            sources = [int(s) for s in np.random.default_rng(0).integers(0, len(vertices), 3)]
            exact, _, _ = distances(program, path, "exact", sources)
            rows, seconds = {}, {name: [] for name in names}
            for _ in range(rounds):
                repeated = [source for source in sources for _ in range(3)]
                found, spent, _ = distances(program, path, "fast-marching", repeated)
                rows["canonform"] = found[::3]
                seconds["canonform"] += [min(spent[3 * i:3 * i + 3]) for i in range(len(sources))]
                if gsp:
                    command = [gsp, path, ",".join(map(str, sources)), "3", out]
                    run = subprocess.run(command, check=True, capture_output=True, text=True)
                    spent = [float(line) for line in run.stdout.split()]
                    rows["GSP"] = np.fromfile(out).reshape(len(sources), -1)
                    seconds["GSP"] += [min(spent[3 * i:3 * i + 3]) for i in range(len(sources))]
            known = np.isfinite(exact) & (exact > 0)
            cells = []
            for name in names:
                error = 100 * np.abs(rows[name] - exact)[known] / exact[known]
                cells.append(f"{1e3 * statistics.median(seconds[name]):.1f}, {error.mean():.3f}, {error.max():.1f}")
            lines.append((f"{title}, {len(vertices):,}", *cells))
            print(lines[-1], flush=True)
    skipped = "" if gsp else "\n\nGSP is skipped: the variable GSP does not name its program."
    return table(["mesh, vertices", *names], lines) + skipped


def wavy_torus(n_vertices):
    """An irregular closed surface of any size."""
    m = int(round(math.sqrt(n_vertices / 3)))
    n = n_vertices // m
    random = np.random.default_rng(1)
    u, v = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    u = 2 * np.pi * (u + random.uniform(-0.3, 0.3, u.shape)) / n
    v = 2 * np.pi * (v + random.uniform(-0.3, 0.3, v.shape)) / m
    r = 1 + 0.1 * np.sin(5 * u) * np.cos(3 * v)
    vertices = np.stack([(3 + r * np.cos(v)) * np.cos(u), (3 + r * np.cos(v)) * np.sin(u), r * np.sin(v)], -1)
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    at = lambda i, j: ((i % n) * m + j % m).ravel()
    a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
    return vertices.reshape(-1, 3), np.vstack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def growth(program, folder):
    sizes, best = [4_000, 16_000, 64_000, 256_000, 1_000_000], []
    for size in sizes:
        path = os.path.join(folder, f"torus{size}.obj")
        write_mesh(path, *wavy_torus(size))
        _, per_source, _ = distances(program, path, "fast-marching", [0] * 5)
        best.append(min(per_source))
        os.remove(path)
    exponent = np.polyfit(np.log(sizes), np.log(best), 1)[0]
    milliseconds = ", ".join(f"{1e3 * spent:.2f} ({size:,})" for size, spent in zip(sizes, best))
    return (f"Milliseconds per source on an irregular torus (vertices): {milliseconds}. Time grows with the number of vertices "
            f"to the power {exponent:.2f}.")


def main():
    args = mesh_arguments(__doc__, "target/release/canonform", rounds=7)
    solvers = mesh_table("solver", args.data, lambda path: measure(args.program, path, args.rounds))
    beside = propagation(args.program, args.data, args.rounds)
    with tempfile.TemporaryDirectory() as folder:
        scaling = growth(args.program, folder)
    write_section(
        args.output, "bench-peers", "## Distance solvers",
        f"`make bench-peers` on {machine()}, one thread each, medians over {args.rounds} sources. Cells: milliseconds per source, "
        "milliseconds of setup, mean and largest error in per cent of exact polyhedral distances.",
        solvers, scaling,
        "*Fast marching and geodesic source propagation* (GSP; Trettner, Bommes and Kobbelt 2021), the fastest of three runs for "
        "each of three sources. Cells: milliseconds, mean and largest error in per cent.",
        beside)


if __name__ == "__main__":
    main()
