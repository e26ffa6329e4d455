#!/usr/bin/env python3
"""Sets canonform beside the Python packages that people use: distances, embeddings, and what each does with broken meshes.

Needs no data: shapes are generated. Every package runs in a process of its own, because some crash. Packages are measured by
processor time, so that other load does not count, the solvers of canonform by elapsed time, which load can only make longer.
"""
import os
import subprocess
import tempfile
import time
from importlib.metadata import version

import numpy as np

from support import (CANONFORM, ONE_THREAD, SOLVERS, Failed, Peer, benchmark, distances, generate, machine, measure_solvers,
                     mesh_table, read_mesh, run, table, write_mesh)

METHODS = ["fast-marching", "heat", "exact"]


def gdist(vertices, faces):
    import gdist

    faces = faces.astype(np.int32)
    return lambda source: gdist.compute_gdist(vertices, faces, np.array([source], dtype=np.int32))


def classical(pairs):
    from sklearn.manifold import ClassicalMDS

    return lambda: ClassicalMDS(n_components=3, metric="precomputed").fit_transform(pairs)


def isomap(vertices):
    from sklearn.manifold import Isomap

    return lambda: Isomap(n_components=3, n_neighbors=8).fit_transform(vertices)


PEERS = SOLVERS | {"gdist (exact)": gdist}
OURS = {"canonform nmds, n = 20": ["-n", "20"], "canonform nmds, n = 100": ["-n", "100"],
        "canonform mds, all pairs": ["--method", "mds"], "canonform smacof": ["--method", "smacof"]}


def asked(make, *args, call=()):
    """What a package answers to one call, and its processor seconds."""
    peer = Peer(make, *args, clock=time.process_time)
    answered = peer.call("__call__", *call)
    peer.end()
    return answered


def embeddings(folder, path):
    """A table of the time and stress of three-dimensional embeddings, against exact distances from some vertices."""
    vertices, _ = read_mesh(path)
    sources = [int(s) for s in np.random.default_rng(2).permutation(len(vertices))[:50]]
    truth = distances(path, "exact", sources)[0]
    pairs, out = os.path.join(folder, "pairs.npy"), os.path.join(folder, "form.npy")
    rows = []

    def add(name, seconds, form):
        gap = np.linalg.norm(form[sources][:, None] - form[None], axis=2) - truth
        rows.append((name, f"{seconds:.2f}", f"{np.sqrt((gap**2).sum() / (truth**2).sum()):.4f}"))

    for name, options in OURS.items():
        spent = run([CANONFORM, "embed", path, *options, "--threads", "1", "--stress", "skip", "-o", out])
        add(name, spent.processor, np.load(out))
    measured = run([CANONFORM, "geodesic", path, "--all-pairs", "--threads", "1", "-o", pairs]).processor
    for name, make, data, before in [("scikit-learn ClassicalMDS, all pairs", classical, np.load(pairs), measured),
                                     ("scikit-learn Isomap, 8 neighbors in space", isomap, vertices, 0)]:
        try:
            form, seconds = asked(make, data)
            add(name, seconds + before, form)
        except Failed as fault:
            rows.append((name, "-", str(fault)))
    return table(["embedding", "seconds", "normalized stress"], rows)


def broken(vertices, faces):
    """Name -> a mesh with one defect."""
    n = len(vertices)
    far = vertices + [1000.0, 0, 0]
    edge = faces[0][:2]
    fin = np.vstack([vertices, vertices[faces[0][0]] + [0.0, 0, 5.0]])
    nan = vertices.copy()
    nan[7, 1] = np.nan
    pinch = faces.copy()
    pinch[pinch == faces[len(faces) // 2][0]] = faces[0][0]
    return {
        "none": (vertices, faces),
        "two components": (np.vstack([vertices, far]), np.vstack([faces, faces + n])),
        "an edge with three faces": (fin, np.vstack([faces, [[edge[0], edge[1], n]]])),
        "two vertices merged into one": (vertices, pinch),
        "a face twice": (vertices, np.vstack([faces, faces[:1]])),
        "a face with a vertex twice": (vertices, np.vstack([faces, [[0, 0, 1]]])),
        "a vertex without a face": (np.vstack([vertices, [[0.0, 0, 0]]]), faces),
        "a face turned round": (vertices, np.vstack([faces[:1, ::-1], faces[1:]])),
        "a vertex at NaN": (nan, faces),
        "a face with a vertex that does not exist": (vertices, np.vstack([faces, [[0, 1, n + 5]]])),
    }


def judged(row, truth):
    """What a row of distances is, beside the exact distances on the intact mesh."""
    row = np.atleast_1d(row)[: len(truth)]
    if len(row) < len(truth):
        return "no distances, and no error"
    if np.isnan(row).any():
        return f"{np.isnan(row).sum():,} NaN"
    if not np.isfinite(row).all():
        return f"{(~np.isfinite(row)).sum():,} infinite"
    error = np.abs(row - truth).mean() / truth.mean()
    return "right" if error < 0.1 else f"wrong by {100 * error:.0f} %" if error < 10 else "wrong by far"


def refusals(folder, path):
    """A table of what canonform and the packages do with one defect."""
    vertices, faces = read_mesh(path)
    source = int(np.argmax(vertices[:, 2]))
    truth = distances(path, "exact", [source])[0][0]
    changed, out = os.path.join(folder, "broken.off"), os.path.join(folder, "row.npy")
    lines = []
    for defect, mesh in broken(vertices, faces).items():
        write_mesh(changed, *mesh)
        ours = subprocess.run([CANONFORM, "geodesic", changed, "--source", str(source), "--method", "exact", "-o", out],
                              capture_output=True, text=True)
        if ours.returncode == 2:
            assert ", line " in ours.stderr, ours.stderr
            cells = ["error with the line"]
        else:
            cells = [judged(np.load(out)[0], truth) + (", with a note" if ours.stderr.strip() else "")]
        for make in PEERS.values():
            try:
                cells.append(judged(asked(make, *mesh, call=(source,))[0], truth))
            except Failed as fault:
                cells.append(str(fault).split(":")[0])
        print(defect, cells, flush=True)
        if set(cells) != {"right"}:
            lines.append((defect, *cells))
    return table(["defect", "canonform exact", *PEERS], lines)


def section(args):
    os.environ.update(ONE_THREAD)
    with tempfile.TemporaryDirectory() as folder:
        meshes = {}
        for n in (args.vertices, args.fine):
            shapes = os.path.join(folder, str(n))
            generate(shapes, "cat", "--poses", 1, "--vertices", n)
            meshes[n] = os.path.join(shapes, "cat0.off")
        packages = ", ".join(f"{name} {version(name)}" for name in ("potpourri3d", "pygeodesic", "gdist", "scikit-learn"))
        yield "## Beside Python packages"
        yield (f"`make bench-packages` on {machine()}, one thread each, on a built-in cat, medians over {args.rounds} sources; "
               f"processor time, but elapsed time for the solvers of canonform. {packages}. Cells: milliseconds per source, "
               "milliseconds of setup, mean and largest error in per cent of exact distances.")
        yield mesh_table("solver", {"cat": meshes[args.vertices], "fine cat": meshes[args.fine]},
                         lambda path: measure_solvers(path, args.rounds, METHODS, PEERS, time.process_time))
        yield (f"*Embeddings* of {args.vertices:,} vertices: the whole program for canonform, the call for scikit-learn. The time of "
               "ClassicalMDS includes the matrix of distances, which canonform measured. Stress is relative to exact distances from "
               "50 vertices.")
        yield embeddings(folder, meshes[args.vertices])
        yield ("*One defect in the mesh*: distances from one vertex, *right* if their mean error is below 10 %. Defects that all "
               "measure right are left out.")
        yield refusals(folder, meshes[args.vertices])


if __name__ == "__main__":
    benchmark(__doc__, section, rounds=7, vertices=3400, fine=28_000)
