#!/usr/bin/env python3
"""Compares search among a million signatures with hnswlib and faiss: recall, latency, build time, memory.

    make bench-search           builds the program, sets up the environment, writes its section of docs/benchmarks.md

Synthetic signatures imitate those of shapes: families, classes of different sizes within them, and poses of a class on
a curved manifold of few dimensions, with noise. Queries are such signatures that are not in the index. Each solver
runs in its own process and answers one query at a time on one thread (exact scans use all threads). Rounds are
interleaved, so that other load on the machine affects all solvers alike. Peers use the cheapest setting that reaches
the recall on these queries; canonform measures all signatures.
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
WARMING = 500
ADDED = 20
NOTES = "canonform: ms to open, to load, to store the shapes"
ADDITION = "canonform, one shape added: ms, kB appended"


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


def make_hnswlib(base, threads):
    import hnswlib

    index = hnswlib.Index("l2", base.shape[1])
    index.init_index(len(base), M=16, ef_construction=200)
    index.add_items(base, num_threads=threads)
    index.set_num_threads(1)
    settings = [10, 20, 30, 40, 60, 80, 120, 160, 240, 320, 480, 640, 1000, 1500]
    return lambda q: index.knn_query(q[None], K)[0], index.set_ef, settings


def make_ivf(base, threads):
    import faiss

    faiss.omp_set_num_threads(threads)
    cells = 2 * int(np.sqrt(len(base)))
    index = faiss.IndexIVFFlat(faiss.IndexFlatL2(base.shape[1]), base.shape[1], cells)
    index.train(base[np.linspace(0, len(base) - 1, 48 * cells).astype(int)])
    index.add(base)
    faiss.omp_set_num_threads(1)

    def set_probes(n):
        index.nprobe = n

    return lambda q: index.search(q[None], K)[1], set_probes, [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128]


def make_flat(base, threads):
    import faiss

    index = faiss.IndexFlatL2(base.shape[1])
    index.add(base)
    faiss.omp_set_num_threads(threads)
    return lambda q: index.search(q[None], K)[1], lambda n: None, [0]


def serve(pipe, make, base_path, queries_path, threads):
    base = np.load(base_path)
    start = time.perf_counter()
    ask, choose, settings = make(base, threads)
    pipe.send(time.perf_counter() - start)
    del base
    gc.collect()
    queries = np.load(queries_path)
    truth = pipe.recv()
    for setting in settings:
        choose(setting)
        found = timed(ask, queries[:len(truth)])[1] if len(settings) > 1 else truth
        if recall(found, truth) >= RECALL:
            break
    pipe.send(setting)
    try:
        while True:
            first, count = pipe.recv()
            pipe.send(timed(ask, queries[first:first + count]))
    except EOFError:
        pass


class Peer:
    def __init__(self, make, *args):
        # A fresh interpreter, so that its memory contains nothing else.
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=serve, args=(theirs, make, *args), daemon=True)
        self.process.start()
        self.build = self.pipe.recv()

    def tune(self, truth):
        self.pipe.send(truth)
        self.setting = self.pipe.recv()

    def ask(self, first, count):
        self.pipe.send((first, count))
        return self.pipe.recv()

    def memory(self):
        return resident(self.process.pid)

    def end(self):
        self.process.terminate()
        self.process.join()


class Ours:
    """`vectors serve`, which measures all signatures."""

    def __init__(self, program, index, queries):
        self.process = subprocess.Popen([program, "serve", index, queries], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        self.ready = json.loads(self.process.stdout.readline())

    def ask(self, source, first, count):
        self.process.stdin.write(f"{source} {K} {first} {count}\n")
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


def measure(program, folder, n, dim, width, n_queries, rounds):
    threads = os.cpu_count()
    rows = signatures(n + n_queries, dim, 7, width)
    base_path, queries_path, index = (os.path.join(folder, name) for name in ("base.npy", "queries.npy", "index"))
    np.save(base_path, rows[:n])
    np.save(queries_path, rows[n:])
    del rows
    built = answer([program, "build", base_path, index])
    print("canonform built", built, flush=True)
    size = os.path.getsize(index) / 1e6
    peers = {}
    for name, make in [("faiss IndexFlatL2 (exact, all threads)", make_flat), ("faiss IndexIVFFlat", make_ivf),
                       ("hnswlib (M 16, ef_construction 200)", make_hnswlib)]:
        peers[name] = Peer(make, base_path, queries_path, threads)
        print(name, "built in %.1f s" % peers[name].build, flush=True)
    ours = Ours(program, index, queries_path)
    exact = peers["faiss IndexFlatL2 (exact, all threads)"]
    exact.tune([[0] * K])
    truth = exact.ask(0, n_queries)[1]
    for peer in peers.values():
        if peer is not exact:
            peer.tune(truth)
    solvers = {
        "canonform, exact scan (all threads)": lambda *span: ours.ask("scan", *span),
        **{name: peer.ask for name, peer in peers.items()},
    }
    seconds, found = {name: [] for name in solvers}, {name: [] for name in solvers}
    spans = np.array_split(np.arange(WARMING, n_queries), rounds)
    for span in spans:
        for name, ask in solvers.items():
            # Exact scans are slow and vary little, so fewer suffice.
            count = len(span) // 8 if "exact" in name else len(span)
            spent, ids = ask(int(span[0]), count)
            seconds[name] += spent
            found[name] += [(int(span[0]) + i, row) for i, row in enumerate(ids)]
    cells = {}
    for name in solvers:
        hit = recall([row for _, row in found[name]], [truth[i] for i, _ in found[name]])
        p50, p99 = 1e3 * np.percentile(seconds[name], [50, 99])
        if name in peers:
            peer = peers[name]
            setting = "" if peer is exact else f" ({'ef' if 'hnsw' in name else 'nprobe'} {peer.setting})"
            build, memory = f"{peer.build:.1f}", f"{peer.memory()}{setting}"
        else:
            memory = f"{ours.memory()}, file of {size:.0f}"
            build = f"{built['finished']:.1f}"
        cells[name] = f"{hit:.4f}, {p50:.3f}, {p99:.3f}, {build}, {memory}"
    cells[NOTES] = f"{1e3 * ours.ready['opened']:.1f}, {1e3 * ours.ready['loaded']:.0f}, {1e3 * built['stored']:.0f}"
    for process in [ours, *peers.values()]:
        process.end()
    added = answer([program, "add", queries_path, index, str(ADDED)])
    cells[ADDITION] = f"{1e3 * np.median(added['seconds']):.0f}, {np.median(added['bytes']) / 1e3:,.0f}"
    return cells


def main():
    parser = arguments(__doc__, "target/release/examples/vectors", rounds=5, n=1_000_000, dim=128, queries=2500)
    parser.add_argument("--widths", type=float, nargs="+", default=[0.3, 1.0])
    args = parser.parse_args()
    if not os.path.exists(args.program):
        sys.exit(f"{args.program} is missing: run `make bench-search`")
    columns = {}
    for width in args.widths:
        kind = "separate" if width < 0.6 else "overlapping"
        with tempfile.TemporaryDirectory(dir=os.path.dirname(args.program)) as folder:
            cells = measure(args.program, folder, args.n, args.dim, width, args.queries, args.rounds)
        columns[f"{kind} classes (poses {width}, classes 0.6)"] = cells
        print(kind, cells, flush=True)
    write_section(
        args.output, "bench-search", "## Search among many signatures",
        f"`make bench-search` on {machine()}: {args.n:,} synthetic signatures of {args.dim} numbers, {args.queries - WARMING:,} "
        f"other queries, one at a time. Peers use the cheapest setting that reaches a recall of {RECALL}. Cells: recall of the ten "
        "nearest, median and 99th percentile in milliseconds, seconds to build, memory in MB.",
        columns_table("solver", columns))


if __name__ == "__main__":
    main()
