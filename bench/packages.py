#!/usr/bin/env python3
"""Sets canonform beside the Python packages that people use: distances, embeddings, and what each does with broken meshes.

    make bench-packages         builds the program, sets up the environment, writes its section of docs/benchmarks.md

Needs no data: shapes are generated. Distances are those of potpourri3d, pygeodesic and gdist, embeddings those of
scikit-learn. Rounds are interleaved, one source each, and the tables give medians. Every package runs in a process of
its own on one thread, because some crash. Packages are measured by processor time, so that other load does not count. For
the solvers of canonform it is elapsed time, the least of three runs of a source: load can only make them look slower.
"""
import multiprocessing
import os
import signal
import statistics
import subprocess
import tempfile
import time
from importlib.metadata import version

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np

from support import answer, arguments, columns_table, distances, machine, table, write_section

# Seconds after which a package is stopped.
PATIENCE = 120
OURS = ["fast-marching", "heat", "exact"]


def potpourri3d_heat(vertices, faces):
    import potpourri3d

    return potpourri3d.MeshHeatMethodDistanceSolver(vertices, faces).compute_distance


def potpourri3d_marching(vertices, faces):
    import potpourri3d

    solver = potpourri3d.MeshFastMarchingDistanceSolver(vertices, faces)
    return lambda source: solver.compute_distance([[(source, [])]])


def pygeodesic(vertices, faces):
    from pygeodesic import geodesic

    solver = geodesic.PyGeodesicAlgorithmExact(vertices, faces)
    return lambda source: solver.geodesicDistances(np.array([source]))[0]


def gdist(vertices, faces):
    import gdist

    faces = faces.astype(np.int32)
    return lambda source: gdist.compute_gdist(vertices, faces, np.array([source], dtype=np.int32))


SOLVERS = {"potpourri3d heat": potpourri3d_heat, "potpourri3d fast marching": potpourri3d_marching,
           "pygeodesic (exact)": pygeodesic, "gdist (exact)": gdist}


def classical(data):
    from sklearn.manifold import ClassicalMDS

    return ClassicalMDS(n_components=3, metric="precomputed").fit_transform(data)


def isomap(data):
    from sklearn.manifold import Isomap

    return Isomap(n_components=3, n_neighbors=8).fit_transform(data)


EMBEDDINGS = {"scikit-learn ClassicalMDS, all pairs": classical, "scikit-learn Isomap, 8 neighbours in space": isomap}


def serve(pipe, make, args):
    """Answers sources with a row and its seconds, or with an error."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    try:
        # The first time includes the import of the package.
        make(*args)
        start = time.process_time()
        solve = make(*args)
        pipe.send(time.process_time() - start)
        while True:
            source = pipe.recv()
            start = time.process_time()
            row = np.asarray(solve(source), float)
            pipe.send((row, time.process_time() - start))
    except EOFError:
        pass
    except Exception as error:
        text = str(error).strip().splitlines()
        # Without the path of a source file.
        words = [word for word in (text[0] if text else "").split() if not word.startswith("/")]
        pipe.send(f"{type(error).__name__}: {' '.join(words)}")


class Failed(Exception):
    pass


class Package:
    """A solver in a process of its own. Raises `Failed` with what it did instead."""

    def __init__(self, make, *args):
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=serve, args=(theirs, make, args), daemon=True)
        self.process.start()
        theirs.close()
        self.setup = self.receive()

    def receive(self):
        try:
            if not self.pipe.poll(PATIENCE):
                raise Failed(f"no answer in {PATIENCE} s")
            answer = self.pipe.recv()
        except (EOFError, ConnectionResetError):
            self.process.join()
            code = self.process.exitcode
            raise Failed(f"crashes ({signal.Signals(-code).name if code < 0 else f'exit code {code}'})") from None
        if isinstance(answer, str):
            raise Failed(answer)
        return answer

    def __call__(self, source):
        self.pipe.send(source)
        return self.receive()

    def end(self):
        self.process.kill()
        self.process.join()


def read_off(path):
    with open(path) as file:
        file.readline()
        n, m, _ = map(int, file.readline().split())
        rows = file.read().split("\n")
    vertices = np.array([row.split()[:3] for row in rows[:n]], float)
    faces = np.array([row.split()[1:4] for row in rows[n:n + m]], np.int64)
    return vertices, faces


def write_off(path, vertices, faces):
    with open(path, "w") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        file.writelines("%r %r %r\n" % tuple(map(float, v)) for v in vertices)
        file.writelines("3 %d %d %d\n" % tuple(f) for f in faces)


def measure_distances(program, path, rounds):
    vertices, faces = read_off(path)
    sources = [int(s) for s in np.random.default_rng(1).permutation(len(vertices))[:rounds]]
    exact = distances(program, path, "exact", sources)[0]
    packages, rows, refused = {}, {}, {}
    for name, make in SOLVERS.items():
        try:
            packages[name] = Package(make, vertices, faces)
        except Failed as fault:
            refused[name] = str(fault)
    for i, source in enumerate(sources):
        for method in OURS:
            row, seconds, setup = distances(program, path, method, [source] * 3)
            rows.setdefault(f"canonform {method}", []).append((min(seconds), setup, row[0], exact[i]))
        for name in list(packages):
            try:
                row, seconds = packages[name](source)
                rows.setdefault(name, []).append((seconds, packages[name].setup, row, exact[i]))
            except Failed as fault:
                refused[name] = str(fault)
                packages.pop(name)
    for package in packages.values():
        package.end()
    lines = []
    for name, runs in rows.items():
        seconds = statistics.median(run[0] for run in runs)
        setup = min(run[1] for run in runs)
        errors = np.concatenate([np.abs(row - truth)[truth > 0] / truth[truth > 0] for _, _, row, truth in runs])
        lines.append((seconds, name, f"{1e3 * seconds:.2f}, {1e3 * setup:.0f}, {100 * errors.mean():.3f}, "
                                     f"{100 * errors.max():.1f}"))
    return f"{len(vertices):,} vertices", {name: cells for _, name, cells in sorted(lines)} | refused


def processor_time(command):
    """Processor seconds of a program, from its start to its end."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{command} ended with {process.returncode}")
    return usage.ru_utime + usage.ru_stime


def normalized_stress(form, truth, sources):
    gap = np.linalg.norm(form[sources][:, None] - form[None], axis=2) - truth
    return np.sqrt((gap**2).sum() / (truth**2).sum())


def measure_embeddings(program, folder, path):
    """Time and stress of three-dimensional embeddings, against exact distances from some vertices."""
    vertices, _ = read_off(path)
    sources = [int(s) for s in np.random.default_rng(2).permutation(len(vertices))[:50]]
    truth = distances(program, path, "exact", sources)[0]
    rows, pairs, form = [], os.path.join(folder, "pairs.npy"), os.path.join(folder, "form.npy")
    for name, options in [("canonform nmds, n = 20", ["-n", "20"]), ("canonform nmds, n = 100", ["-n", "100"]),
                          ("canonform mds, all pairs", ["--method", "mds"]), ("canonform smacof", ["--method", "smacof"])]:
        seconds = processor_time([program, "embed", path, *options, "--threads", "1", "--stress", "skip", "-o", form])
        rows.append((name, seconds, f"{normalized_stress(np.load(form), truth, sources):.4f}"))
    made = processor_time([program, "geodesic", path, "--all-pairs", "--threads", "1", "-o", pairs])
    for name, make in EMBEDDINGS.items():
        of_pairs = make is classical
        data = np.load(pairs) if of_pairs else vertices
        try:
            package = Package(embedder, make, data)
            result, seconds = package(0)
            package.end()
            seconds += made if of_pairs else 0
            rows.append((name, seconds, f"{normalized_stress(result, truth, sources):.4f}"))
        except Failed as fault:
            rows.append((name, None, str(fault)))
    lines = [(name, "-" if s is None else f"{s:.2f}", stress) for name, s, stress in rows]
    return table(["embedding", "seconds", "normalised stress"], lines)


def embedder(make, data):
    return lambda _: make(data)


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


def measure_refusals(program, folder, path):
    vertices, faces = read_off(path)
    source = int(np.argmax(vertices[:, 2]))
    truth = distances(program, path, "exact", [source])[0][0]
    names = ["canonform exact", *SOLVERS]
    lines = []
    for defect, (v, f) in broken(vertices, faces).items():
        cells = []
        changed = os.path.join(folder, "broken.off")
        write_off(changed, v, f)
        out = os.path.join(folder, "row.npy")
        run = subprocess.run([program, "geodesic", changed, "--source", str(source), "--method", "exact", "-o", out],
                             capture_output=True, text=True)
        if run.returncode == 2:
            cells.append("error with the line")
            assert ", line " in run.stderr, run.stderr
        else:
            cells.append(judged(np.load(out)[0], truth) + (", with a note" if run.stderr.strip() else ""))
        for make in SOLVERS.values():
            try:
                package = Package(make, v, f)
                row, _ = package(source)
                package.end()
                cells.append(judged(row, truth))
            except Failed as fault:
                cells.append(str(fault).split(":")[0])
        print(defect, cells, flush=True)
        if set(cells) != {"right"}:
            lines.append((defect, *cells))
    return table(["defect", *names], lines)


def main():
    options = arguments(__doc__, "target/release/canonform", 7, vertices=3400, fine=28_000)
    args = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        paths = {}
        for n in (args.vertices, args.fine):
            shapes = os.path.join(folder, str(n))
            answer([args.program, "generate", "--family", "cat", "--poses", "1", "--vertices", str(n), "-o", shapes, "--json"])
            paths[n] = os.path.join(shapes, "cat0.off")
        packages = ", ".join(f"{name} {version(name)}" for name in ("potpourri3d", "pygeodesic", "gdist", "scikit-learn"))
        solvers = columns_table("solver", dict(measure_distances(args.program, path, args.rounds) for path in paths.values()))
        embeddings = measure_embeddings(args.program, folder, paths[args.vertices])
        refusals = measure_refusals(args.program, folder, paths[args.vertices])
    write_section(
        args.output, "bench-packages", "## Beside Python packages",
        f"`make bench-packages` on {machine()}, one thread each, on a built-in cat, medians over {args.rounds} sources; processor "
        f"time, but elapsed time for the solvers of canonform. {packages}. Cells: milliseconds per source, milliseconds of setup, "
        "mean and largest error in per cent of exact distances.",
        solvers,
        f"*Embeddings* of {args.vertices:,} vertices: the whole program for canonform, the call for scikit-learn. The time of "
        "ClassicalMDS includes the matrix of distances, which canonform measured. Stress is relative to exact distances from 50 "
        "vertices.",
        embeddings,
        "*One defect in the mesh*: distances from one vertex, *right* if their mean error is below 10 %. Defects that all measure right are "
        "left out.",
        refusals)


if __name__ == "__main__":
    main()
