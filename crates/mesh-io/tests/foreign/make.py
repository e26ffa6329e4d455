"""Writes the meshes in this folder with other programs: one small torus, and two copies of it.

    python -m venv venv && venv/bin/pip install trimesh lxml networkx meshio pymeshlab gmsh bpy
    venv/bin/python make.py

Versions of the committed files are in README.md.
"""

import contextlib
import importlib.metadata
import math
import os
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
MAJOR, MINOR = 8, 5


def ring():
    """The torus of `canonform_mesh::shapes::torus(8, 5, 2.0, 0.7)`."""
    vertices, faces = [], []
    for i in range(MAJOR):
        u = 2 * math.pi * i / MAJOR
        for j in range(MINOR):
            v = 2 * math.pi * j / MINOR
            r = 2.0 + 0.7 * math.cos(v)
            vertices.append((r * math.cos(u), r * math.sin(u), 0.7 * math.sin(v)))
            a, b = i * MINOR + j, (i + 1) % MAJOR * MINOR + j
            c, d = (i + 1) % MAJOR * MINOR + (j + 1) % MINOR, i * MINOR + (j + 1) % MINOR
            faces += [(a, b, c), (a, c, d)]
    return np.array(vertices), np.array(faces)


V, F = ring()
# Moved, turned and mirrored.
PLACE = np.array([[0, 1, 0, 10], [1, 0, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1.0]])


def with_trimesh():
    import trimesh

    mesh = trimesh.Trimesh(V, F, process=False)
    for extension in ["off", "obj", "ply", "stl", "glb", "3mf"]:
        mesh.export(HERE / f"trimesh-ring.{extension}")
    (HERE / "trimesh-ascii.ply").write_bytes(trimesh.exchange.ply.export_ply(mesh, encoding="ascii"))
    (HERE / "trimesh-ascii.stl").write_text(trimesh.exchange.stl.export_stl_ascii(mesh))
    scene = trimesh.Scene()
    scene.add_geometry(mesh, geom_name="ring")
    scene.graph.update(frame_to="copy", matrix=PLACE, geometry="ring")
    for extension in ["glb", "3mf"]:
        (HERE / f"trimesh-two.{extension}").write_bytes(scene.export(file_type=extension))
    for name, content in trimesh.exchange.gltf.export_gltf(scene).items():
        name = name.replace("model.gltf", "trimesh-two.gltf")
        (HERE / name).write_bytes(content)


def with_meshio():
    import meshio

    mesh = meshio.Mesh(V, [("triangle", F)])
    for extension in ["off", "obj", "ply"]:
        mesh.write(HERE / f"meshio-ring.{extension}")
    mesh.write(HERE / "meshio-ring.stl", binary=True)
    mesh.write(HERE / "meshio-ascii.stl", binary=False)
    mesh.write(HERE / "meshio-ascii.ply", binary=False)


def with_pymeshlab():
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(V, F))
    for extension in ["off", "obj", "ply", "stl", "3mf"]:
        meshes.save_current_mesh(str(HERE / f"meshlab-ring.{extension}"))


def with_gmsh():
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 0)
    gmsh.model.add("ring")
    tag = gmsh.model.addDiscreteEntity(2)
    gmsh.model.mesh.addNodes(2, tag, list(range(1, len(V) + 1)), V.ravel())
    gmsh.model.mesh.addElementsByType(tag, 2, [], (F + 1).ravel())
    gmsh.write(str(HERE / "gmsh-ring.stl"))
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(str(HERE / "gmsh-binary.stl"))
    gmsh.finalize()


def with_blender():
    import bpy
    from mathutils import Matrix

    bpy.ops.wm.read_factory_settings(use_empty=True)
    data = bpy.data.meshes.new("ring")
    data.from_pydata(V.tolist(), [], F.tolist())
    one = bpy.data.objects.new("one", data)
    bpy.context.collection.objects.link(one)
    path = lambda name: str(HERE / f"blender-{name}")
    bpy.ops.wm.obj_export(filepath=path("ring.obj"), export_materials=False)
    bpy.ops.wm.ply_export(filepath=path("ring.ply"))
    bpy.ops.wm.stl_export(filepath=path("ring.stl"))
    bpy.ops.wm.stl_export(filepath=path("ascii.stl"), ascii_format=True)
    bpy.ops.export_scene.gltf(filepath=path("ring.glb"), export_format="GLB")
    # A linked copy below an empty, a shape key, and normals that split vertices.
    empty = bpy.data.objects.new("empty", None)
    empty.rotation_euler = (0.3, 0.0, 0.0)
    two = bpy.data.objects.new("two", data)
    two.parent = empty
    two.matrix_local = Matrix(PLACE.tolist())
    for thing in [empty, two]:
        bpy.context.collection.objects.link(thing)
    one.shape_key_add(name="Basis")
    one.shape_key_add(name="wide").data[0].co.x += 1.0
    bpy.ops.export_scene.gltf(filepath=path("two.glb"), export_format="GLB")
    bpy.ops.export_scene.gltf(filepath=path("two.gltf"), export_format="GLTF_SEPARATE")
    try:
        bpy.ops.export_scene.gltf(
            filepath=path("draco.glb"), export_format="GLB", export_draco_mesh_compression_enable=True
        )
    except RuntimeError as fault:
        print(f"blender cannot write Draco: {fault}")


if __name__ == "__main__":
    programs = {
        "trimesh": with_trimesh,
        "meshio": with_meshio,
        "pymeshlab": with_pymeshlab,
        "gmsh": with_gmsh,
        "bpy": with_blender,
    }
    for name in sys.argv[1:] or programs:
        with contextlib.suppress(importlib.metadata.PackageNotFoundError):
            print(name, importlib.metadata.version(name))
        programs[name]()
    os.sync()
