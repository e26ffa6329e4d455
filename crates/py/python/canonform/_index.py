"""Indexes of shape collections."""

from __future__ import annotations

import csv
import glob
import json
import os
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from html import escape
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, Unpack, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _canonform, _html
from ._arrays import Floats, Ints, mesh_of, numeric, straight
from ._methods import Embedding, Geodesic, options_of
from ._settings import (
    Call, Components, IndexDistance, Landmarks, Ranking, RelationKind, Shown, SignatureKind, Weld, number, running, warned, whole, word,
)  # fmt: skip
from ._stored import Stored
from ._surface import AnyMesh, Surface, surface_of
from .datasets import Shape
from .errors import CanonformError, MeshError, MissingFileError, NoSuchShapeError, OptionError, ShapeIndexError, SkippedMeshWarning

if TYPE_CHECKING:
    import pandas

AnyPath: TypeAlias = str | os.PathLike[str]

Meshes: TypeAlias = AnyPath | Mapping[str, AnyMesh] | Iterable[AnyPath | Surface | tuple[str, AnyMesh] | tuple[str, AnyMesh, str]]
"""A dataset on disk, paths of mesh files, or meshes with names."""

Labels: TypeAlias = Mapping[str, str] | Sequence[str] | AnyPath
"""Classes by name, in the order of the meshes, or where they come from."""

_Files: TypeAlias = tuple[AnyPath | list[AnyPath], Labels | None, list[dict[str, Any]]]

_PICTURED = 6


@dataclass(frozen=True)
class ShapeEntry:
    """A shape of an index.

    Attributes:
        id: Its name.
        label: Its class; empty if it has none.
        path: Its mesh file.
        n_vertices, n_faces: The size of its mesh.
    """

    id: str
    label: str
    path: str
    n_vertices: int
    n_faces: int


@dataclass(frozen=True)
class Result:
    """A shape that was found.

    Attributes:
        rank: Counted from 1.
        id, label, path: As of `ShapeEntry`.
        distance: Combined distance from the query, by signatures and aligned forms.
        fused: Distance by signatures alone.
        relation: How the query and the shape are related, as in `Comparison.relation`; by files and meshes, too, if the search explains.
        rank_distance: What results are ordered by if they are ranked on the graph of nearest neighbors.
        part_distance: What results are ordered by if the query is taken as a part: 0 if it fits.
        part_share: The share of the area of the shape that the query has if it is taken as a part.
        surface_gap: What the first results are ordered by if the query has noise: how far their surfaces are from its own.
        form_distance: What results are ordered by if they are ranked by canonical forms alone.

    >>> result = index.search("cat0", k=1)[0]
    >>> result.rank, result.id, result.label
    (1, 'cat0', 'cat')
    """

    rank: int
    id: str
    label: str
    path: str
    distance: float
    fused: float
    relation: dict[str, Any]
    rank_distance: float | None
    part_distance: float | None
    part_share: float | None
    surface_gap: float | None
    form_distance: float | None


class SearchResults(Stored, Sequence[Result]):
    """The shapes nearest to a query, nearest first.

    Attributes:
        report: The answer that `canonform search --json` prints.
    """

    def __init__(self, report: dict[str, Any], query: Surface | str, name: str, index: Any) -> None:
        self.report = report
        self._results = [Result(**{field.name: found.get(field.name) for field in fields(Result)}) for found in report["results"]]
        self._query, self._name, self._index = query, name, index

    @property
    def predicted(self) -> dict[str, Any]:
        """The class that the nearest shapes suggest: `label` (None if it is unknown), `votes`, `confidence`, `explanation`, ..."""
        return self.report["predicted"]

    @property
    def label(self) -> str | None:
        """The predicted class; None if no shape is near enough."""
        label = self.predicted["label"]
        return None if label is None else str(label)

    @overload
    def __getitem__(self, i: int) -> Result: ...
    @overload
    def __getitem__(self, i: slice) -> list[Result]: ...
    def __getitem__(self, i: int | slice) -> Result | list[Result]:
        return self._results[i]

    def __len__(self) -> int:
        return len(self._results)

    def to_pandas(self) -> pandas.DataFrame:
        """One row for each result, with `rank` as the index."""
        import pandas

        columns = ["rank", "id", "label", "distance", "fused", "relation", "path"]
        rows = [vars(found) | {"relation": found.relation["kind"]} for found in self]
        return pandas.DataFrame(rows, columns=columns).set_index("rank")

    def __repr__(self) -> str:
        lines = [f"{found.rank:>3}  {found.id:<20} {found.label or '-':<12} {found.distance:.4f}" for found in self]
        return "\n".join([f"SearchResults of {self._name}: {self.predicted['explanation']}", *lines])

    def _repr_html_(self) -> str:
        shown = [(self._query, f"query: {self._name}"), *((found.id, f"{found.rank}. {found.id}") for found in self[:_PICTURED])]
        strip = f'<div style="display:flex;gap:10px;flex-wrap:wrap">{"".join(self._captioned(*one) for one in shown)}</div>'
        rows = ((str(f.rank), f.id, f.label or "-", f"{f.distance:.4f}", f.relation["text"]) for f in self)
        head = ("", "shape", "class", "distance", "relation")
        return _html.box(f"class: {self.predicted['explanation']}", strip + _html.table(head, rows))


    def _captioned(self, shape: Surface | str, caption: str) -> str:
        try:
            if isinstance(shape, str):
                shape = Surface(shape) if os.path.exists(shape) else self._index.surface(shape)
            image = _html.image(shape.picture(width=220, height=220), 110, caption)
        except (CanonformError, KeyError):
            # The file may be gone, and the results are worth showing all the same.
            image = ""
        return f'<div style="text-align:center;max-width:120px">{image}<div style="font-size:11px">{escape(caption)}</div></div>'


class Scores(dict[str, Any]):
    """How well classes are separated: the object that `canonform evaluate --json` prints, with `nn`, `ft`, `st`, `map`, ..."""

    def to_pandas(self) -> pandas.DataFrame:
        """How many shapes of each class, a row, were taken for each class, a column, by their neighbors."""
        import pandas

        return pandas.DataFrame(self["confusion"], index=self["classes"], columns=self["classes"])


class Index(Stored):
    """A searchable file of shapes.

    `Index.build(meshes, path)` makes one, `Index(path)` opens it. An index is one file; it finds shapes by their signatures and orders
    them by their aligned forms. Other programs may search it at the same time, also while it is changed; methods that change it continue
    to work with the new content.

    Attributes:
        build_report: What happened to each mesh when this object built or changed the index: the object that `canonform index build --json`
            prints.

    >>> len(index), "cat0" in index, index.classify(other)
    (9, True, 'cat')
    """

    def __init__(self, path: AnyPath) -> None:
        self._inner = _canonform.Index.open(os.fspath(path))
        self.build_report: dict[str, Any] | None = None

    def _state(self) -> dict[str, Any]:
        return {"path": os.path.abspath(self.path), "build_report": self.build_report}

    def _restore(self, state: dict[str, Any]) -> None:
        self._inner, self.build_report = _canonform.Index.open(state["path"]), state["build_report"]

    @classmethod
    def build(
        cls,
        meshes: Meshes,
        path: AnyPath,
        *,
        labels: Labels | None = None,
        prune: bool = False,
        keep_meshes: bool = False,
        shard: tuple[int, int] | None = None,
        n_landmarks: Landmarks = 100,
        n_points: int = 1000,
        size: bool = False,
        method: Embedding = "nmds",
        geodesic: Geodesic = "fast-marching",
        components: Components = "largest",
        weld: Weld = "seams",
        seed: int = 0,
        max_vertices: int | None = None,
        timeout: float | None = None,
        memory: int | str | None = None,
        **call: Unpack[Shown],
    ) -> Index:
        """Make the file `path` the index of meshes, and open it.

        Only new and changed meshes are described. After an interruption, call it again: finished work is kept. Meshes that cannot be
        described are left out and listed in `build_report["failed"]`.

        Args:
            meshes: A folder, also with sub-folders, an archive, a list file, or paths of mesh files. Or meshes in memory, as `Surface`
                takes them: a dictionary from names to meshes, or (name, mesh) and (name, mesh, class). A name may have folders: "cats/tom".
            labels: Where classes come from: "folders", "folders:N" (the N-th below), "names" (their leading letters), "none", classes in
                the order of the meshes or by name of the shape, or a file of lines `name,label`; shapes that are not named there have no
                class. By default, an index keeps those that were given; else sub-folders beside each other are classes if at least two hold
                at least two meshes each and none lies in another, else leading letters if at least two names share them.
            prune: Remove shapes of the index that came from elsewhere. Those of the same folder whose files are gone, and those in memory
                that are not among these meshes any more, are always removed.
            keep_meshes: Whether to keep meshes in memory as files in the folder PATH.meshes. Without them, results are not explained or
                drawn.
            shard: (i, k) to index the i-th of k equal parts of the meshes, counted from 1; `merge` joins them.
            n_points: Number of points of each form to keep for alignment.
            size: Whether to distinguish shapes by size; then all meshes need the same unit of length.
            n_landmarks, method, geodesic, seed: How forms are made, see `Surface.canonical_form`.
            components, weld: How meshes are repaired, see `Surface`.
            max_vertices, timeout, memory: Limits on each mesh; what exceeds them is left out.

        Raises `MeshError` if there are no meshes, or none of them can be described.
        Raises `ShapeIndexError` if the file is not an index, or was made with other options.

        >>> canonform.Index.build({"tom": cat}, "cats.canonform", labels=["cat"])["tom"].label
        'cat'
        """
        settings = options_of(
            n_landmarks=n_landmarks, n_points=n_points, size=size, method=method, geodesic=geodesic, components=components,
            weld=weld, seed=seed, max_vertices=max_vertices, timeout=timeout, memory=memory,
        )  # fmt: skip
        part = None if shard is None else (whole("shard", shard[0]), whole("shard", shard[1], 1))
        with running(call), in_files(meshes, path, labels, keep=keep_meshes) as (paths, known, failed):
            with TemporaryDirectory() as lists:
                (dataset, name), label_file = dataset_of(paths, lists), label_file_of(known, lists)
                report = json.loads(_canonform.Index.build(dataset, os.fspath(path), label_file, bool(prune), part, None, False, settings))
        report["failed"] += failed
        if not os.path.exists(path):
            raise none_described(name, report["failed"])
        _warn_of_skipped(report)
        return cls._opened(path, report)

    @classmethod
    def _opened(cls, path: AnyPath, report: dict[str, Any]) -> Index:
        index = cls(path)
        index.build_report = report
        return index

    @classmethod
    def merge(cls, indexes: Iterable[AnyPath], path: AnyPath, **call: Unpack[Call]) -> Index:
        """Merge `indexes` by their paths, for example those of shards, into one file, `path`, and open it.

        Raises `ShapeIndexError` if they have other options, or different shapes of the same name.

        >>> worm = canonform.datasets.generate("worm", poses=1, n_vertices=1000)
        >>> other = canonform.Index.build(worm, "worm.canonform")
        >>> len(canonform.Index.merge([index.path, other.path], "both.canonform"))
        10
        """
        with running(call):
            report = _canonform.merge_indexes([os.fspath(index) for index in indexes], os.fspath(path))
        return cls._opened(path, json.loads(report))

    def add(
        self,
        meshes: Meshes,
        *,
        label: str | None = None,
        labels: Labels | None = None,
        replace: bool = False,
        max_vertices: int | None = None,
        timeout: float | None = None,
        memory: int | str | None = None,
        **call: Unpack[Shown],
    ) -> dict[str, Any]:
        """Add meshes as in `build`: files, folders of them, or meshes in memory, described with the options of the index. Returns what happened to each.

        Args:
            label: The class of all of them. By default from their names, or from `labels`.
            replace: Replace shapes that have the same name. Otherwise a shape of the same name with another content is an error, and
                nothing is added.

        Raises `ShapeIndexError`, `OptionError` if a shape of the name has another content, or options contradict each other.

        >>> index.add([("tom", cat, "cat")])["n_shapes"], index.remove("tom")
        (10, 9)
        """
        settings = options_of(max_vertices=max_vertices, timeout=timeout, memory=memory)
        with running(call), in_files(meshes, self.path, labels, keep=False, add=not replace) as (paths, known, failed):
            if label is not None and known is not None:
                raise OptionError("label= has no effect with labels=, or for meshes that come with a class; leave one of them out")
            files = [os.fspath(path) for path in ([paths] if isinstance(paths, (str, os.PathLike)) else paths)]
            with TemporaryDirectory() as lists:
                report = json.loads(_canonform.Index.add(self.path, files, label, label_file_of(known, lists), bool(replace), settings))
        report["failed"] += failed
        _warn_of_skipped(report)
        self._reopen(report)
        return report

    def remove(self, ids: str | Iterable[str]) -> int:
        """Remove the shapes of these names, `ids`; none if one is unknown. Returns how many shapes are left."""
        left = _canonform.Index.remove(self.path, [ids] if isinstance(ids, str) else [word("ids", id) for id in ids])
        self._reopen(None)
        return left

    def _reopen(self, report: dict[str, Any] | None) -> None:
        self._inner, self.build_report = _canonform.Index.open(self.path), report

    def search(
        self, query: AnyMesh, k: int = 10, *, rank: Ranking = "plain", explain: bool = False, **call: Unpack[Call]
    ) -> SearchResults:
        """Find the shapes nearest to a query.

        Args:
            query: A surface, a mesh as `Surface` takes it, a mesh file, or the name of a shape of the index.
            k: Number of results.
            rank: "plain" orders results by distance, "graph" by distance and by the neighbors that query and shape have in common, "part"
                by how well the query fits as a part of the shape, for a mesh that was cut or scanned in part, "forms" by canonical forms
                alone.
            explain: Say how each result is related to the query, as `compare` does; reads the mesh files of the results.

        >>> index.search(other, k=3)[0].id
        'cat1'
        """
        with running(call):
            shape = os.fspath(query) if isinstance(query, (str, os.PathLike)) else surface_of(query)
            if isinstance(shape, Surface):
                name = shape._name or "the query"
            elif os.path.exists(shape) or shape in self:
                name = os.path.basename(shape) if os.path.exists(shape) else shape
            else:
                raise NoSuchShapeError(f"{shape!r} is neither a file nor a shape of the index; Index.shapes() names its shapes")
            given = shape._inner if isinstance(shape, Surface) else shape
            report = self._inner.search(given, name, whole("k", k), word("rank", rank), bool(explain))
        return SearchResults(json.loads(report), shape, name, self)

    def classify(self, query: AnyMesh, *, rank: Ranking = "plain", **call: Unpack[Call]) -> str | None:
        """The class of a query by the votes of the nearest shapes; None if no shape is near enough. `search` says why.

        A shape of the index, given by its name, has no vote about itself.

        >>> index.classify("david1")
        'david'
        """
        return self.search(query, 0, rank=rank, **call).label

    def evaluate(
        self,
        *,
        by: SignatureKind | Literal["combined"] | NDArray[Any] = "fused",
        k: int = 1,
        rank: Ranking = "plain",
        labels: Labels | None = None,
        **call: Unpack[Call],
    ) -> Scores:
        """How well the index separates classes.

        Args:
            by: What shapes are compared by: "fused", or the kind of signatures, see `Surface.signature`; "combined" for the distances that
                a search orders results by, with aligned forms; or a matrix of your own, with a row and a column for each shape in the order
                of `shapes`.
            k: Number of neighbors that vote on the class of a shape.
            rank: "plain", or "graph" to score the ranking on the graph of nearest neighbors as well, under the key `graph`.
            labels: Other classes, as in `build`.

        >>> index.evaluate(by=index.distances(kind="fused"))["nn"]
        1.0
        """
        ids = list(self)
        labels = _by_name(labels, ids)
        with running(call):
            if isinstance(by, str) and by != "combined":
                with TemporaryDirectory() as lists:
                    file = label_file_of(labels, lists)
                    return Scores(json.loads(self._inner.evaluate(by, whole("k", k), word("rank", rank), file)))
            if isinstance(labels, (str, os.PathLike)):
                raise OptionError("labels= needs classes by name here, or in the order of the shapes")
            known = {shape.id: shape.label for shape in self.shapes()} if labels is None else labels
            matrix = self.distances() if isinstance(by, str) else numeric("by", by, (len(ids), len(ids)))
            some = [i for i, id in enumerate(ids) if known.get(id)]
            classes = [known[ids[i]] for i in some]
            chosen = straight(matrix[np.ix_(some, some)])
            return Scores(json.loads(_canonform.evaluate_matrix(chosen, classes, whole("k", k), word("rank", rank))))

    @property
    def path(self) -> str:
        """The file."""
        return self._inner.path

    def info(self) -> dict[str, Any]:
        """Format, size, options and classes."""
        return json.loads(self._inner.info())

    def shapes(self) -> list[ShapeEntry]:
        """All shapes, by name."""
        return [ShapeEntry(*shape) for shape in self._inner.shapes()]

    def vectors(self) -> NDArray[np.float32]:
        """The fused signatures of all shapes, in the order of `shapes`: shape (number of shapes, length)."""
        return self._inner.vectors()

    def vector(self, id: str) -> NDArray[np.float32]:
        """The fused signature of the shape `id`."""
        return self._inner.vector(word("id", id))

    def nearest(self, vector: ArrayLike, k: int = 10, **call: Unpack[Call]) -> list[tuple[str, float]]:
        """The `k` shapes whose signatures are nearest to `vector`, such as `Surface.signature()`: names and distances, nearest first.

        >>> [name for name, distance in index.nearest(cat.signature(), 2)]
        ['cat0', 'cat1']
        """
        with running(call):
            return self._inner.nearest(numeric("vector", vector, ("d",), np.float32), whole("k", k))

    def distances(
        self,
        ids: Sequence[str] | None = None,
        others: Sequence[str] | None = None,
        *,
        kind: IndexDistance = "combined",
        **call: Unpack[Call],
    ) -> Floats:
        """Distances between shapes of the index, in parallel: all of them by default, else shape (len(ids), len(others)).

        Args:
            ids: Names of shapes. By default all, in the order of `shapes`.
            others: Names of other shapes. By default the same, and the matrix is symmetric.
            kind: "combined" aligns the forms of every pair; "fused" compares signatures only, and is much faster.
        """
        rows = list(self) if ids is None else [word("ids", id) for id in ids]
        with running(call):
            return self._inner.distances(rows, None if others is None else list(others), word("kind", kind))

    def surface(self, id: str, **call: Unpack[Call]) -> Surface:
        """The surface of the shape `id`. Its mesh file must be where it was, and unchanged.

        Raises `NoSuchShapeError`, `MissingFileError`, `ShapeIndexError` if the index has no such shape, or its mesh is gone or changed.
        """
        try:
            with running(call):
                return Surface._of(self._inner.surface(word("id", id)), id)
        except MissingFileError as fault:
            if f"{os.path.basename(self.path)}.meshes" not in self[id].path:
                raise
            raise MissingFileError(f"the mesh of {id!r} was in memory; build the index with keep_meshes=True to keep such meshes") from fault

    def __getitem__(self, id: str) -> ShapeEntry:
        """A shape by its name. Raises `NoSuchShapeError`."""
        return ShapeEntry(*self._inner.entry(word("id", id)))

    def duplicates(
        self,
        *,
        kinds: Iterable[RelationKind] | None = None,
        min_confidence: float = 0.9,
        keep: AnyPath = "exact",
        reference: Iterable[AnyPath] = (),
        **call: Unpack[Call],
    ) -> list[dict[str, Any]]:
        """Groups of shapes that are one: the same file or surface, in another place, size or triangulation.

        Each group has `keeper` (`id`, `path`, `bytes`, `modified`, `size`, `vertices`), `why` it is suggested, and `members`: these
        keys, and the `relation` to the shape `of`: the keeper, or a member of which it is an exact copy. It is proved by the
        triangles of both. Nothing is changed.

        Args:
            kinds: Kinds of relation, by default "identical-file", "identical-geometry", "scaled", "mirrored", "noisy" and "remeshed"; also
                "copies", "part-of", "variant" and "other-pose".
            min_confidence: The least confidence, 0 to 1.
            keep: Which file of a group is kept: "exact", "largest", "smallest", "oldest", "newest", or one in a folder.
            reference: Folders and archives from which nothing is to be removed.

        >>> cat.write("copy.ply")
        >>> index.add("copy.ply")["n_shapes"]
        10
        >>> [[member["id"] for member in group["members"]] for group in index.duplicates()], index.remove("copy")
        ([['copy']], 9)
        """
        wanted = None if kinds is None else [word("kinds", kind) for kind in ([kinds] if isinstance(kinds, str) else kinds)]
        folders = [os.fspath(path) for path in reference]
        with running(call):
            found = self._inner.duplicates(wanted, number("min_confidence", min_confidence), os.fspath(keep), folders)
        return json.loads(found)["groups"]

    def export(self, path: AnyPath, **call: Unpack[Call]) -> None:
        """Write the index to `path`, the same however it was built. The extension tells the format: jsonl, parquet, npz or csv.

        With the extension lance, write its vectors to a table as `distributed.vector_table` does.
        """
        if os.fspath(path).endswith(".lance"):
            from .distributed import vector_table

            vector_table([self.path], path, **call)
            return
        with running(call):
            self._inner.export(os.fspath(path))

    def to_pandas(self) -> pandas.DataFrame:
        """One row for each shape, with `id` as the index."""
        import pandas

        return pandas.DataFrame([vars(shape) for shape in self.shapes()]).set_index("id")

    def __len__(self) -> int:
        return self._inner.n_shapes

    def __contains__(self, id: object) -> bool:
        return isinstance(id, str) and self._inner.contains(id)

    def __iter__(self) -> Iterator[str]:
        return (shape.id for shape in self.shapes())

    def __repr__(self) -> str:
        return f"Index({self.path!r}, {len(self)} shapes)"

    def _repr_html_(self) -> str:
        info = self.info()
        classes = info["classes"]
        rows = [
            ("shapes", f"{len(self):,}"),
            ("classes", f"{len(classes)}: " + ", ".join(f"{label} {n}" for label, n in list(classes.items())[:20])),
            ("unlabelled", str(info["unlabelled"])),
            ("bytes", f"{info['n_bytes']:,}"),
        ]
        return _html.card(self.path, rows)


def _warn_of_skipped(report: dict[str, Any]) -> None:
    n, first = len(report["failed"]), next(iter(report["failed"]), None)
    if first is not None:
        message = f"{n} of the meshes are not in the index; the first, {first['path']}: {first['error']}; `build_report` lists them"
        warned(message, SkippedMeshWarning)


def none_described(name: str, failed: list[dict[str, Any]]) -> MeshError:
    """The error if none of some meshes could be described."""
    first = failed[0]["error"] if failed else "there are no meshes"
    return MeshError(f"no mesh of {name} could be described, so no index was written; the first: {first}")


def _by_name(labels: Labels | None, names: Sequence[str]) -> Mapping[str, str] | AnyPath | None:
    """Classes by name, if they are given in the order of the names."""
    if labels is None or isinstance(labels, (str, os.PathLike, Mapping)):
        return labels
    if len(labels) != len(names):
        raise OptionError(f"labels= has {len(labels)} classes for {len(names)} shapes; give one for each")
    return {name: str(label) for name, label in zip(names, labels, strict=True) if label}


@contextmanager
def in_files(meshes: Meshes, index: AnyPath, labels: Labels | None, *, keep: bool, add: bool = False) -> Iterator[_Files]:
    """Meshes as files, their classes, and those that are none. Those in memory are in a folder beside the index, as long as needed or kept."""
    if isinstance(meshes, (str, os.PathLike)):
        if labels is not None and not isinstance(labels, (str, os.PathLike, Mapping)):
            raise OptionError("labels= has no order for the meshes of a folder; give a dictionary from names to classes")
        yield meshes, labels, []
        return
    if not isinstance(meshes, Iterable):
        raise OptionError(f"meshes={meshes!r} is not possible: give a folder, paths of mesh files, or meshes with names")
    folder = f"{os.fspath(index)}.meshes"
    is_kept = keep or os.path.exists(folder)
    paths: list[AnyPath] = []
    written: list[str] = []
    known: dict[str, str] = {}
    names: list[str] = []
    failed: list[dict[str, Any]] = []
    given: list[Any] = list(meshes.items()) if isinstance(meshes, Mapping) else list(meshes)
    try:
        for i, item in enumerate(given):
            if isinstance(item, (str, os.PathLike)):
                paths.append(item)
                names.append(_stem(item))
                continue
            name, mesh, label = _named(item, i)
            if name in names:
                raise OptionError(f"two meshes have the name {name!r}")
            names.append(name)
            if label:
                known[name] = label
            try:
                written.append(_kept(_arrays(mesh), os.path.join(folder, *f"{name}.ply".split("/")), not add))
                paths.append(written[-1])
            except MeshError as fault:
                failed.append({"id": name, "path": name, "reason": "shape", "error": str(fault)})
        if known and labels is not None:
            raise OptionError("labels= has no effect for meshes that come with a class; leave one of them out")
        if failed and not paths:
            raise none_described(", ".join(names[:3]), failed)
        found: AnyPath | list[AnyPath] = paths
        if not add and paths and len(written) == len(paths):
            # As of any folder, shapes whose files are gone are removed.
            for path in set(glob.glob(f"{glob.escape(folder)}/**/*.ply", recursive=True)) - set(written):
                os.remove(path)
            found = folder
        elif deep := [name for name in names if "/" in name]:
            raise OptionError(f"the name {deep[0]!r} is not possible here: only Index.build of meshes in memory has names with folders")
        yield found, known or _by_name(labels, names), failed
    finally:
        if not is_kept:
            shutil.rmtree(folder, ignore_errors=True)


def _stem(path: AnyPath) -> str:
    return os.path.splitext(os.path.basename(os.fspath(path)).removesuffix(".gz"))[0]


def _named(item: Any, i: int) -> tuple[str, AnyMesh, str]:
    """Name, mesh and class of a mesh in memory, which has this place among others."""
    name, mesh, label = "", item, ""
    if isinstance(item, tuple) and item and isinstance(item[0], str):
        if len(item) not in (2, 3):
            raise OptionError(f"meshes[{i}] is not possible: give (name, mesh) or (name, mesh, class)")
        name, mesh, label = (*item, "")[:3]
    elif isinstance(item, Shape):
        name, label = item.name, item.label
    elif isinstance(item, Surface):
        name = _stem(item._name)
    name = name or f"mesh{i}"
    if any(part != part.strip() or not part or part.startswith(".") for part in name.split("/")) or any(c in name for c in "\\:\n\r\0"):
        raise OptionError(f"the name {name!r} is not possible: it stands for a file of this name")
    return name, mesh, label or ""


def _arrays(mesh: AnyMesh) -> tuple[Floats, Ints]:
    """The vertices and faces of a mesh as they are, without a repair."""
    mesh = Surface(mesh) if isinstance(mesh, (str, os.PathLike)) else mesh
    return mesh_of(mesh)[:2]


def _kept(mesh: tuple[Floats, Ints], path: str, replace: bool) -> str:
    """Writes a mesh for an index, unless it is there already."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    if os.path.exists(path) and not replace:
        with TemporaryDirectory() as folder:
            new = os.path.join(folder, "new.ply")
            _canonform.write(*mesh, new)
            with open(new, "rb") as one, open(path, "rb") as other:
                if one.read() != other.read():
                    raise ShapeIndexError(f"{path} has another mesh of this name; rename the new one, or pass replace=True")
        return path
    _canonform.write(*mesh, path)
    return path


def dataset_of(meshes: AnyPath | Iterable[AnyPath], folder: str) -> tuple[str, str]:
    """The path of a dataset, and what to call it: the one given, or a list file in a folder of the paths given."""
    if isinstance(meshes, (str, os.PathLike)):
        return os.fspath(meshes), os.fspath(meshes)
    paths = [os.path.abspath(path) for path in meshes]
    for path in paths:
        # A list has one path in each line, without the space around it.
        if path != path.strip() or "\n" in path or "\r" in path:
            raise OptionError(f"the path {path!r} is not possible in a list: it begins or ends with space, or has several lines")
    if not paths:
        raise OptionError("meshes=[] is not possible: give a folder, an archive, a list file, or paths of mesh files")
    name = os.path.join(folder, "meshes.txt")
    with open(name, "w", encoding="utf-8") as file:
        file.writelines(f"{path}\n" for path in paths)
    return name, f"{len(paths)} paths"


def label_file_of(labels: Labels | None, folder: str) -> str | None:
    """The word or file given, or a file in a folder with the labels given."""
    if labels is None or isinstance(labels, (str, os.PathLike)):
        return None if labels is None else os.fspath(labels)
    if not isinstance(labels, Mapping):
        raise OptionError(f"labels={labels!r} is not possible: give classes by name, in the order of the meshes, or a file")
    if not labels:
        return "none"
    for name, label in labels.items():
        if label and any(c in f"{name}{label}" for c in "\n\r"):
            raise OptionError(f"labels={{{name!r}: {label!r}}} is not possible: a line break in a name or class")
    path = os.path.join(folder, "labels.csv")
    with open(path, "w", encoding="utf-8", newline="") as file:
        csv.writer(file, quoting=csv.QUOTE_ALL).writerows([("name", "label"), *(pair for pair in labels.items() if pair[1])])
    return path
