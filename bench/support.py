"""Shared by the benchmarks: options, meshes, programs and packages in processes of their own, tables, sections of the page.

`make bench-NAME` builds what `NAME.py` needs, runs it, and so writes its section of docs/benchmarks.md.
"""
import argparse
import collections
import json
import multiprocessing
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time

import numpy as np

CANONFORM = os.environ.get("CANONFORM", "target/release/canonform")
EXAMPLES = os.path.join(os.path.dirname(CANONFORM), "examples")
DATA = os.environ.get("CANONFORM_DATA", "../shared/data")
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def benchmark(doc, section, **options):
    """Writes the section of the running file from the parts that `section` yields, with options given by their defaults."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--output", default="docs/benchmarks.md", help="the page whose section is written")
    for name, default in options.items():
        parser.add_argument(f"--{name}", type=type(default), default=default)
    args = parser.parse_args()
    name = "bench-" + os.path.basename(sys.argv[0]).removesuffix(".py")
    parts = [part.strip() for part in section(args)]
    with open(args.output) as file:
        page = file.read()
    begin, end = f"<!-- {name} begins -->\n", f"<!-- {name} ends -->\n"
    # A section that is not there yet comes last.
    before, _, rest = page.partition(begin)
    after = rest.partition(end)[2]
    with open(args.output + ".part", "w") as file:
        file.write(before + begin + "\n\n".join(parts) + "\n" + end + after)
    os.replace(args.output + ".part", args.output)


def machine():
    return f"{platform.machine()}, {os.cpu_count()} cores"


def table(head, rows):
    return "\n".join([f"|{'|'.join(head)}|", "|" + "---|" * len(head), *(f"|{'|'.join(row)}|" for row in rows)])


def columns_table(corner, columns):
    """A table of columns that map names of rows to cells, in the order of the last column."""
    names = list(dict.fromkeys(name for cells in reversed(columns.values()) for name in cells))
    return table([corner, *columns], [[name, *(cells.get(name, "-") for cells in columns.values())] for name in names])


def mesh_table(corner, meshes, measure):
    """A table of meshes by title, a column each. `measure(path)` returns the number of vertices and the cells by name."""
    columns = {}
    for title, path in meshes.items():
        n_vertices, cells = measure(path)
        columns[f"{title}, {n_vertices:,}"] = cells
        print(title, cells, flush=True)
    return columns_table(corner, columns)


def test_meshes(data):
    """Title -> path of each test mesh."""
    meshes = {"cat0 of TOSCA": "tosca-lowres/cat0.vert", "cat0, full resolution": "tosca-hires/cat0.ply",
              "armadillo": "single/armadillo.obj"}
    paths = {title: os.path.join(data, path) for title, path in meshes.items()}
    for path in paths.values():
        if not os.path.exists(path):
            sys.exit(f"{path} is missing: set CANONFORM_DATA to the folder of tosca-lowres, tosca-hires and single")
    return paths


def read_mesh(path):
    """Vertices and triangles of a mesh in any format."""
    if not path.endswith(".off"):
        with tempfile.TemporaryDirectory() as folder:
            converted = os.path.join(folder, "mesh.off")
            run([CANONFORM, "convert", path, converted, "-q"])
            return read_mesh(converted)
    with open(path) as file:
        file.readline()
        n_vertices, n_faces, _ = map(int, file.readline().split())
        return np.loadtxt(file, max_rows=n_vertices), np.loadtxt(file, dtype=np.int64, max_rows=n_faces)[:, 1:]


def write_mesh(path, vertices, faces):
    """As OBJ or OFF, by the name."""
    vertex, face, first = ("v ", "f ", 1) if path.endswith(".obj") else ("", "3 ", 0)
    with open(path, "w") as file:
        if not first:
            file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        file.writelines(vertex + "%.17g %.17g %.17g\n" % tuple(v) for v in vertices)
        file.writelines(face + "%d %d %d\n" % tuple(f + first) for f in faces)


def subdivided(vertices, faces):
    """Splits every face into four at the middles of its edges, without changing the surface."""
    sides = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges, middle = np.unique(sides, axis=0, return_inverse=True)
    ab, bc, ca = len(vertices) + middle.reshape(3, -1)
    a, b, c = faces.T
    vertices = np.vstack([vertices, vertices[edges].mean(axis=1)])
    return vertices, np.vstack([np.stack(f, 1) for f in [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]])


Run = collections.namedtuple("Run", "processor elapsed memory output")


def run(command, accepted=(0,), **how):
    """Processor and elapsed seconds, peak memory in MB and the output of a program, which must succeed."""
    with tempfile.TemporaryFile("w+") as output:
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=output, **how)
        _, status, usage = os.wait4(process.pid, 0)
        elapsed = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in accepted:
            sys.exit(f"{' '.join(command)} ended with {process.returncode}")
        output.seek(0)
        return Run(usage.ru_utime + usage.ru_stime, elapsed, usage.ru_maxrss / 1000, output.read())


def answer(command, **how):
    """The JSON output of a program."""
    return json.loads(run(command, **how).output)


def generate(folder, family, *options):
    run([CANONFORM, "generate", "--family", family, *map(str, options), "-q", "--json", "-o", folder])


def distances(mesh, method, sources):
    """`canonform geodesic` on one thread: distances (one row per source), seconds per source, seconds of setup."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "distances.npy")
        seconds = answer([CANONFORM, "geodesic", mesh, "--method", method, "--threads", "1", "--json", "-o", out,
                          "--source", ",".join(map(str, sources))])["seconds"]
        return np.atleast_2d(np.load(out)), seconds["per_source"], seconds["setup"]


def with_threads(count):
    """The environment of a program of ours with so many threads."""
    return os.environ | {"RAYON_NUM_THREADS": str(count)}


class Asked:
    """A program that answers every line with a line of JSON."""

    def __init__(self, command, threads):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        env=with_threads(threads))

    def read(self):
        return json.loads(self.process.stdout.readline())

    def ask(self, *words):
        self.process.stdin.write(" ".join(map(str, words)) + "\n")
        self.process.stdin.flush()
        return self.read()

    def end(self):
        self.process.stdin.close()
        self.process.wait()


class Failed(Exception):
    """What a package did instead of answering."""


def serve(pipe, clock, make, args):
    """Makes an object and calls its methods. Sends results with their seconds, or the text of an error."""
    for stream in (1, 2):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
    try:
        # The first time includes the import of the package.
        make(*args)
        start = clock()
        made = make(*args)
        pipe.send(clock() - start)
        while True:
            method, given = pipe.recv()
            start = clock()
            result = getattr(made, method)(*given)
            seconds = clock() - start
            # What converts a result does not count.
            pipe.send((result() if callable(result) else result, seconds))
    except EOFError:
        pass
    except Exception as error:
        text = str(error).strip().splitlines()
        # Without the path of a source file.
        words = [word for word in (text[0] if text else "").split() if not word.startswith("/")]
        pipe.send(f"{type(error).__name__}: {' '.join(words)}")


class Peer:
    """What `make` returns, in a fresh interpreter, so that it may crash and its memory contains nothing else. Raises `Failed`."""

    def __init__(self, make, *args, clock=time.perf_counter, patience=120):
        self.patience = patience
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=serve, args=(theirs, clock, make, args), daemon=True)
        self.process.start()
        theirs.close()
        self.setup = self.receive()

    def receive(self):
        try:
            if not self.pipe.poll(self.patience):
                raise Failed(f"no answer in {self.patience} s")
            received = self.pipe.recv()
        except (EOFError, ConnectionResetError):
            self.process.join()
            code = self.process.exitcode
            raise Failed(f"crashes ({signal.Signals(-code).name if code < 0 else f'exit code {code}'})") from None
        if isinstance(received, str):
            raise Failed(received)
        return received

    def call(self, method, *args):
        """The result of a method and its seconds."""
        self.pipe.send((method, args))
        return self.receive()

    def end(self):
        self.process.kill()
        self.process.join()


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


SOLVERS = {"potpourri3d heat": potpourri3d_heat, "potpourri3d fast marching": potpourri3d_marching,
           "pygeodesic (exact)": pygeodesic}


def errors(rows, exact):
    """Mean and largest error in per cent of exact distances."""
    known = np.isfinite(exact) & (exact > 0)
    relative = 100 * np.abs(np.array(rows) - exact)[known] / exact[known]
    return f"{relative.mean():.3f}, {relative.max():.1f}"


def measure_solvers(path, rounds, methods, solvers, clock=time.perf_counter):
    """The number of vertices and, by solver: milliseconds per source and of setup, mean and largest error. Every round runs all
    solvers on one source, so that other load affects all of them alike. The fastest comes first."""
    vertices, faces = read_mesh(path)
    sources = [int(s) for s in np.random.default_rng(1).permutation(len(vertices))[:rounds]]
    exact = distances(path, "exact", sources)[0]
    runs, peers, failed = collections.defaultdict(list), {}, {}

    def attempt(name, do):
        try:
            return do()
        except Failed as fault:
            failed[name] = str(fault)

    for name, make in solvers.items():
        peers[name] = attempt(name, lambda: Peer(make, vertices, faces, clock=clock))
    for source in sources:
        for method in methods:
            # Repeats the source, because memory is warm from the second time on, as with the peers.
            row, seconds, setup = distances(path, method, [source] * 4)
            runs[f"canonform {method}"].append((np.median(seconds[1:]), setup, row[-1]))
        for name, peer in peers.items():
            if name not in failed and (answered := attempt(name, lambda: peer.call("__call__", source))):
                runs[name].append((answered[1], peer.setup, answered[0]))
    for name in peers.keys() - failed.keys():
        peers[name].end()
    cells = []
    for name in runs.keys() - failed.keys():
        seconds, setup, rows = zip(*runs[name])
        spent = 1e3 * np.median(seconds)
        cells.append((spent, name, f"{spent:.2f}, {1e3 * min(setup):.0f}, {errors(rows, exact)}"))
    return len(vertices), {name: cell for _, name, cell in sorted(cells)} | failed
