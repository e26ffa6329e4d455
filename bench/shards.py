#!/usr/bin/env python3
"""Builds and searches tables of 10^5 to 10^7 vectors, and simulates 10^8 on several machines from that.

    make bench-shards           builds the programs, sets up the environment, writes its section of docs/benchmarks.md

Vectors imitate signatures as in search.py, made in pieces, so that no process holds all of them. Each step runs in a process of
its own, whose peak of memory is read. Queries are other vectors of the same kind, one at a time.
"""
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from capacity import processor_time
from search import Ours, class_manifolds
from support import arguments, machine, table, write_section

SIZES = [100_000, 1_000_000, 10_000_000]
DIM = 199
K = 10
CANDIDATES = 40
RECALL = 0.99
ALL = 100_000_000
MACHINES = [1, 4, 16, 64, 256]
CORES = 16
# Alignment of the candidates of a search among 4,000 creatures, from the section on capacity: seconds of one core, and forms.
ALIGN, FORMS = 0.074, 16
# Bytes of a form with its signatures in an index.
FORM = 35_600


def pieces(n, seed=7, width=0.3, rows=20_000):
    """Vectors like those of search.signatures, some at a time."""
    random = np.random.default_rng(seed)
    centre, basis, share = class_manifolds(random, n, DIM)
    upto = np.cumsum(share)
    while True:
        of = np.minimum(np.searchsorted(upto, random.random(rows)), len(share) - 1)
        pose = (width * random.normal(size=(rows, basis.shape[1]))).astype("f4")
        pose[:, 0] += 0.3 * pose[:, 1] ** 2
        noise = 0.05 * random.standard_normal((rows, DIM), dtype="f4")
        yield centre[of] + np.einsum("ij,ijk->ik", pose, basis[of]) + noise


def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000


def size_of(folder):
    return sum(os.path.getsize(os.path.join(at, name)) for at, _, names in os.walk(folder) for name in names)


def percentiles(seconds):
    return [float(x) for x in 1e3 * np.percentile(seconds, [50, 99])]


def timed(ask, queries):
    seconds, found = [], []
    for query in queries:
        start = time.perf_counter()
        found.append(ask(query))
        seconds.append(time.perf_counter() - start)
    return seconds, found


def recall(found, truth):
    """How many of the nearest are among the candidates."""
    return float(np.mean([len(set(a) & set(b)) / K for a, b in zip(found, truth)]))


def write(path, n, queries, count):
    """Writes the table; the first vectors of the stream are queries."""
    from canonform import _vectors

    spent = 0.0

    def parts():
        nonlocal spent
        stream, done, begin = pieces(n), 0, time.process_time()
        np.save(queries, next(stream)[:count])
        while done < n:
            vectors = next(stream)[: n - done]
            names = [f"{i:08}" for i in range(done, done + len(vectors))]
            rows = _vectors.rows(names, [""] * len(vectors), [""] * len(vectors), f"{done}.canonform", vectors)
            spent += time.process_time() - begin
            yield rows
            begin, done = time.process_time(), done + len(vectors)

    start = time.process_time()
    _vectors.create(path, parts())
    return dict(seconds=time.process_time() - start - spent, made=spent, size=size_of(path))


def code(path):
    from canonform import _vectors

    before, start = size_of(path), time.process_time()
    stored, facts = _vectors.writable(path), _vectors.About(options="x")
    facts.partitions = _vectors.train(stored, 2, lambda make, items: [make(*item) for item in items])
    coded = time.process_time() - start
    facts.probes, facts.recall = _vectors.calibrate(stored)
    _vectors.describe(stored, facts)
    calibrated = time.process_time() - start - coded
    return dict(seconds=coded, calibrated=calibrated, size=size_of(path) - before, bytes=_vectors.n_codes(stored), probes=facts.probes,
                partitions=facts.partitions, stated=facts.recall)


def ask_table(path, queries):
    from canonform import _vectors

    stored = _vectors.opened(path)
    facts, asked = _vectors.about(stored), np.load(queries)
    rows = [_vectors.padded(stored, row) for row in asked]
    ask = lambda row: [name for _, name, _ in _vectors.nearest(stored, row, CANDIDATES, facts.probes)]
    timed(ask, rows)
    seconds, found = timed(ask, rows)
    before = peak()
    truth = _vectors.exact_neighbors(stored, [""] * len(rows), np.stack(rows))
    return dict(ms=percentiles(seconds), recall=recall(found, truth), megabytes=before)


def ask_workers(path, queries, n_workers):
    """Latency of one query at a time, and queries per second if 8 wait, on workers of one thread."""
    from canonform import _vectors
    from canonform.distributed import _mapped
    from distributed import Client, LocalCluster

    stored = _vectors.opened(path)
    facts, asked = _vectors.about(stored), np.load(queries)
    rows, parts = [_vectors.padded(stored, row) for row in asked], _vectors.pieces(stored)
    with LocalCluster(n_workers=n_workers, threads_per_worker=1, dashboard_address=":0") as cluster, Client(cluster) as client:
        def ask(row):
            found = _mapped(client, _vectors.nearest_in, [(part, row, CANDIDATES, facts.probes) for part in parts])
            return sorted(near for some in found for near in some)[:CANDIDATES]

        timed(ask, rows[:50])
        seconds, _ = timed(ask, rows)
        with ThreadPoolExecutor(8) as pool:
            start = time.perf_counter()
            list(pool.map(ask, rows))
            rate = len(rows) / (time.perf_counter() - start)
        start = time.perf_counter()
        client.gather([client.submit(int, i, pure=False) for i in range(1000)])
        task = (time.perf_counter() - start) / 1000
        megabytes = max(client.run(peak).values())
    return dict(ms=percentiles(seconds), rate=rate, task=task, megabytes=megabytes)


def ask_faiss(path, queries, partitions, n_codes):
    """Codes of the same size in as many cells, at the least number of probes that is enough."""
    import faiss
    from canonform import _vectors

    stored = _vectors.opened(path)
    rows = np.stack([_vectors.padded(stored, row) for row in np.load(queries)])
    sample = np.sort(np.random.default_rng(0).permutation(stored.count_rows())[: 48 * partitions])
    start = time.process_time()
    index = faiss.IndexIVFPQ(faiss.IndexFlatL2(rows.shape[1]), rows.shape[1], partitions, n_codes, 8)
    index.train(_vectors.matrix(stored.take(sample.tolist(), columns=["vector"])))
    for batch in _tables(stored):
        index.add(_vectors.matrix(batch))
    seconds, megabytes = time.process_time() - start, peak()
    # Vectors were added in the order of their names.
    truth = [[int(name) for name in near] for near in _vectors.exact_neighbors(stored, [""] * len(rows), rows)]
    faiss.omp_set_num_threads(1)
    for probes in (2**i for i in range(12)):
        index.nprobe = probes
        spent, found = timed(lambda row: index.search(row[None], CANDIDATES)[1][0].tolist(), rows)
        if recall(found, truth) >= RECALL:
            break
    return dict(seconds=seconds, ms=percentiles(spent), recall=recall(found, truth), probes=probes, megabytes=megabytes)


def _tables(stored):
    import pyarrow as pa

    for batch in stored.scanner(columns=["vector"], scan_in_order=True).to_batches():
        yield pa.Table.from_batches([batch])


def save(path, to):
    from canonform import _vectors

    np.save(to, np.concatenate([_vectors.matrix(rows)[:, :DIM] for rows in _tables(_vectors.opened(path))]))
    return {}


STEPS = dict(write=write, code=code, table=ask_table, workers=ask_workers, faiss=ask_faiss, save=save)


def step(name, *args):
    """Runs a step in a fresh process: its answer, with the peak of its memory in MB."""
    run = subprocess.run([sys.executable, __file__, "--step", json.dumps([name, *args])], stdout=subprocess.PIPE, text=True, check=True)
    found = json.loads(run.stdout.splitlines()[-1])
    print(name, args[1:], found, file=sys.stderr, flush=True)
    return found


def ours(vectors, folder, path, queries):
    """The index of this project with the same vectors."""
    base, index = os.path.join(folder, "base.npy"), os.path.join(folder, "index")
    step("save", path, base)
    seconds = processor_time([vectors, "build", base, index])[0]
    os.remove(base)
    search = Ours(vectors, index, queries)
    n = len(np.load(queries))
    result = dict(seconds=seconds, recall=1.0, size=os.path.getsize(index))
    search.ask(0, n)
    result["scan"] = percentiles(search.ask(0, n)[0])
    result["megabytes"] = search.memory()
    search.end()
    os.remove(index)
    print("ours", result, file=sys.stderr, flush=True)
    return result


def measure(args, n, folder):
    path, queries = os.path.join(folder, "vectors.lance"), os.path.join(folder, "queries.npy")
    count = 300 if n <= 1_000_000 else 100
    row = dict(n=n, write=step("write", path, n, queries, count), code=step("code", path))
    row["table"] = step("table", path, queries)
    row["workers"] = {str(w): step("workers", path, queries, w) for w in (1, 2)}
    row["faiss"] = step("faiss", path, queries, row["code"]["partitions"], row["code"]["bytes"])
    if n == 1_000_000:
        if os.path.exists(args.vectors):
            row["ours"] = ours(args.vectors, folder, path, queries)
    shutil.rmtree(path)
    return row


def power(rows, value):
    """Exponent of a value by n between the last two sizes, at least 0, and the value of the last."""
    (a, b), n = [value(row) for row in rows[-2:]], [row["n"] for row in rows[-2:]]
    return max(0.0, np.log(b / a) / np.log(n[1] / n[0])), b


def task_seconds(rows):
    """What a task costs the scheduler: the least that was measured, because other load only adds to it."""
    return min(found["task"] for row in rows for found in row["workers"].values())


def simulate(rows):
    """Latency and queries per second of 10^8 shapes on some machines: (machines, ms, queries a second, bound by, GB of codes, GB of
    disk). Every machine searches its part of the codes and aligns its share of the candidates; the scheduler handles every task."""
    exponent, last = power(rows, lambda row: row["table"]["ms"][0])
    task = 1e3 * task_seconds(rows)
    code, vector = (rows[-1][part]["size"] / rows[-1]["n"] for part in ("code", "write"))
    align = 1e3 * ALIGN / FORMS * CANDIDATES
    for machines in MACHINES:
        search = last * (ALL / machines / rows[-1]["n"]) ** exponent
        tasks = machines + CANDIDATES
        latency = search + align / min(CANDIDATES, machines * CORES) + task * tasks
        cores, scheduler = 1e3 * machines * CORES / (search * machines + align), 1e3 / (task * tasks)
        yield (machines, latency, min(cores, scheduler), "cores" if cores < scheduler else "scheduler", code * ALL / machines / 1e9,
               (vector + FORM) * ALL / machines / 1e9)


def digits(x):
    return f"{x:,.0f}" if abs(x) >= 100 else f"{x:.3g}"


def each(*numbers):
    return "/".join(map(digits, numbers))


def section(rows):
    yield "## Search past one machine"
    yield (f"`make bench-shards` on {machine()}: synthetic vectors of {DIM} numbers in a [table](guide/clusters.md#search-in-several-indexes), "
           f"{CANDIDATES} candidates. Recall: the ten nearest among them, in brackets as stated; peaks of memory, processor seconds. "
           "Other programs ran.")
    yield table(
        ["vectors", "MB: vectors/codes", "s: write/code/calibrate", "MB: write/code", "partitions", "recall", "alone: p50/p99 ms", "MB",
         "1/2 workers: ms", "queries/s"],
        [(f"{r['n']:,}", each(r["write"]["size"] / 1e6, r["code"]["size"] / 1e6),
          each(r["write"]["seconds"], r["code"]["seconds"], r["code"]["calibrated"]),
          each(r["write"]["megabytes"], r["code"]["megabytes"]), f"{r['code']['probes']}/{r['code']['partitions']:,}",
          f"{r['table']['recall']:.4f}({r['code']['stated']:.4f})", each(*r["table"]["ms"]), digits(r["table"]["megabytes"]),
          each(*(r["workers"][w]["ms"][0] for w in "12")), each(*(r["workers"][w]["rate"] for w in "12")))
         for r in rows])
    yield "*Beside others*, one thread:"
    cells = []
    for r in rows:
        t, f, n = r["table"], r["faiss"], f"{r['n']:,}"
        cells += [(n, "table", f"{t['recall']:.4f}", each(*t["ms"]), digits(r["write"]["seconds"] + r["code"]["seconds"]), digits(t["megabytes"])),
                  (n, "faiss IVF-PQ", f"{f['recall']:.4f}", each(*f["ms"]), digits(f["seconds"]), digits(f["megabytes"]))]
        if "ours" in r:
            o = r["ours"]
            cells += [(n, "index", f"{o['recall']:.4f}", each(*o["scan"]), digits(o["seconds"]), digits(o["megabytes"]))]
    yield table(["vectors", "solver", "recall", "p50/p99 ms", "build s", "MB"], cells)
    hours = ALL / rows[-1]["n"] * rows[-1]["code"]["seconds"] / 3600
    yield (f"*A hundred million shapes*, simulated on machines of {CORES} cores: {1e3 * ALIGN / FORMS:.1f} ms an alignment, "
           f"{1e3 * task_seconds(rows):.2f} ms of the scheduler a task, {digits(hours)} core hours of coding.")
    yield table(["machines", "ms", "queries/s", "bound by", "GB each: codes/disk"],
                [(f"{m:,}", digits(ms), digits(rate), bound, each(code, disk)) for m, ms, rate, bound, code, disk in simulate(rows)])


def main():
    if sys.argv[1:2] == ["--step"]:
        name, *args = json.loads(sys.argv[2])
        found = STEPS[name](*args)
        print(json.dumps({"megabytes": peak(), **found}))
        return
    options = arguments(__doc__, "target/release/canonform", 1, largest=SIZES[-1])
    options.add_argument("--vectors", default="target/release/examples/vectors")
    options.add_argument("--folder", default="target", help="where the tables are written; the largest takes 9 GB")
    options.add_argument("--record", help="measurements: sizes in the file are not measured again")
    args = options.parse_args()
    rows = []
    if args.record and os.path.exists(args.record):
        with open(args.record) as file:
            rows = json.load(file)
    for n in SIZES:
        if n > args.largest or any(row["n"] == n for row in rows):
            continue
        with tempfile.TemporaryDirectory(dir=args.folder) as folder:
            rows.append(measure(args, n, folder))
        if args.record:
            with open(args.record, "w") as file:
                json.dump(rows, file)
    write_section(args.output, "bench-shards", *section(rows))


if __name__ == "__main__":
    main()
