#!/usr/bin/env python3
"""Laplace-Beltrami eigenpairs beside SciPy's `eigsh`: the same two matrices, in one run.

    make bench-eigsh            builds the example, makes the environment, writes docs/eigenpairs.md

Every round solves each mesh with both, one thread each, so that whatever else the machine does falls on
both; the table gives the least wall-clock and processor time over the rounds. SciPy inverts the same shifted
matrix (SuperLU) and runs ARPACK, once as it comes and once asked for no more accuracy than ours. Residuals
are |W x - lambda M x| / (lambda |M x|), the largest over all pairs but the constant one.
"""
import os
import platform
import resource
import tempfile
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np
import scipy
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh

from support import answer, mesh_arguments, test_meshes, write_page


def ours(program, path, pairs, folder, threads):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = answer([program, path, str(pairs), folder], env=dict(os.environ, RAYON_NUM_THREADS=str(threads)))["seconds"]
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    read = lambda name: np.fromfile(os.path.join(folder, name))
    rows, columns = read("rows").astype(int), read("columns").astype(int)
    masses, values = read("masses"), read("values")
    half = sp.coo_matrix((read("stiffness"), (rows, columns)), shape=(len(masses),) * 2)
    stiffness = (half + half.T - sp.diags(half.diagonal())).tocsc()
    vectors = read("vectors").reshape(len(values), len(masses)).T
    # Reading, repair and writing are in here too.
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return stiffness, sp.diags(masses).tocsc(), values, vectors, (seconds, spent)


def residual(stiffness, masses, values, vectors):
    image = masses @ vectors[:, 1:] * values[1:]
    return (np.linalg.norm(stiffness @ vectors[:, 1:] - image, axis=0) / np.linalg.norm(image, axis=0)).max()


def measure(program, path, pairs, rounds):
    times, faults = {}, {}

    def note(name, spent, fault):
        times[name] = np.minimum(times.get(name, np.inf), spent)
        faults[name] = fault

    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds):
            w, m, values, vectors, spent = ours(program, path, pairs, folder, 1)
            note("canonform", spent, residual(w, m, values, vectors))
            shift = np.median(w.diagonal() / m.diagonal()) / w.shape[0]
            for name, tolerance in [("eigsh", 0), ("eigsh, tol=1e-9", 1e-9)]:
                start, used = time.perf_counter(), time.process_time()
                theirs, x = eigsh(w, pairs, m, sigma=-shift, tol=tolerance)
                spent = time.perf_counter() - start, time.process_time() - used
                note(name, spent, residual(w, m, theirs, x))
                gap = np.abs(theirs[1:] / values[1:] - 1).max()
                assert gap < 1e-7, f"eigenvalues differ by {gap}"
            n, cores = w.shape[0], os.cpu_count()
            *_, spent = ours(program, path, pairs, folder, cores)
            note(f"canonform, {cores} threads", spent, faults["canonform"])
    lines = ["| solver | seconds | times ours | processor seconds | largest residual |", "|---|---|---|---|---|"]
    for name, (wall, cpu) in times.items():
        lines.append(f"| {name} | {wall:.2f} | {wall / times['canonform'][0]:.2f} | {cpu:.2f} | {faults[name]:.1e} |")
    return n, "\n".join(lines)


def main():
    args = mesh_arguments(__doc__, "target/release/examples/eigenpairs", "docs/eigenpairs.md", rounds=3, pairs=300)
    page = [
        "# Eigenpairs beside SciPy",
        f"\nThe {args.pairs} smallest eigenpairs of the Laplacian, by `make bench-eigsh` on {platform.machine()}, "
        f"{os.cpu_count()} cores, one thread unless said, SciPy {scipy.__version__}: the least of {args.rounds} rounds, "
        "interleaved. The processor time of canonform holds reading, repair and writing too. Ratios count; the "
        "seconds are those of one machine on one day.\n",
    ]
    with test_meshes(args.data) as meshes:
        for title, path in meshes.items():
            n_vertices, table = measure(args.program, path, args.pairs, args.rounds)
            page.append(f"## {title}, {n_vertices:,} vertices\n\n{table}\n")
            print(page[-1], flush=True)
    write_page(args.output, page)


if __name__ == "__main__":
    main()
