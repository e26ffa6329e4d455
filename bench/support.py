"""Shared by the benchmarks: arguments, meshes, calls of the program, tables, sections of the page."""
import argparse
import contextlib
import heapq
import json
import math
import os
import platform
import subprocess
import sys
import tempfile

import numpy as np

# The number of vertices in the published figures of the peers.
FINE = 27_894

# The page of all benchmarks. Each writes its own section.
PAGE = "docs/benchmarks.md"


def arguments(doc, program, rounds, **more):
    """A parser of the options of all benchmarks, and of `more` numbers, given by their defaults."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--program", default=program)
    parser.add_argument("--output", default=PAGE, help="the page whose section is written")
    for name, default in {"rounds": rounds, **more}.items():
        parser.add_argument(f"--{name}", type=int, default=default)
    return parser


def mesh_arguments(*args, **more):
    parser = arguments(*args, **more)
    parser.add_argument("--data", default=os.environ.get("CANONFORM_DATA", "../shared/data"))
    return parser.parse_args()


@contextlib.contextmanager
def test_meshes(data):
    """Title -> path of each test mesh. Generates the second one for the duration of the context."""
    cat = os.path.join(data, "tosca-lowres", "cat0.vert")
    if not os.path.exists(cat):
        sys.exit(f"{cat} is missing: pass --data FOLDER with tosca-lowres/ and single/")
    with tempfile.TemporaryDirectory() as folder:
        fine = os.path.join(folder, "cat0-28k.obj")
        write_mesh(fine, *bisected(*read_mesh(cat), FINE))
        yield {"cat0 of TOSCA": cat, "cat0, longest edges bisected": fine,
               "armadillo": os.path.join(data, "single", "armadillo.obj")}


def read_mesh(path):
    if path.endswith(".vert"):
        return np.loadtxt(path), np.loadtxt(path[:-5] + ".tri").astype(np.int64) - 1
    vertices, faces = [], []
    with open(path) as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                vertices.append([float(x) for x in words[1:4]])
            elif words[:1] == ["f"]:
                faces.append([int(x.split("/")[0]) - 1 for x in words[1:4]])
    return np.array(vertices), np.array(faces)


def write_mesh(path, vertices, faces):
    with open(path, "w") as file:
        file.writelines("v %.17g %.17g %.17g\n" % tuple(v) for v in vertices)
        file.writelines("f %d %d %d\n" % tuple(f + 1) for f in faces)


def bisected(vertices, faces, n_vertices):
    """Bisects longest edges up to a number of vertices, without changing the surface."""
    vertices, faces = [tuple(v) for v in vertices], [list(f) for f in faces]
    at_edge = {}
    length = lambda a, b: math.dist(vertices[a], vertices[b])
    key = lambda a, b: (min(a, b), max(a, b))
    heap = []

    def attach(face):
        f = faces[face]
        for k in range(3):
            edge = key(f[k], f[(k + 1) % 3])
            at_edge.setdefault(edge, set()).add(face)
            heapq.heappush(heap, (-length(*edge), edge))

    for face in range(len(faces)):
        attach(face)
    while len(vertices) < n_vertices:
        _, edge = heapq.heappop(heap)
        if edge not in at_edge:
            continue
        middle = len(vertices)
        vertices.append(tuple(0.5 * (p + q) for p, q in zip(vertices[edge[0]], vertices[edge[1]])))
        for face in sorted(at_edge[edge]):
            old = faces[face]
            for k in range(3):
                at_edge[key(old[k], old[(k + 1) % 3])].discard(face)
            faces[face] = [middle if v == edge[1] else v for v in old]
            faces.append([middle if v == edge[0] else v for v in old])
            attach(face)
            attach(len(faces) - 1)
        del at_edge[edge]
    return np.array(vertices), np.array(faces)


def subdivided(vertices, faces):
    """Splits every face into four at the middles of its edges, without changing the surface."""
    sides = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges, middle = np.unique(sides, axis=0, return_inverse=True)
    ab, bc, ca = len(vertices) + middle.reshape(3, -1)
    a, b, c = faces.T
    vertices = np.vstack([vertices, vertices[edges].mean(axis=1)])
    return vertices, np.vstack([np.stack(f, 1) for f in [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]])


def in_cache_order(vertices, faces):
    """Renumbers vertices breadth-first, and sorts faces by their first vertex."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import breadth_first_order

    n = len(vertices)
    graph = coo_matrix((np.ones(faces.size), (faces.ravel(), np.roll(faces, 1, axis=1).ravel())), (n, n)).tocsr()
    order = breadth_first_order(graph, 0, directed=False, return_predecessors=False)
    order = np.concatenate([order, np.setdiff1d(np.arange(n), order)])
    rank = np.empty(n, dtype=np.int64)
    rank[order] = np.arange(n)
    faces = rank[faces]
    return vertices[order], faces[np.argsort(faces.min(axis=1), kind="stable")]


def answer(command, **how):
    """The JSON output of a program."""
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True, **how).stdout)


def distances(program, mesh, method, sources, *options):
    """`canonform geodesic` on one thread: distances (one row per source), seconds per source, seconds of setup."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "distances.npy")
        seconds = answer([program, "geodesic", mesh, "--method", method, "--threads", "1", "--json", "-o", out,
                          "--source", ",".join(map(str, sources)), *options])["seconds"]
        return np.atleast_2d(np.load(out)), seconds["per_source"], seconds["setup"]


def machine():
    return f"{platform.machine()}, {os.cpu_count()} cores"


def table(head, rows):
    return "\n".join([f"|{'|'.join(head)}|", "|" + "---|" * len(head), *(f"|{'|'.join(row)}|" for row in rows)])


def mesh_table(corner, data, measure, first=0):
    """A table of the test meshes, a column each. `measure(path)` returns the number of vertices and the cells by name; rows
    are in the order of the last mesh."""
    columns = {}
    with test_meshes(data) as meshes:
        for title, path in list(meshes.items())[first:]:
            n_vertices, cells = measure(path)
            columns[f"{title}, {n_vertices:,}"] = cells
            print(title, cells, flush=True)
    return columns_table(corner, columns)


def columns_table(corner, columns):
    """A table of columns that map names of rows to cells, in the order of the last column."""
    names = list(dict.fromkeys(name for cells in reversed(columns.values()) for name in cells))
    return table([corner, *columns], [[name, *(cells.get(name, "-") for cells in columns.values())] for name in names])


def write_section(path, name, *parts):
    """Replaces the section between the comments `name begins` and `name ends` of a page, atomically."""
    with open(path) as file:
        page = file.read()
    begin, end = f"<!-- {name} begins -->\n", f"<!-- {name} ends -->\n"
    before, rest = page.split(begin)
    _, after = rest.split(end)
    with open(path + ".part", "w") as file:
        file.write(before + begin + "\n\n".join(part.strip() for part in parts) + "\n" + end + after)
    os.replace(path + ".part", path)
