#!/usr/bin/env python3
"""From a mesh to its canonical form beside the same pipeline on potpourri3d and NumPy, in one run.

    make bench-nmds             builds the program, makes the environment, writes docs/nmds.md

Both sides start from vertices and faces in memory and end with coordinates: what is prepared once per mesh,
ten farthest samples with their distances to all vertices, and Nystrom scaling of rank five. The peer's side
is Procedures 1 and 2 of the paper in NumPy, once with potpourri3d's fast marching and once with its heat
method; NumPy may use all cores. Stress is that of eq. 17 against exact distances from some vertices.
"""
import os
import platform
import statistics
import tempfile
import time

import numpy as np

from support import answer, distances, mesh_arguments, read_mesh, test_meshes, write_page

SAMPLES, RANK, DIM = 10, 5, 3


def farthest_samples(solve, n):
    """Distances to every vertex from `n` samples, the first of them vertex 0: p x n."""
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


def ours(program, path, threads, out):
    command = [program, "embed", path, "-n", str(SAMPLES), "--rank", str(RANK), "--first-sample", "0", "--stress", "skip",
               "--threads", str(threads), "--json", "-o", out]
    return answer(command)["seconds"], np.load(out)


def stress(form, sources, exact):
    """Eq. 17 from some rows, as if from all."""
    p = len(form)
    total = 0.0
    for source, row in zip(sources, exact):
        straight = np.linalg.norm(form - form[source], axis=1)
        total += ((straight**2 - row**2) ** 2).sum()
    return np.sqrt(total * p / len(sources)) / p


def main():
    args = mesh_arguments(__doc__, "target/release/canonform", "docs/nmds.md", rounds=9)
    cores = os.cpu_count()
    page = [
        "# Canonical forms beside potpourri3d and NumPy",
        f"\nMeasured by `make bench-nmds` on {platform.machine()}, {cores} cores: medians of {args.rounds} rounds, all "
        f"interleaved in one run. {SAMPLES} samples, rank {RANK}, preparation and distances included, reading and "
        "writing not. Ratios count; the milliseconds are those of one machine on one day.\n",
    ]
    with test_meshes(args.data) as meshes, tempfile.TemporaryDirectory() as folder:
        for title, path in list(meshes.items())[1:]:
            vertices, faces = read_mesh(path)
            sources = [int(s) for s in np.random.default_rng(0).integers(0, len(vertices), 40)]
            exact, _, _ = distances(args.program, path, "exact", sources)
            seconds, forms, algebra = {}, {}, []
            for _ in range(args.rounds):
                for threads in sorted({1, cores}):
                    name = f"canonform, {threads} thread{'s' if threads > 1 else ''}"
                    spent, forms[name] = ours(args.program, path, threads, os.path.join(folder, "form.npy"))
                    seconds.setdefault(name, []).append(spent["geodesics"] + spent["embedding"])
                    if threads == cores:
                        algebra.append(spent["embedding"] / (spent["geodesics"] + spent["embedding"]))
                for name, make in peers(vertices, faces).items():
                    start = time.perf_counter()
                    forms[name] = nystrom(*farthest_samples(make(), SAMPLES))
                    seconds.setdefault(name, []).append(time.perf_counter() - start)
            best = statistics.median(seconds[f"canonform, {cores} threads" if cores > 1 else "canonform, 1 thread"])
            lines = ["| pipeline | ms | times ours | stress |", "|---|---|---|---|"]
            for name, spent in sorted(seconds.items(), key=lambda item: statistics.median(item[1])):
                spent = statistics.median(spent)
                lines.append(f"| {name} | {1e3 * spent:.1f} | {spent / best:.2f} | {stress(forms[name], sources, exact):.4g} |")
            lines.append(f"\nLinear algebra is {100 * statistics.median(algebra):.1f} % of ours on {cores} threads.\n")
            table = "\n".join(lines)
            page.append(f"## {title}, {len(vertices):,} vertices\n\n{table}")
            print(page[-1], flush=True)
    write_page(args.output, page)


if __name__ == "__main__":
    main()
