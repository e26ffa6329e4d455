#!/usr/bin/env python3
"""Compares search among up to a million signatures with faiss and hnswlib: building, adding, opening, answering, memory.

    make bench-search           builds the program, sets up the environment, writes its section of docs/benchmarks.md

Synthetic signatures imitate those of shapes: families, classes of different sizes within them, and poses of a class on
a curved manifold of few dimensions, with noise. Queries are such signatures that are not in the index. Each solver
runs in its own process with the same threads and answers one query at a time. Rounds are interleaved, so that other
load on the machine affects all solvers alike. An addition is on disk when it ends: canonform commits it, peers write
their whole file. Files are in the cache of the system when they are opened; peers are timed without starting Python. hnswlib
uses the least `ef` that reaches the recall on these queries; the others compare all signatures.
"""
import gc
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

from support import answer, arguments, columns_table, machine, write_section

K = 10
RECALL = 0.99
SIZES = [10_000, 100_000, 1_000_000]
WIDTH = 0.3
WARMING = 20
ADDED = 5
EFS = [10, 20, 30, 40, 60, 80, 120, 160, 240, 320, 480, 640, 1000, 1500]


def class_manifolds(random, n, dim):
    """Classes of n points, in families: their centres, bases of a manifold of six dimensions, and shares of the points."""
    families, classes, sheet = 50, max(50, n // 200), 6
    centre = random.normal(size=(families, dim)).astype("f4")[random.integers(0, families, classes)]
    centre += 0.6 * random.normal(size=(classes, dim)).astype("f4")
    basis = (random.normal(size=(classes, sheet, dim)) / np.sqrt(sheet)).astype("f4")
    share = random.pareto(1.5, classes) + 0.2
    return centre, basis, share / share.sum()


def signatures(n, dim, seed, width):
    """n points: families > classes of different sizes > poses on a manifold of six dimensions."""
    random = np.random.default_rng(seed)
    centre, basis, share = class_manifolds(random, n, dim)
    of = np.sort(random.choice(len(share), n, p=share))
    rows = np.empty((n, dim), "f4")
    for c, first, count in zip(*np.unique(of, return_index=True, return_counts=True)):
        pose = width * random.normal(size=(count, basis.shape[1]))
        pose[:, 0] += 0.3 * pose[:, 1] ** 2
        noise = 0.05 * random.normal(size=(count, dim))
        rows[first:first + count] = centre[c] + pose @ basis[c] + noise
    return rows[random.permutation(n)]


def resident(pid):
    with open(f"/proc/{pid}/status") as status:
        return int(next(line for line in status if line.startswith("VmRSS")).split()[1]) // 1000


def timed(ask, queries):
    seconds, found = [], []
    for query in queries:
        start = time.perf_counter()
        ids = ask(query)
        seconds.append(time.perf_counter() - start)
        found.append(np.asarray(ids).ravel().tolist())
    return seconds, found


class Flat:
    """faiss, which compares all vectors."""

    def __init__(self, threads):
        import faiss

        self.faiss, self.index, self.settings = faiss, None, [0]
        faiss.omp_set_num_threads(threads)

    def build(self, base):
        self.index = self.faiss.IndexFlatL2(base.shape[1])
        self.index.add(base)

    def add(self, row):
        self.index.add(row[None])

    def write(self, path):
        self.faiss.write_index(self.index, path)

    def read(self, path, dim):
        self.index = self.faiss.read_index(path)

    def choose(self, setting):
        pass

    def ask(self, query):
        return self.index.search(query[None], K)[1]


class Hnsw:
    """hnswlib, whose index has room for the additions. One query takes one thread."""

    def __init__(self, threads):
        import hnswlib

        self.hnswlib, self.index, self.settings, self.threads = hnswlib, None, EFS, threads

    def build(self, base):
        self.index = self.hnswlib.Index("l2", base.shape[1])
        self.index.init_index(len(base) + ADDED, M=16, ef_construction=200)
        self.index.add_items(base, num_threads=self.threads)

    def add(self, row):
        self.index.add_items(row[None])

    def write(self, path):
        self.index.save_index(path)

    def read(self, path, dim):
        self.index = self.hnswlib.Index("l2", dim)
        self.index.load_index(path)

    def choose(self, setting):
        self.index.set_ef(setting)

    def ask(self, query):
        return self.index.knn_query(query[None], K)[0]


def make(pipe, kind, base_path, path, threads):
    """Builds an index of a peer and writes it. Sends the seconds."""
    base, solver = np.load(base_path), kind(threads)
    start = time.perf_counter()
    solver.build(base)
    solver.write(path)
    pipe.send(time.perf_counter() - start)


def open_first(pipe, kind, path, queries_path, threads):
    """Sends the seconds from opening an index of a peer to its first answer."""
    queries, solver = np.load(queries_path), kind(threads)
    start = time.perf_counter()
    solver.read(path, queries.shape[1])
    solver.ask(queries[0])
    pipe.send(time.perf_counter() - start)


def add(pipe, kind, path, queries_path, threads):
    """Sends the seconds of each addition to an index of a peer."""
    queries, solver = np.load(queries_path), kind(threads)
    solver.read(path, queries.shape[1])
    if kind is Hnsw:
        solver.index.resize_index(solver.index.get_current_count() + ADDED)
    seconds = []
    for row in queries[:ADDED]:
        start = time.perf_counter()
        solver.add(row)
        solver.write(path)
        with open(path, "rb") as file:
            os.fsync(file.fileno())
        seconds.append(time.perf_counter() - start)
    pipe.send(seconds)


def serve(pipe, kind, path, queries_path, threads):
    """Answers spans of queries, with the least setting that reaches the recall."""
    queries, solver = np.load(queries_path), kind(threads)
    solver.read(path, queries.shape[1])
    gc.collect()
    pipe.send(None)
    truth = pipe.recv()
    for setting in solver.settings:
        solver.choose(setting)
        if len(solver.settings) == 1 or recall(timed(solver.ask, queries)[1], truth) >= RECALL:
            break
    pipe.send(setting)
    try:
        while True:
            first, count = pipe.recv()
            pipe.send(timed(solver.ask, queries[first:first + count]))
    except EOFError:
        pass


class Process:
    """A function in a fresh interpreter, so that its memory contains nothing else, and the first that it sends."""

    def __init__(self, function, *args):
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=function, args=(theirs, *args), daemon=True)
        self.process.start()
        theirs.close()
        self.first = self.pipe.recv()

    def tune(self, truth):
        self.pipe.send(truth)
        self.setting = self.pipe.recv()

    def ask(self, first, count):
        self.pipe.send((first, count))
        return self.pipe.recv()

    def memory(self):
        return resident(self.process.pid)

    def end(self):
        self.pipe.close()
        self.process.join()


def result(function, *args):
    """What a function sends from a fresh interpreter."""
    process = Process(function, *args)
    process.end()
    return process.first


class Ours:
    """`vectors serve`, which compares all signatures."""

    def __init__(self, program, index, queries, threads=None):
        environment = os.environ | ({} if threads is None else {"RAYON_NUM_THREADS": str(threads)})
        self.process = subprocess.Popen([program, "serve", index, queries], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True, env=environment)
        self.ready = json.loads(self.process.stdout.readline())

    def ask(self, first, count):
        self.process.stdin.write(f"{K} {first} {count}\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        return answer["seconds"], answer["found"]

    def memory(self):
        return resident(self.process.pid)

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def recall(found, truth):
    return np.mean([len(set(a) & set(b)) / K for a, b in zip(found, truth)])


def started(program, index, queries, threads):
    """Seconds from the start of our program to its first answer."""
    start = time.perf_counter()
    process = Ours(program, index, queries, threads)
    process.ask(0, 1)
    seconds = time.perf_counter() - start
    process.end()
    return seconds


def measure(program, folder, n, args):
    rows = signatures(n + args.queries, args.dim, 7, WIDTH)
    base, queries, index = (os.path.join(folder, name) for name in ("base.npy", "queries.npy", "index"))
    np.save(base, rows[:n])
    np.save(queries, rows[n:])
    del rows
    environment = os.environ | {"RAYON_NUM_THREADS": str(args.threads)}
    built = answer([program, "build", base, index], env=environment)
    print("canonform built", built, flush=True)
    kinds = {"faiss IndexFlatL2": Flat, "hnswlib": Hnsw}
    paths = {name: os.path.join(folder, name.split()[0]) for name in kinds}
    build = {name: result(make, kind, base, paths[name], args.threads) for name, kind in kinds.items()}
    build["canonform"] = built["stored"] + built["finished"]
    print("built", build, flush=True)

    opened = {name: [] for name in build}
    for _ in range(args.rounds):
        opened["canonform"].append(started(program, index, queries, args.threads))
        for name, kind in kinds.items():
            opened[name].append(result(open_first, kind, paths[name], queries, args.threads))

    solvers = {"canonform": Ours(program, index, queries, args.threads)}
    solvers |= {name: Process(serve, kind, paths[name], queries, args.threads) for name, kind in kinds.items()}
    exact = solvers["faiss IndexFlatL2"]
    exact.tune([])
    truth = exact.ask(0, args.queries)[1]
    solvers["hnswlib"].tune(truth)
    seconds, found = {name: [] for name in solvers}, {name: [] for name in solvers}
    for solver in solvers.values():
        solver.ask(0, WARMING)
    for span in np.array_split(np.arange(args.queries), args.rounds):
        for name, solver in solvers.items():
            spent, ids = solver.ask(int(span[0]), len(span))
            seconds[name] += spent
            found[name] += ids
    hit = {name: recall(found[name], truth) for name in solvers}
    # Distances are rounded, so that shapes at the same distance may change places.
    if hit["canonform"] < 0.999:
        sys.exit(f"canonform finds {hit['canonform']:.4f} of what faiss finds")
    memory = {name: solver.memory() for name, solver in solvers.items()}
    notes = {name: "" for name in solvers} | {"hnswlib": f" (recall {hit['hnswlib']:.3f}, ef {solvers['hnswlib'].setting})"}
    for solver in solvers.values():
        solver.end()

    added = {"canonform": answer([program, "add", queries, index, str(ADDED)], env=environment)["seconds"]}
    added |= {name: result(add, kind, paths[name], queries, args.threads) for name, kind in kinds.items()}
    cells = {}
    for name in solvers:
        p50, p99 = 1e3 * np.percentile(seconds[name], [50, 99])
        cells[name] = (f"{build[name]:.2f}, {1e3 * np.median(added[name]):.1f}, {1e3 * np.median(opened[name]):.1f}, "
                       f"{p50:.3f}, {p99:.3f}, {memory[name]}{notes[name]}")
    return cells


def main():
    parser = arguments(__doc__, "target/release/examples/vectors", rounds=5, dim=128, queries=1000, threads=os.cpu_count())
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES)
    args = parser.parse_args()
    if not os.path.exists(args.program):
        sys.exit(f"{args.program} is missing: run `make bench-search`")
    columns = {}
    for n in args.sizes:
        with tempfile.TemporaryDirectory(dir=os.path.dirname(args.program)) as folder:
            columns[f"{n:,}"] = measure(args.program, folder, n, args)
        print(n, columns[f"{n:,}"], flush=True)
    write_section(
        args.output, "bench-search", "## Search among many signatures",
        f"`make bench-search` on {machine()}, {args.threads} threads: synthetic signatures of {args.dim} numbers, {args.queries:,} other "
        "queries, one at a time. Cells: seconds to build, milliseconds to add one, to open and give the first answer, and of a "
        "further answer (median, 99th percentile), memory in MB.",
        columns_table("solver", columns))


if __name__ == "__main__":
    main()
