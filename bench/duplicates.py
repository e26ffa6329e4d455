#!/usr/bin/env python3
"""Times the search for duplicates in a collection of generated shapes, by the number of shapes.

Half of a collection are different shapes: mechanical parts with parameters near each other, and poses of creatures, cats, centaurs
and men. The others are copies of some of them: the same file, in other formats, moved, scaled, mirrored, renumbered, subdivided, with
noise, with other arcs.
"""
import json
import os
import shutil
import tempfile

import numpy as np

from support import CANONFORM, benchmark, generate, machine, read_mesh, run, subdivided, write_mesh

# Noise of the copies, relative to the diagonal of the box.
NOISE = 0.002


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


def collection(folder, n):
    """Writes n shapes; the original of every file, by its name."""
    stream = np.random.default_rng(n)
    made, shapes = os.path.join(folder, "made"), os.path.join(folder, "shapes")
    at = lambda family: os.path.join(made, family)
    generate(at("parts"), "parts", "--parts", 3 * n // 10)
    generate(at("creatures"), "creatures", "--classes", n // 50, "--poses", 9)
    generate(at("all"), "all", "--poses", max(1, n // 150))
    generate(at("coarser"), "parts", "--parts", 3 * n // 10, "--arcs", 24)
    originals = [os.path.join(at(family), name) for family in ("parts", "creatures", "all")
                 for name in sorted(os.listdir(at(family))) if name.endswith(".off")]
    originals = [originals[i] for i in sorted(stream.permutation(len(originals))[:n // 2])]
    os.makedirs(shapes)
    of = {}
    for path in originals:
        shutil.copy(path, shapes)
        name = os.path.basename(path)[:-4]
        of[name] = name
    kinds = ["file", *FORMATS, *TREATMENTS, "arcs"]
    while len(of) < n:
        path, kind = originals[stream.integers(len(originals))], kinds[stream.integers(len(kinds))]
        if kind == ("noisy" if "/parts/" in path else "arcs"):
            continue
        original = os.path.basename(path)[:-4]
        name = f"{original}-{kind}-{len(of)}"
        copy = os.path.join(shapes, name + ".off")
        if kind in TREATMENTS:
            write_mesh(copy, *TREATMENTS[kind](*read_mesh(path), stream))
        elif kind in FORMATS:
            run([CANONFORM, "convert", path, copy[:-3] + kind, "-q"])
        else:
            shutil.copy(os.path.join(at("coarser"), original + ".off") if kind == "arcs" else path, copy)
        of[name] = original
    shutil.rmtree(made)
    return shapes, of


def judged(found, of):
    """Copies that are in one group with another file of their original, and members that are another part than what they are said to copy."""
    told, false = 0, []
    for group in found["groups"]:
        members = group["members"]
        originals = [of[id] for id in [group["keeper"]["id"], *(member["id"] for member in members)]]
        told += len(originals) - len(set(originals))
        for member in members:
            # Some parts are others at another size, or their mirror images, as screws of either hand.
            is_alike = {"scaled", "mirrored"} & set(member["relation"]["changes"])
            part, other = (of[member[end]].replace("-h-1", "-h1") for end in ("id", "of"))
            if part != other and not is_alike:
                false.append((member["of"], member["id"], member["relation"]["text"]))
    return told, false


def measure(folder, n, rounds):
    shapes, of = collection(os.path.join(folder, str(n)), n)
    index = shapes + ".canonform"
    run([CANONFORM, "index", "build", shapes, "-o", index, "-q"])
    # The program ends with 1 if there are no duplicates.
    runs = [run([CANONFORM, "duplicates", index, "--json", "-q"], accepted=(0, 1)) for _ in range(rounds)]
    elapsed, processor, memory = (float(np.median([getattr(one, part) for one in runs]))
                                  for part in ("elapsed", "processor", "memory"))
    found = json.loads(runs[0].output)
    told, false = judged(found, of)
    for pair in false:
        print("not copies:", *pair)
    n_copies = len(of) - len(set(of.values()))
    cells = (f"{n:,}: {processor:.1f}, {elapsed:.1f}, {memory:.0f}, {found['n_compared']:,}, {told} of {n_copies}, {len(false)}")
    print(cells, flush=True)
    return cells


def section(args):
    with tempfile.TemporaryDirectory() as folder:
        cells = [measure(folder, n, args.rounds) for n in (args.most // 5, args.most)]
    yield "## Duplicates in a collection"
    yield (f"`make bench-duplicates` on {machine()}: `canonform duplicates` on indexes of generated shapes, half of them copies, "
           f"medians of {args.rounds} runs. Shapes: processor seconds, seconds, peak MB, pairs of meshes compared, copies found, "
           f"wrong ones. {'; '.join(cells)}.")


if __name__ == "__main__":
    benchmark(__doc__, section, rounds=3, most=1000)
