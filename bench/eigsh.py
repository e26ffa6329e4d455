#!/usr/bin/env python3
"""Compares Laplace-Beltrami eigenpairs with SciPy's `eigsh` on the same matrices.

    make bench-eigsh            builds the example, sets up the environment, writes its section of docs/benchmarks.md

Each round runs both solvers on one thread each, so that other load on the machine affects both alike. The table gives
the smallest wall-clock and processor time over the rounds. SciPy factorizes the same shifted matrix (SuperLU) and runs
ARPACK, with its default tolerance and with that of canonform. Residuals are |W x - lambda M x| / (lambda |M x|), the
largest over all pairs except the constant one.
"""
import os
import resource
import tempfile
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np
import scipy
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh

from support import answer, machine, mesh_arguments, mesh_table, write_section


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
    # Includes reading, repair and writing.
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
    return n, {name: f"{wall:.2f}, {cpu:.2f}, {faults[name]:.1e}" for name, (wall, cpu) in times.items()}


def main():
    args = mesh_arguments(__doc__, "target/release/examples/eigenpairs", rounds=3, pairs=300)
    solvers = mesh_table("solver", args.data, lambda path: measure(args.program, path, args.pairs, args.rounds))
    write_section(
        args.output, "bench-eigsh", "## Eigenpairs",
        f"`make bench-eigsh` on {machine()}, one thread unless stated, SciPy {scipy.__version__}: the {args.pairs} smallest "
        f"eigenpairs of the Laplacian, the fastest of {args.rounds} rounds. Cells: seconds, processor seconds (for canonform with "
        "reading, repair and writing), largest residual.",
        solvers)


if __name__ == "__main__":
    main()
