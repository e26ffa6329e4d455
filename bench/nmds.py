#!/usr/bin/env python3
"""Compares our pipeline from mesh to canonical form with the same pipeline on potpourri3d and NumPy.

Both sides start from vertices and faces in memory and end with coordinates: setup (for canonform including repair), farthest
samples with their distances to all vertices, and Nystrom scaling. The peers implement Procedures 1 and 2 of the paper in NumPy, which
may use all cores. Stress is that of eq. 17, against exact distances from some vertices.
"""
import collections
import os
import tempfile
import time

import numpy as np

from support import (DATA, EXAMPLES, SOLVERS, Asked, benchmark, distances, machine, mesh_table, read_mesh, test_meshes)

SAMPLES, RANK, DIM = 10, 5, 3
SHARES = "canonform: % repair, distances, algebra"
PEERS = ["potpourri3d fast marching", "potpourri3d heat"]


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
    centered = squared - squared.mean(0)
    q, r = np.linalg.qr(centered @ vectors)
    gram = -0.5 * (r / values) @ r.T
    values, vectors = np.linalg.eigh((gram + gram.T) / 2)
    kept = np.argsort(-values)[:DIM]
    return q @ (vectors[:, kept] * np.sqrt(np.maximum(values[kept], 0)))


def stress(form, sources, exact):
    """Eq. 17, extrapolated from some rows."""
    straight = np.array([np.linalg.norm(form - form[source], axis=1) for source in sources])
    return np.sqrt(((straight**2 - exact**2) ** 2).sum() / len(sources) / len(form))


def measure(path, rounds):
    vertices, faces = read_mesh(path)
    sources = [int(s) for s in np.random.default_rng(0).integers(0, len(vertices), 40)]
    exact, _, _ = distances(path, "exact", sources)
    seconds, forms, parts = collections.defaultdict(list), {}, []
    with tempfile.NamedTemporaryFile() as form:
        command = [os.path.join(EXAMPLES, "forms"), path, str(SAMPLES), str(RANK), form.name]
        ours = {f"canonform, {count} thread{'s' if count > 1 else ''}": Asked(command, count)
                for count in sorted({1, os.cpu_count()})}
        for program in ours.values():
            program.ask()
        for _ in range(rounds):
            for name, program in ours.items():
                spent = program.ask()
                forms[name] = np.fromfile(form.name).reshape(-1, DIM)
                seconds[name].append(spent["total"])
            parts.append([spent[part] / spent["total"] for part in ("repair", "geodesics", "embedding")])
            for peer in PEERS:
                start = time.perf_counter()
                forms[f"{peer} + NumPy"] = nystrom(*farthest_samples(SOLVERS[peer](vertices, faces), SAMPLES))
                seconds[f"{peer} + NumPy"].append(time.perf_counter() - start)
        for program in ours.values():
            program.end()
    cells = {who: f"{1e3 * np.median(spent):.1f}, {stress(forms[who], sources, exact):.4g}"
             for who, spent in sorted(seconds.items(), key=lambda item: np.median(item[1]))}
    return len(vertices), cells | {SHARES: ", ".join(f"{share:.1f}" for share in 100 * np.median(parts, 0))}


def section(args):
    meshes = dict(list(test_meshes(args.data).items())[1:])
    yield "## Canonical forms"
    yield (f"`make bench-nmds` on {machine()}: medians of {args.rounds} rounds in processes that have run once before, {SAMPLES} "
           f"samples, rank {RANK}, from vertices and faces in memory. Cells: milliseconds, stress.")
    yield mesh_table("pipeline", meshes, lambda path: measure(path, args.rounds))


if __name__ == "__main__":
    benchmark(__doc__, section, rounds=9, data=DATA)
