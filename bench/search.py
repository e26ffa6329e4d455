#!/usr/bin/env python3
"""Compares search among a million signatures with hnswlib and faiss: recall, latency, build time, memory.

    make bench-search           builds the program, sets up the environment, writes docs/search.md

Synthetic signatures imitate those of shapes: families, classes of different sizes within them, and poses of a class on
a curved manifold of few dimensions, with noise. Queries are such signatures that are not in the index. Each solver
runs in its own process and answers one query at a time on one thread (exact scans use all threads). Rounds are
interleaved, so that other load on the machine affects all solvers alike. Peers use the cheapest setting that reaches
the recall on these queries; canonform calibrates its own while building, on signatures of the index.
"""
import gc
import json
import multiprocessing
import os
import platform
import subprocess
import sys
import tempfile
import time

import numpy as np

from support import answer, arguments, write_page

K = 10
RECALL = 0.99
WARMING = 500
ADDED = 20


def signatures(n, dim, seed, width):
    """n points: families > classes of different sizes > poses on a manifold of six dimensions."""
    random = np.random.default_rng(seed)
    families, classes, sheet = 50, max(50, n // 200), 6
    centre = random.normal(size=(families, dim)).astype("f4")[random.integers(0, families, classes)]
    centre += 0.6 * random.normal(size=(classes, dim)).astype("f4")
    basis = (random.normal(size=(classes, sheet, dim)) / np.sqrt(sheet)).astype("f4")
    share = random.pareto(1.5, classes) + 0.2
    of = np.sort(random.choice(classes, n, p=share / share.sum()))
    rows = np.empty((n, dim), "f4")
    for c, first, count in zip(*np.unique(of, return_index=True, return_counts=True)):
        pose = width * random.normal(size=(count, sheet))
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
    """`vectors serve`, which searches in memory, in the file, or by an exact scan."""

    def __init__(self, program, index, queries):
        self.process = subprocess.Popen([program, "serve", index, queries], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        self.ready = json.loads(self.process.stdout.readline())

    def ask(self, source, first, count):
        self.process.stdin.write(f"{source} {K} {first} {count}\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        self.measured = answer["measured"]
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
        "canonform, in memory": lambda *span: ours.ask("memory", *span),
        "canonform, from the file": lambda *span: ours.ask("file", *span),
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
    ours.ask("memory", WARMING, 200)
    measured = ours.measured
    lines = ["| | recall@10 | p50 ms | p99 ms | build s | memory MB |", "|---|---|---|---|---|---|"]
    for name in solvers:
        hit = recall([row for _, row in found[name]], [truth[i] for i, _ in found[name]])
        p50, p99 = 1e3 * np.percentile(seconds[name], [50, 99])
        if name in peers:
            peer = peers[name]
            label = name if peer is exact else f"{name}, {'ef' if 'hnsw' in name else 'nprobe'} {peer.setting}"
            build, memory = f"{peer.build:.1f}", peer.memory()
        else:
            label, memory = name, ours.memory()
            build = f"{built['finished']:.1f} (+ {built['stored']:.1f} to store the shapes)"
            if "file" in name:
                build, memory = "", f"(file of {size:.0f})"
        lines.append(f"| {label} | {hit:.4f} | {p50:.3f} | {p99:.3f} | {build} | {memory} |")
    note = (f"\ncanonform calibrates a recall of {ours.ready['recall']:.4f} while building and measures {measured:,.0f} signatures per "
            f"query. Opening the file takes {1e3 * ours.ready['opened']:.1f} ms, reading it into memory "
            f"{ours.ready['loaded']:.2f} s; building takes {built['megabytes']} MB.")
    for process in [ours, *peers.values()]:
        process.end()
    added = answer([program, "add", queries_path, index, str(ADDED)])
    note += (f" Adding one shape takes {np.median(added['seconds']):.2f} s and appends {np.median(added['bytes']) / 1e3:,.0f} kB "
             f"(medians of {ADDED}).")
    return "\n".join(lines) + "\n" + note


def main():
    parser = arguments(__doc__, "target/release/examples/vectors", "docs/search.md", rounds=5, n=1_000_000, dim=128,
                       queries=2500)
    parser.add_argument("--widths", type=float, nargs="+", default=[0.3, 1.0])
    args = parser.parse_args()
    if not os.path.exists(args.program):
        sys.exit(f"{args.program} is missing: run `make bench-search`")
    page = [
        "# Search among many signatures, compared with hnswlib and faiss",
        f"\nMeasured by `make bench-search` on {platform.machine()}, {os.cpu_count()} cores: {args.n:,} synthetic signatures of "
        f"{args.dim} numbers in families, classes and poses, {args.queries - WARMING:,} queries that are not among them, one at a time, "
        "all solvers interleaved in one run. Peers use the cheapest setting that reaches a recall of "
        f"{RECALL}. Compare ratios; absolute times depend on the machine.\n",
    ]
    for width in args.widths:
        kind = "separate classes" if width < 0.6 else "overlapping classes"
        with tempfile.TemporaryDirectory(dir=os.path.dirname(args.program)) as folder:
            table = measure(args.program, folder, args.n, args.dim, width, args.queries, args.rounds)
        page.append(f"## {kind.capitalize()} (poses vary by {width} where classes differ by 0.6)\n\n{table}\n")
        print(page[-1], flush=True)
    write_page(args.output, page)


if __name__ == "__main__":
    main()
