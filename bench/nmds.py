#!/usr/bin/env python3
"""Compares our pipeline from mesh to canonical form with the same pipeline on potpourri3d and NumPy.

    make bench-nmds             builds the program, sets up the environment, writes its section of docs/benchmarks.md

Both sides start from vertices and faces in memory and end with coordinates: setup per mesh (for canonform including
repair), ten farthest samples with their distances to all vertices, and Nystrom scaling of rank five, in processes
that have run once before. The peers implement Procedures 1 and 2 of the paper in NumPy, with potpourri3d's fast
marching and with its heat method; NumPy may use all cores. Stress is that of eq. 17, against exact distances from
some vertices.
"""
import json
import os
import statistics
import subprocess
import tempfile
import time

import numpy as np

from support import distances, machine, mesh_arguments, mesh_table, read_mesh, write_section

SAMPLES, RANK, DIM = 10, 5, 3
SHARES = "canonform: % repair, distances, algebra"


def farthest_samples(solve, n):
    """The p x n distances from `n` samples to all vertices; the first sample is vertex 0."""
    rows, samples = [], [0]
    nearest = np.inf
    for _ in range(n):
        rows.append(solve(samples[-1]))
        nearest = np.minimum(nearest, rows[-1])
        samples.append(int(np.argmax(nearest)))
    return np.array(rows).T, samples[:n]


def nystrom(distances, samples):
    """Coordinates of all vertices: eq. 13 to 16 of Shamai, Zibulevsky and Kimmel."""
    squared = distances**2
    block = squared[samples]
    values, vectors = np.linalg.eigh((block + block.T) / 2)
    kept = np.argsort(-np.abs(values))[:RANK]
    values, vectors = values[kept], vectors[:, kept]
    centred = squared - squared.mean(0)
    q, r = np.linalg.qr(centred @ vectors)
    gram = -0.5 * (r / values) @ r.T
    values, vectors = np.linalg.eigh((gram + gram.T) / 2)
    kept = np.argsort(-values)[:DIM]
    return q @ (vectors[:, kept] * np.sqrt(np.maximum(values[kept], 0)))


def peers(vertices, faces):
    import potpourri3d as pp3d

    def marching():
        solver = pp3d.MeshFastMarchingDistanceSolver(vertices, faces)
        return lambda s: solver.compute_distance([[(s, [])]])

    def heat():
        return pp3d.MeshHeatMethodDistanceSolver(vertices, faces).compute_distance

    return {"potpourri3d fast marching + NumPy": marching, "potpourri3d heat + NumPy": heat}


class Ours:
    """The example `forms`, which embeds a mesh on each request."""

    def __init__(self, program, path, threads, form):
        self.form = form
        self.process = subprocess.Popen([program, path, str(SAMPLES), str(RANK), form], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True,
                                        env=dict(os.environ, RAYON_NUM_THREADS=str(threads)))
        self.ask()

    def ask(self):
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline()), np.fromfile(self.form).reshape(-1, DIM)

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def stress(form, sources, exact):
    """Eq. 17, extrapolated from some rows."""
    p = len(form)
    total = 0.0
    for source, row in zip(sources, exact):
        straight = np.linalg.norm(form - form[source], axis=1)
        total += ((straight**2 - row**2) ** 2).sum()
    return np.sqrt(total * p / len(sources)) / p


def measure(program, solver, path, rounds, folder):
    vertices, faces = read_mesh(path)
    sources = [int(s) for s in np.random.default_rng(0).integers(0, len(vertices), 40)]
    exact, _, _ = distances(program, path, "exact", sources)
    cores = os.cpu_count()
    canonform = {count: Ours(solver, path, count, os.path.join(folder, "form.f64")) for count in sorted({1, cores})}
    name = lambda count: f"canonform, {count} thread{'s' if count > 1 else ''}"
    seconds, forms, parts = {}, {}, []
    for _ in range(rounds):
        for count, one in canonform.items():
            spent, forms[name(count)] = one.ask()
            seconds.setdefault(name(count), []).append(spent["total"])
        parts.append([spent[part] / spent["total"] for part in ("repair", "geodesics", "embedding")])
        for peer, make in peers(vertices, faces).items():
            start = time.perf_counter()
            forms[peer] = nystrom(*farthest_samples(make(), SAMPLES))
            seconds.setdefault(peer, []).append(time.perf_counter() - start)
    for one in canonform.values():
        one.end()
    cells = {}
    for who, spent in sorted(seconds.items(), key=lambda item: statistics.median(item[1])):
        cells[who] = f"{1e3 * statistics.median(spent):.1f}, {stress(forms[who], sources, exact):.4g}"
    repair, geodesics, algebra = 100 * np.median(parts, 0)
    cells[SHARES] = f"{repair:.1f}, {geodesics:.1f}, {algebra:.1f}"
    return len(vertices), cells


def main():
    args = mesh_arguments(__doc__, "target/release/canonform", rounds=9)
    solver = os.path.join(os.path.dirname(args.program), "examples", "forms")
    with tempfile.TemporaryDirectory() as folder:
        pipelines = mesh_table("pipeline", args.data,
                               lambda path: measure(args.program, solver, path, args.rounds, folder), 1)
    write_section(
        args.output, "bench-nmds", "## Canonical forms",
        f"`make bench-nmds` on {machine()}: medians of {args.rounds} rounds in processes that have run once before, {SAMPLES} "
        f"samples, rank {RANK}, from vertices and faces in memory. Cells: milliseconds, stress.",
        pipelines)


if __name__ == "__main__":
    main()
