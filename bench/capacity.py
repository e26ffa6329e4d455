#!/usr/bin/env python3
"""Measures what a shape costs, and simulates the indexing of ten million shapes from that.

Needs no data: shapes are generated. The processor time of describing a shape is measured by the number of its vertices,
the bytes of an index by the number of its shapes, search and merging among synthetic signatures as in search.py. Sizes
of meshes are then drawn from a log-normal distribution, and shards of them are handed to workers as a scheduler would.
"""
import heapq
import os
import shutil
import tempfile

import numpy as np

from search import Ours, resident, signatures
from support import CANONFORM, answer, benchmark, generate, machine, run, table

SIZES = [1_000, 3_400, 10_000, 30_000, 100_000, 300_000]
STORED = [100, 1_000, 4_000]
VECTORS = [10_000, 100_000, 1_000_000]
# Numbers in a fused vector.
DIM = 172
QUERIES = 300
SHAPES = 10_000_000
LARGEST = 1_000_000


def describe(folder, sizes):
    """Processor seconds, memory and file size per shape, for each number of vertices."""
    rows = []
    for n_vertices in sizes:
        shapes, index = os.path.join(folder, f"of{n_vertices}"), os.path.join(folder, f"of{n_vertices}.canonform")
        generate(shapes, "all", "--poses", 1, "--vertices", n_vertices)
        names = os.listdir(shapes)
        build = [CANONFORM, "index", "build", shapes, "--threads", "1", "-q", "-o"]
        # The start of the program and the write of the file, which are paid once for an index.
        empty = run([*build, index + ".empty", "--shard", f"{len(names) + 1}/{len(names) + 1}"])
        built = run([*build, index])
        size = sum(os.path.getsize(os.path.join(shapes, name)) for name in names) / len(names)
        rows.append((n_vertices, (built.processor - empty.processor) / len(names), built.memory, size / 1e6))
        print("described %d vertices: %.3f s" % rows[-1][:2], flush=True)
    return rows


def store(folder, counts):
    """Processor seconds per shape, bytes, seconds of a search, aligned forms and seconds of a merge, by the number of shapes."""
    rows = []
    shapes = os.path.join(folder, "creatures")
    for count in counts:
        generate(shapes, "creatures", "--classes", count // 5, "--poses", 5, "--vertices", 1000)
        index = os.path.join(folder, f"{count}.canonform")
        built = run([CANONFORM, "index", "build", shapes, "-o", index, "-q"])
        listed = [shape["id"] for shape in answer([CANONFORM, "index", "list", index, "--json"])["shapes"]]
        asked = listed[:: max(1, count // 15)]
        found = [answer([CANONFORM, "search", index, "--id", name, "--json", "-q"])["queries"][0] for name in asked]
        searched = float(np.median([query["seconds"]["search"] for query in found]))
        aligned = float(np.median([query["aligned"] for query in found]))
        merged = run([CANONFORM, "index", "merge", index, "-q", "-o", index + ".merged"]).elapsed
        rows.append((len(listed), built.processor / len(listed), os.path.getsize(index), searched, aligned, merged))
        print("stored", rows[-1], flush=True)
        shutil.rmtree(shapes)
    return rows


def search(folder, counts):
    """Build, memory and latency by the number of signatures."""
    rows = []
    for n in counts:
        data = signatures(n + QUERIES, DIM)
        base, queries, index = (os.path.join(folder, name) for name in ("base.npy", "queries.npy", "vectors"))
        np.save(queries, data[n:])
        np.save(base, data[:n])
        del data
        ours = Ours(index, queries, os.cpu_count())
        built = ours.build(base)
        ours.serve()
        ours.ask(0, QUERIES)
        ms, memory = np.array(ours.ask(0, QUERIES)[0]) * 1e3, resident(ours.process)
        ours.end()
        rows.append(dict(n=n, build_seconds=built, size=os.path.getsize(index), memory=memory,
                         ms=[np.median(ms), np.percentile(ms, 99)]))
        os.remove(index)
        print("searched", rows[-1], flush=True)
    return rows


def power(x, y, least=0.0):
    """Exponent and factor of y = factor x^exponent through the last two points, or with the least exponent through the last."""
    exponent = max(least, np.log(y[-1] / y[-2]) / np.log(x[-1] / x[-2]))
    return exponent, y[-1] / x[-1] ** exponent


def costs(sizes, measured):
    """Seconds of shapes with these numbers of vertices: interpolated, and beyond the measured sizes extrapolated, in logarithms."""
    x, y = np.log([row[0] for row in measured]), np.log([row[1] for row in measured])
    logs = np.log(sizes)
    slope = (y[-1] - y[-2]) / (x[-1] - x[-2])
    return np.exp(np.where(logs > x[-1], y[-1] + slope * (logs - x[-1]), np.interp(logs, x, y)))


def schedule(tasks, workers):
    """When the last of these tasks ends, if the next one always goes to the worker that is free first."""
    free = [0.0] * min(workers, len(tasks))
    for task in tasks:
        heapq.heapreplace(free, free[0] + task)
    return max(free)


def simulate(cost, workers, n_shards):
    shard = np.bincount(np.arange(len(cost)) % n_shards, cost, n_shards)
    end, ideal = schedule(shard.tolist(), workers), cost.sum() / workers
    return dict(longest=shard.max() / 3600, end=end / 3600, efficiency=ideal / end)


def digits(x):
    """Two or three significant digits, without an exponent."""
    return f"{x:,.0f}" if abs(x) >= 100 else f"{x:.3g}"


def section(args):
    with tempfile.TemporaryDirectory() as folder:
        described = describe(folder, [n for n in SIZES if n <= args.vertices])
        stored = store(folder, [n for n in STORED if n <= args.shapes])
        searched = search(folder, [n for n in VECTORS if n <= args.vectors])
    random = np.random.default_rng(1)
    sizes = np.clip(args.median * np.exp(args.sigma / 100 * random.standard_normal(SHAPES)), 200, LARGEST)
    cost = costs(sizes, described)
    total = cost.sum()
    order = np.sort(cost)[::-1]
    simulated = {w: {s: simulate(cost, w, s * w) for s in (1, 10, 100)} for w in (64, 1024)}
    capped = cost[sizes <= 200_000]
    n = [row["n"] for row in searched]
    per_shape = (stored[-1][2] - stored[-2][2]) / (stored[-1][0] - stored[-2][0])
    per_vector = (searched[-1]["memory"] - searched[-2]["memory"]) / (n[-1] - n[-2]) * 1e6
    merge = power([row[0] for row in stored], [row[5] for row in stored], 1)
    at = lambda fit, x: fit[1] * x ** fit[0]
    latency = power(n, [row["ms"][0] for row in searched], 1)
    mean_file = float(np.interp(np.log(sizes.mean()), np.log([r[0] for r in described]), [r[3] for r in described]))
    yield "## Plan for ten million shapes"
    yield (f"`make bench-capacity` on {machine()}, on generated shapes and synthetic signatures. The largest index had {n[-1]:,} "
           f"signatures, the largest mesh {described[-1][0]:,} vertices.")
    exponent = power([r[0] for r in described], [r[1] for r in described])[0]
    yield (f"*A shape*, one thread, from the file to the index. From the two largest sizes, time grows with vertices to the power "
           f"{exponent:.2f}. Small meshes are refined before they are described, so they cost as much as larger ones.")
    yield table(["vertices", "processor seconds", "peak MB", "`.off` MB"],
                [(f"{v:,}", digits(s), digits(m), digits(f)) for v, s, m, f in described])
    yield "*An index* of creatures with 1,000 vertices, all cores. A search aligns " + f"{digits(stored[-1][4])} forms."
    yield table(["shapes", "processor seconds per shape", "bytes per shape", "search ms", "merge s"],
                [(f"{c:,}", digits(b), f"{z / c:,.0f}", digits(1000 * s), digits(m)) for c, b, z, s, _, m in stored])
    yield f"*Signatures* of {DIM} numbers without forms, all threads, {QUERIES} other queries."
    yield table(["signatures", "file MB", "build s", "memory MB", "p50, p99 ms"],
                [(f"{r['n']:,}", digits(r["size"] / 1e6), digits(r["build_seconds"]), digits(r["memory"]),
                  "{}, {}".format(*map(digits, r["ms"])))
                 for r in searched])
    yield (f"*Ten million shapes*, simulated: sizes are log-normal with a median of {args.median:,} vertices and a standard deviation of "
           f"the logarithm of {args.sigma / 100:.1f}, at most {LARGEST:,} (mean {sizes.mean():,.0f}). Measure yours with "
           "`canonform info DIR --json`, and pass `--median` and `--sigma` (in hundredths) to `bench/capacity.py`.")
    yield table(["part", "bound by", "ten million shapes", "beyond"], [
        ("describing", "cores", f"{total / 3600:,.0f} core hours, {total / SHAPES:.2f} s each; the largest 1 % take "
                                f"{order[:SHAPES // 100].sum() / total * 100:.0f} %",
         f"`--max-vertices 200000` leaves out {(1 - len(capped) / SHAPES) * 100:.2g} % and saves "
         f"{(1 - capped.sum() / total) * 100:.0f} %"),
        ("the largest shape", "memory of a worker", f"{digits(described[-1][2])} MB at {described[-1][0]:,} vertices", "`--memory`"),
        ("reading", "the file system", f"{1.024 * mean_file / (total / SHAPES):.1f} GB/s for 1,024 cores", "binary formats"),
        ("merging", "one process and disk", f"{at(merge, SHAPES) / 60:,.0f} minutes, {per_shape * SHAPES / 1e9:,.0f} GB",
         "several indexes"),
        ("search", "memory", f"{per_vector * SHAPES / 1e9:.0f} GB, {digits(at(latency, SHAPES))} ms, and "
                             f"{1000 * stored[-1][3]:.0f} ms for alignment",
         "tables of coded vectors"),
        ("`evaluate`", "pairs", "the limit is 10,000 shapes", "a sample")])
    yield ("*Shards* of `--shard I/N` go to the worker, one core each, that is free first. Cells: hours until the end, efficiency, hours "
           "of the longest shard. Take ten to a hundred for each worker: a lost worker costs one shard at most.")
    yield table(["shards per worker", *(f"{w:,} workers" for w in simulated)], [
        (str(s), *("{}, {:.1f} %, {}".format(digits(runs[s]["end"]), 100 * runs[s]["efficiency"], digits(runs[s]["longest"]))
                   for runs in simulated.values())) for s in (1, 10, 100)])


if __name__ == "__main__":
    benchmark(__doc__, section, median=5000, sigma=150, vertices=SIZES[-1], shapes=STORED[-1], vectors=VECTORS[-1])
