#!/usr/bin/env python3
"""Compares search among up to a million signatures with faiss and hnswlib: building, adding, opening, answering, memory.

Queries are synthetic signatures that are not in the index. Each solver runs in its own process with the same threads. Rounds are
interleaved, so that other load affects all solvers alike. An addition is on disk when it ends: canonform commits it, peers write their
whole file. Files are in the cache of the system when they are opened; peers are timed without starting Python. hnswlib uses the
least `ef` that reaches the recall on these queries; the others compare all signatures.
"""
import os
import sys
import tempfile
import time

import numpy as np

from support import EXAMPLES, Asked, Peer, answer, benchmark, columns_table, machine, with_threads

VECTORS = os.path.join(EXAMPLES, "vectors")
K = 10
RECALL = 0.99
WARMING = 20
ADDED = 5
EFS = [10, 20, 30, 40, 60, 80, 120, 160, 240, 320, 480, 640, 1000, 1500]


def signatures(n, dim):
    """n points like those of shapes: families > classes of different sizes > poses on a curved manifold of six dimensions, with noise."""
    random = np.random.default_rng(7)
    families, classes, sheet = 50, max(50, n // 200), 6
    center = random.normal(size=(families, dim)).astype("f4")[random.integers(0, families, classes)]
    center += 0.6 * random.normal(size=(classes, dim)).astype("f4")
    basis = (random.normal(size=(classes, sheet, dim)) / np.sqrt(sheet)).astype("f4")
    share = random.pareto(1.5, classes) + 0.2
    of = np.sort(random.choice(classes, n, p=share / share.sum()))
    rows = np.empty((n, dim), "f4")
    for c, first, count in zip(*np.unique(of, return_index=True, return_counts=True)):
        pose = 0.3 * random.normal(size=(count, sheet))
        pose[:, 0] += 0.3 * pose[:, 1] ** 2
        noise = 0.05 * random.normal(size=(count, dim))
        rows[first:first + count] = center[c] + pose @ basis[c] + noise
    return rows[random.permutation(n)]


def resident(process):
    """Memory in MB."""
    with open(f"/proc/{process.pid}/status") as status:
        return int(next(line for line in status if line.startswith("VmRSS")).split()[1]) // 1000


class Library:
    """An index of a library in memory, and the queries."""

    def __init__(self, queries, threads):
        self.queries, self.threads = np.load(queries), threads

    def load(self, base):
        self.base = np.load(base)

    def build(self, path):
        self.make(self.base)
        self.write(path)

    def open(self, path):
        self.read(path)
        return self.ask(self.queries[0]).tolist()

    def room(self):
        """For the additions."""

    def add(self, i, path):
        """Adds a query, and writes the whole file to disk."""
        self.append(self.queries[i])
        self.write(path)
        with open(path, "rb") as file:
            os.fsync(file.fileno())

    def answers(self, first, count):
        seconds, found = [], []
        for query in self.queries[first:first + count]:
            start = time.perf_counter()
            ids = self.ask(query)
            seconds.append(time.perf_counter() - start)
            found.append(ids.ravel().tolist())
        return seconds, found


class Flat(Library):
    """faiss, which compares all vectors."""

    def __init__(self, *args):
        import faiss

        super().__init__(*args)
        self.faiss = faiss
        faiss.omp_set_num_threads(self.threads)

    def make(self, base):
        self.index = self.faiss.IndexFlatL2(base.shape[1])
        self.index.add(base)

    def append(self, row):
        self.index.add(row[None])

    def write(self, path):
        self.faiss.write_index(self.index, path)

    def read(self, path):
        self.index = self.faiss.read_index(path)

    def ask(self, query):
        return self.index.search(query[None], K)[1]


class Hnsw(Library):
    """hnswlib, whose index has room for the additions. One query takes one thread."""

    def make(self, base):
        import hnswlib

        self.index = hnswlib.Index("l2", base.shape[1])
        self.index.init_index(len(base) + ADDED, M=16, ef_construction=200)
        self.index.add_items(base, num_threads=self.threads)

    def append(self, row):
        self.index.add_items(row[None])

    def write(self, path):
        self.index.save_index(path)

    def read(self, path):
        import hnswlib

        self.index = hnswlib.Index("l2", self.queries.shape[1])
        self.index.load_index(path, max_elements=0)

    def room(self):
        self.index.resize_index(self.index.get_current_count() + ADDED)

    def choose(self, ef):
        self.index.set_ef(ef)

    def ask(self, query):
        return self.index.knn_query(query[None], K)[0]


class Theirs:
    """A library in a process of its own."""

    def __init__(self, kind, path, queries, threads):
        self.start = lambda: Peer(kind, queries, threads, patience=3600)
        self.path = path

    def seconds(self, *calls):
        """Of the calls of methods in a fresh process."""
        peer = self.start()
        seconds = [peer.call(*call)[1] for call in calls]
        peer.end()
        return seconds

    def build(self, base):
        return self.seconds(("load", base), ("build", self.path))[1]

    def first(self):
        """Seconds from opening to the first answer."""
        return self.seconds(("open", self.path))[0]

    def added(self):
        """Seconds of each addition."""
        return self.seconds(("open", self.path), ("room",), *(("add", i, self.path) for i in range(ADDED)))[2:]

    def serve(self):
        self.peer = self.start()
        self.peer.call("read", self.path)
        self.process = self.peer.process

    def tune(self, truth):
        """Chooses the least setting that reaches the recall."""
        for self.setting in EFS:
            self.peer.call("choose", self.setting)
            if recall(self.ask(0, len(truth))[1], truth) >= RECALL:
                break

    def ask(self, first, count):
        return self.peer.call("answers", first, count)[0]

    def end(self):
        self.peer.end()


class Ours:
    """The example `vectors`, which compares all signatures."""

    def __init__(self, index, queries, threads):
        self.index, self.queries, self.threads = index, queries, threads

    def build(self, base):
        seconds = answer([VECTORS, "build", base, self.index], env=with_threads(self.threads))
        return seconds["stored"] + seconds["finished"]

    def first(self):
        """Seconds from the start of the program to its first answer."""
        start = time.perf_counter()
        self.serve()
        self.ask(0, 1)
        seconds = time.perf_counter() - start
        self.end()
        return seconds

    def added(self):
        return answer([VECTORS, "add", self.queries, self.index, str(ADDED)], env=with_threads(self.threads))["seconds"]

    def serve(self):
        self.program = Asked([VECTORS, "serve", self.index, self.queries], self.threads)
        self.process = self.program.process
        self.program.read()

    def ask(self, first, count):
        answered = self.program.ask(K, first, count)
        return answered["seconds"], answered["found"]

    def end(self):
        self.program.end()


def recall(found, truth):
    return np.mean([len(set(a) & set(b)) / K for a, b in zip(found, truth)])


def measure(folder, n, args):
    rows = signatures(n + args.queries, args.dim)
    at = lambda name: os.path.join(folder, name)
    base, queries = at("base.npy"), at("queries.npy")
    np.save(base, rows[:n])
    np.save(queries, rows[n:])
    del rows
    ours = Ours(at("index"), queries, args.threads)
    flat, hnsw = (Theirs(kind, at(kind.__name__), queries, args.threads) for kind in (Flat, Hnsw))
    solvers = {"canonform": ours, "faiss IndexFlatL2": flat, "hnswlib": hnsw}
    build = {name: solver.build(base) for name, solver in solvers.items()}
    print("built", build, flush=True)
    opened, seconds, found = ({name: [] for name in solvers} for _ in range(3))
    for _ in range(args.rounds):
        for name, solver in solvers.items():
            opened[name].append(solver.first())
    for solver in solvers.values():
        solver.serve()
    truth = flat.ask(0, args.queries)[1]
    hnsw.tune(truth)
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
    memory = {name: resident(solver.process) for name, solver in solvers.items()}
    cells = {}
    for name, solver in solvers.items():
        solver.end()
        p50, p99 = 1e3 * np.percentile(seconds[name], [50, 99])
        note = f" (recall {hit[name]:.3f}, ef {solver.setting})" if solver is hnsw else ""
        cells[name] = (f"{build[name]:.2f}, {1e3 * np.median(solver.added()):.1f}, {1e3 * np.median(opened[name]):.1f}, "
                       f"{p50:.3f}, {p99:.3f}, {memory[name]}{note}")
    return cells


def section(args):
    columns, n = {}, 10_000
    while n <= args.most:
        with tempfile.TemporaryDirectory(dir=EXAMPLES) as folder:
            columns[f"{n:,}"] = measure(folder, n, args)
        print(n, columns[f"{n:,}"], flush=True)
        n *= 10
    yield "## Search among many signatures"
    yield (f"`make bench-search` on {machine()}, {args.threads} threads: synthetic signatures of {args.dim} numbers, "
           f"{args.queries:,} other queries, one at a time. Cells: seconds to build, milliseconds to add one, to open and give the "
           "first answer, and of a further answer (median, 99th percentile), memory in MB.")
    yield columns_table("solver", columns)


if __name__ == "__main__":
    benchmark(__doc__, section, rounds=5, dim=128, queries=1000, threads=os.cpu_count(), most=1_000_000)
