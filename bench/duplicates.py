#!/usr/bin/env python3
"""Times the search for duplicates in a collection of generated shapes, by the number of shapes.

    make bench-duplicates       builds the program, sets up the environment, writes its section of docs/benchmarks.md

Needs no data. Half of a collection are different shapes: mechanical parts with parameters near each other, poses of random
creatures, and poses of cats, centaurs and men. The others are copies of some of them: the same file, in other formats,
moved, scaled, mirrored, renumbered, subdivided, with noise, with other arcs.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np

from support import answer, arguments, machine, subdivided, write_section

# Noise of the copies, relative to the diagonal of the box.
NOISE = 0.002


def read_off(path):
    with open(path) as file:
        words = file.read().split()
    n, m = int(words[1]), int(words[2])
    rest = np.array(words[4:], dtype=float)
    return rest[:3 * n].reshape(n, 3), rest[3 * n:].reshape(m, 4)[:, 1:].astype(np.int64)


def write_off(path, vertices, faces):
    with open(path, "w") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        file.writelines("%.9g %.9g %.9g\n" % tuple(v) for v in vertices)
        file.writelines("3 %d %d %d\n" % tuple(f) for f in faces)


def turned(vertices, stream):
    turn, _ = np.linalg.qr(stream.normal(size=(3, 3)))
    return vertices @ (turn * np.sign(np.linalg.det(turn))).T + stream.normal(size=3) * np.ptp(vertices)


def renumbered(vertices, faces, stream):
    order = stream.permutation(len(vertices))
    rank = np.argsort(order)
    return vertices[order], rank[faces][stream.permutation(len(faces))]


TREATMENTS = {
    "moved": lambda v, f, s: (turned(v, s), f),
    "inches": lambda v, f, s: (turned(v, s) / 25.4, f),
    "mirrored": lambda v, f, s: (turned(v * [-1, 1, 1], s), f[:, ::-1]),
    "renumbered": lambda v, f, s: renumbered(v, f, s),
    "subdivided": lambda v, f, s: subdivided(turned(v, s), f),
    "noisy": lambda v, f, s: (v + s.normal(size=v.shape) * NOISE * np.linalg.norm(np.ptp(v, axis=0)), f),
}
FORMATS = ["stl", "ply", "obj"]


def collection(program, folder, n):
    """Writes n shapes; the original of every file, by its name."""
    stream = np.random.default_rng(n)
    made = os.path.join(folder, "made")
    generate = lambda family, *options: answer([program, "generate", "--family", family, *options, "-q", "--json",
                                                "-o", os.path.join(made, family)])
    generate("parts", "--parts", str(3 * n // 10))
    generate("creatures", "--classes", str(n // 50), "--poses", "9")
    generate("all", "--poses", str(max(1, n // 150)))
    coarser = os.path.join(made, "coarser")
    answer([program, "generate", "--family", "parts", "--parts", str(3 * n // 10), "--arcs", "24", "-q", "--json", "-o", coarser])
    originals = [os.path.join(at, name) for family in ("parts", "creatures", "all")
                 for at in [os.path.join(made, family)] for name in sorted(os.listdir(at)) if name.endswith(".off")]
    originals = [originals[i] for i in sorted(stream.permutation(len(originals))[:n // 2])]
    shapes = os.path.join(folder, "shapes")
    os.makedirs(shapes)
    of = {}
    for path in originals:
        name = os.path.basename(path)[:-4]
        shutil.copy(path, shapes)
        of[name] = name
    kinds = ["file", *FORMATS, *TREATMENTS, "arcs"]
    while len(of) < n:
        path, kind = originals[stream.integers(len(originals))], kinds[stream.integers(len(kinds))]
        original = os.path.basename(path)[:-4]
        name = f"{original}-{kind}-{len(of)}"
        copy = os.path.join(shapes, name + ".off")
        if kind == "arcs":
            if "/parts/" not in path:
                continue
            shutil.copy(os.path.join(coarser, original + ".off"), copy)
        elif kind in TREATMENTS:
            if kind == "noisy" and "/parts/" in path:
                continue
            write_off(copy, *TREATMENTS[kind](*read_off(path), stream))
        elif kind == "file":
            shutil.copy(path, copy)
        else:
            subprocess.run([program, "convert", path, copy[:-3] + kind, "-q"], check=True, stdout=subprocess.DEVNULL)
        of[name] = original
    shutil.rmtree(made)
    return shapes, of


def timed(program, index):
    """Elapsed and processor seconds, peak memory in MB, and the answer."""
    with tempfile.TemporaryFile("w+") as out:
        start = time.perf_counter()
        process = subprocess.Popen([program, "duplicates", index, "--json", "-q"], stdout=out)
        _, status, usage = os.wait4(process.pid, 0)
        elapsed = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode > 1:
            sys.exit(f"the program ended with {process.returncode}")
        out.seek(0)
        return elapsed, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1000, json.load(out)


def judged(found, of):
    """Copies that are in one group with another file of their original, and members that are another part than their keeper."""
    told, false = 0, []
    for group in found["groups"]:
        keeper, members = group["keeper"]["id"], group["members"]
        originals = [of[id] for id in [keeper, *(member["id"] for member in members)]]
        told += len(originals) - len(set(originals))
        for member in members:
            # Some parts are others at another size, or their mirror images.
            is_alike = {"scaled", "mirrored"} & set(member["relation"]["changes"])
            if of[member["id"]] != of[keeper] and not is_alike:
                false.append((keeper, member["id"], member["relation"]["text"]))
    return told, false


def measure(program, folder, n, rounds):
    at = os.path.join(folder, str(n))
    index, truth = os.path.join(at, "all.canonform"), os.path.join(at, "of.json")
    if not os.path.exists(index):
        shapes, of = collection(program, at, n)
        with open(truth, "w") as file:
            json.dump(of, file)
        subprocess.run([program, "index", "build", shapes, "-o", index, "-q"], check=True, stdout=subprocess.DEVNULL)
    with open(truth) as file:
        of = json.load(file)
    runs = [timed(program, index) for _ in range(rounds)]
    elapsed, processor, memory = (float(np.median([run[i] for run in runs])) for i in range(3))
    told, false = judged(runs[0][3], of)
    for pair in false:
        print("not copies:", *pair)
    n_copies = len(of) - len(set(of.values()))
    row = (n, elapsed, processor, memory, runs[0][3]["n_compared"], told, n_copies, len(false))
    print(row, flush=True)
    return row


def main():
    args = arguments(__doc__, "target/release/canonform", rounds=3, most=1000)
    args.add_argument("--folder", help="where collections and indexes are kept, and found again")
    args = args.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = [measure(args.program, args.folder or folder, n, args.rounds) for n in (args.most // 5, args.most)]
    exponent = float(np.log(rows[-1][2] / rows[0][2]) / np.log(rows[-1][0] / rows[0][0]))
    at = lambda n: rows[-1][2] * (n / rows[-1][0]) ** exponent
    cells = "; ".join(f"{n:,}: {processor:.1f}, {elapsed:.1f}, {memory:.0f}, {compared:,}, {told} of {copies}, {false}"
                      for n, elapsed, processor, memory, compared, told, copies, false in rows)
    write_section(
        args.output, "bench-duplicates", "## Duplicates in a collection",
        f"`make bench-duplicates` on {machine()}: `canonform duplicates` on indexes of generated shapes, half of them copies, medians of "
        f"{args.rounds} runs. Shapes: processor seconds, seconds, peak MB, pairs of meshes compared, copies found, wrong ones. "
        f"{cells}. Processor time grows with shapes to the power {exponent:.2f}, which makes {at(10_000):,.0f} s for 10,000.")


if __name__ == "__main__":
    main()
