#!/usr/bin/env python3
"""Compares dense maps with pyFM: time of a pair, and error.

Both map the same pairs of shapes, one after the other, so that other load affects both alike: built-in men, and shapes of TOSCA in
full resolution, each triangulated on its own. pyFM runs its quick start, which keeps the orientation. Times include the spectra of both
shapes, and the processor seconds of canonform the whole program. The error of a vertex of A is the distance on B between its image
under the direct map and its true partner, as a share of the square root of the area; a map fails if its mean error is above a tenth.
"""
import glob
import itertools
import json
import os
import sys
import tempfile
import time
from importlib.metadata import version

import numpy as np
from scipy.spatial import cKDTree

from support import CANONFORM, DATA, EXAMPLES, benchmark, distances, machine, read_mesh, run, table

# Vertices of a pair whose errors are measured.
CHECKED = 300
FAILED = 0.1
# The quick start of pyFM 1.3.
FIT = dict(K=30, w_descr=1e0, w_lap=1e-1, w_dcomm=1e0, w_orient=1e0)
ZOOM = dict(nit=16, step=5)


def places(folder, shapes, originals):
    """For every shape, its vertices and faces, and the places of its vertices on a surface that all of its kind share."""
    found, first = {}, {}
    for name in shapes:
        vertices, faces = read_mesh(os.path.join(folder, name + ".off"))
        if name in originals:
            kind = name.rstrip("0123456789")
            own = read_mesh(originals[name])[0]
            place = first.setdefault(kind, own)[cKDTree(own).query(vertices)[1]]
        else:
            place = read_mesh(os.path.join(folder, name + "-rest.off"))[0]
        found[name] = vertices, faces, place
    return found


def area(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def ours(folder, a, b):
    out = os.path.join(folder, "map.npy")
    found = run([CANONFORM, "match", *(os.path.join(folder, name + ".off") for name in (a, b)), "-o", out, "--json", "--quiet"])
    result = json.loads(found.output)
    direct = [map["path"] for map in result["maps"] if map["kind"] == "direct"]
    seconds = result["seconds"]["prepare"] + result["seconds"]["matching"]
    return (np.load(direct[0]) if direct else None), (seconds, found.processor)


def theirs(a, b):
    from pyFM.functional import FunctionalMapping
    from pyFM.mesh import TriMesh

    # Vertices without a face make its mass matrix singular.
    used = [np.unique(faces) for _, faces in (a, b)]
    meshes = [TriMesh(vertices[some], np.searchsorted(some, faces), area_normalize=True, center=True)
              for (vertices, faces), some in zip((a, b), used)]
    # The map of points goes from the second mesh to the first.
    source, target = meshes
    start, spent = time.perf_counter(), time.process_time()
    model = FunctionalMapping(target, source)
    found = np.zeros(len(a[0]), dtype=int)
    try:
        model.preprocess(descr_type="WKS", subsample_step=2)
        model.fit(**FIT)
        found[used[0]] = used[1][model.get_p2p(model.zoomout_refine(**ZOOM))]
    except (ValueError, RuntimeError):
        found = None
    return found, (time.perf_counter() - start, time.process_time() - spent)


def measure(folder, shapes, pairs):
    """Seconds, processor seconds and mean errors by solver, a row for each pair."""
    rows = {"canonform": [], "pyFM": []}
    for a, b in pairs:
        (va, fa, from_), (vb, fb, to) = shapes[a], shapes[b]
        checked = np.arange(0, len(va), max(1, len(va) // CHECKED))
        truth = cKDTree(to).query(from_[checked])[1]
        apart = distances(os.path.join(folder, b + ".off"), "fast-marching", truth)[0] / np.sqrt(area(vb, fb))
        for name, (found, seconds) in [("canonform", ours(folder, a, b)), ("pyFM", theirs((va, fa), (vb, fb)))]:
            error = np.inf if found is None else apart[np.arange(len(checked)), found[checked]].mean()
            rows[name].append((*seconds, error))
            print(f"{a} to {b}: {name} {seconds[0]:.2f} s, {seconds[1]:.2f} s of processors, error {error:.4f}", flush=True)
    return {name: np.array(found) for name, found in rows.items()}


def spread(pairs, n):
    """Up to `n` of the pairs, evenly spread."""
    return [pairs[i * len(pairs) // n] for i in range(n)] if len(pairs) > n else pairs


def cell(rows):
    seconds, spent, errors = rows.T
    return f"{np.median(seconds):.1f}, {np.median(spent):.1f}, {mean(errors):.4f}, {np.median(errors):.4f}, {(errors > FAILED).sum()}"


def mean(errors):
    """Over the pairs of which there is a map."""
    return errors[np.isfinite(errors)].mean()


def section(args):
    meshes = sorted(glob.glob(os.path.join(args.data, "tosca-hires", "*.ply")))
    if not meshes:
        sys.exit(f"{args.data}/tosca-hires is missing: set CANONFORM_DATA to its folder")
    originals = {os.path.basename(path)[:-4]: path for path in meshes}
    groups = {"built-in men": None, "david of TOSCA": "david", "cats of TOSCA": "cat", "gorillas of TOSCA": "gorilla"}
    cells, lines = {"canonform": [], "pyFM": []}, []
    for title, kind in groups.items():
        with tempfile.TemporaryDirectory(dir=EXAMPLES) as folder:
            own = {name: path for name, path in originals.items() if kind and name.startswith(kind)}
            poses = 0 if kind else 15
            run([os.path.join(EXAMPLES, "placed_shapes"), folder, str(args.vertices), str(poses), *own.values()])
            names = list(own) if kind else [f"david{pose}" for pose in range(poses)]
            pairs = list(itertools.combinations(names, 2)) if kind else list(zip(names, names[1:]))
            found = measure(folder, places(folder, names, own), spread(pairs, args.rounds))
        for name, rows in found.items():
            cells[name].append(rows)
        lines.append((f"{title}, {len(found['pyFM'])} pairs", *map(cell, found.values())))
    own, other = map(np.vstack, cells.values())
    lines.append((f"all, {len(own)} pairs", cell(own), cell(other)))
    ratio = lambda of, column: of(other[:, column]) / of(own[:, column])
    yield "## Dense maps"
    yield (f"`make bench-maps` on {machine()}, pairs of {args.vertices:,} vertices with triangles of their own, and pyFM's "
           f"({version('pyfmaps')}) quick start. Cells: medians of elapsed and of processor seconds of a pair; mean error of direct "
           "maps as a share of the square root of the area, and median over the pairs; failed maps.")
    yield table(["shapes", *cells], lines)
    yield (f"Over all pairs, pyFM takes {ratio(np.median, 0):.1f} times as long, {ratio(np.median, 1):.1f} times the processor seconds, "
           f"and has {ratio(mean, 2):.1f} times the mean error. It gives no map of {np.isinf(other[:, 2]).sum()} pairs, whose matrices "
           "it cannot factorize.")


if __name__ == "__main__":
    benchmark(__doc__, section, rounds=6, vertices=5000, data=DATA)
