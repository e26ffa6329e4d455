//! From the nodes of a scene to one mesh.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use nalgebra::{Matrix4, Quaternion, Translation3, UnitQuaternion, Vector3};
use surface::VertexId;

use super::accessors::Accessors;
use super::container::missing;
use super::schema::{Index, Mesh, Mode, Node, Primitive, Root};
use crate::limits::ReadLimits;
use crate::located::{At, Located};
use crate::polygons::{Placement, append_placed, check_copies, placed_by, placed_within};
use mesh::Fault;
use mesh::TriMesh;

/// Puts the instances of the default scene together; also returns their number.
pub(super) fn read(accessors: &Accessors<'_>, limits: &ReadLimits) -> Result<(TriMesh, usize), Located> {
    let root = accessors.root;
    let mut scene =
        Scene { whole: TriMesh::default(), instances: 0, meshes: HashMap::new(), accessors, limits };
    if root.nodes.is_empty() {
        (0..root.meshes.len()).try_for_each(|number| scene.append(number, None))?;
        return Ok((scene.whole, scene.instances));
    }
    let mut visited = vec![false; root.nodes.len()];
    let mut open: Vec<(Index, Placement)> = Vec::new();
    open.extend(roots(root)?.into_iter().rev().map(|node| (node, None)));
    while let Some((number, above)) = open.pop() {
        let node = root.nodes.get(number).ok_or_else(|| missing("node", number, root.nodes.len()))?;
        if std::mem::replace(&mut visited[number], true) {
            let found = "a node with several parents, or among its own children";
            return Err(Fault::syntax("a tree of nodes", found).in_part("node", number));
        }
        if node.is_hidden() {
            continue;
        }
        let here = placed_within(above, transform(node));
        if let Some(mesh) = node.mesh {
            scene.append(mesh, here.filter(|_| node.skin.is_none()))?;
        }
        open.extend(node.children.iter().rev().map(|child| (*child, here)));
    }
    Ok((scene.whole, scene.instances))
}

/// The nodes at the top of the default scene, else of the first; of a file without scenes, all that are not children.
fn roots(root: &Root) -> Result<Vec<Index>, Located> {
    if let Some(index) = root.scene {
        let count = root.scenes.len();
        let scene = root.scenes.get(index).ok_or_else(|| missing("scene", index, count))?;
        return Ok(scene.nodes.clone());
    }
    if let Some(scene) = root.scenes.first() {
        return Ok(scene.nodes.clone());
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_child) = is_child.get_mut(*child) {
            *is_child = true;
        }
    }
    Ok((0..root.nodes.len()).filter(|node| !is_child[*node]).collect())
}

/// The transform of a node; `None` if it changes nothing.
fn transform(node: &Node) -> Placement {
    if let Some(matrix) = node.matrix {
        return placed_by(Matrix4::from_column_slice(&matrix.map(f64::from)));
    }
    if node.translation.is_none() && node.rotation.is_none() && node.scale.is_none() {
        return None;
    }
    let [x, y, z] = node.translation.unwrap_or([0.0; 3]).map(f64::from);
    let [i, j, k, w] = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |rotation| rotation.map(f64::from));
    let scale = Vector3::from(node.scale.unwrap_or([1.0; 3]).map(f64::from));
    // In the file the quaternion has 32 bits, or is not exactly of length one.
    let turn = match [i, j, k] {
        [0.0, 0.0, 0.0] => Matrix4::identity(),
        _ => UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)).to_homogeneous(),
    };
    placed_by(Translation3::new(x, y, z).to_homogeneous() * turn * Matrix4::new_nonuniform_scaling(&scale))
}

/// What has to do with the shape and is ignored.
pub(super) fn ignored(root: &Root) -> Vec<&'static str> {
    let primitives = || root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let is_used = |what: bool, words| what.then_some(words);
    let no_faces = |primitive: &Primitive| !is_of_faces(primitive.mode);
    [
        is_used(root.scenes.len() > 1, "all scenes but the default one"),
        is_used(root.nodes.iter().any(|node| node.skin.is_some()), "skins: meshes are in their bind pose"),
        is_used(primitives().any(|p| !p.targets.is_empty()), "morph targets"),
        is_used(!root.animations.is_empty(), "animations"),
        is_used(root.nodes.iter().any(Node::is_hidden), "hidden nodes"),
        is_used(primitives().any(no_faces), "points and lines"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn is_of_faces(mode: Mode) -> bool {
    matches!(mode, Mode::Triangles | Mode::Strip | Mode::Fan)
}

/// The scene so far.
struct Scene<'a> {
    whole: TriMesh,
    /// Nodes with a mesh.
    instances: usize,
    /// The meshes of the file, each decoded once.
    meshes: HashMap<Index, TriMesh>,
    accessors: &'a Accessors<'a>,
    limits: &'a ReadLimits,
}

impl Scene<'_> {
    /// Appends an instance of a mesh.
    fn append(&mut self, number: Index, place: Placement) -> Result<(), Located> {
        let at = |fault: Fault| fault.in_part("mesh", number);
        let part = match self.meshes.entry(number) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                let meshes = &self.accessors.root.meshes;
                let mesh = meshes.get(number).ok_or_else(|| missing("mesh", number, meshes.len()))?;
                new.insert(decode(mesh, self.accessors, self.limits)?)
            }
        };
        let n_vertices = (self.whole.n_vertices() + part.n_vertices()) as u64;
        let n_faces = (self.whole.n_faces() + part.n_faces()) as u64;
        self.limits.check(n_vertices, n_faces).map_err(at)?;
        if self.instances > 0 {
            check_copies(n_vertices + n_faces, self.accessors.n_bytes).map_err(at)?;
        }
        self.instances += 1;
        append_placed(&mut self.whole, part, place).map_err(at)
    }
}

/// The vertices and faces of a mesh before it is placed.
fn decode(mesh: &Mesh, accessors: &Accessors<'_>, limits: &ReadLimits) -> Result<TriMesh, Located> {
    let mut shape = TriMesh::default();
    // Where the vertices of an accessor begin, and their number.
    let mut known: HashMap<Index, (usize, usize)> = HashMap::new();
    for primitive in &mesh.primitives {
        let mode = primitive.mode;
        if let Mode::Unknown = mode {
            return Err(Fault::syntax("the mode of a primitive, 0 to 6", "another number").whole());
        }
        let position = primitive.attributes.get("POSITION").copied();
        let Some(position) = position.filter(|_| is_of_faces(mode)) else { continue };
        let (start, count) = match known.entry(position) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => {
                let start = shape.n_vertices();
                let whole = (start as u64).saturating_add(accessors.len(position)?);
                limits.check(whole, 0).map_err(|fault| fault.in_part("accessor", position))?;
                shape.positions.extend(accessors.positions(position)?);
                *new.insert((start, shape.n_vertices() - start))
            }
        };
        let corners = match primitive.indices {
            Some(index) => accessors.indices(index, count)?,
            None => (0..count as u32).collect(),
        };
        let at = |fault: Fault| fault.in_part("accessor", primitive.indices.unwrap_or(position));
        push_faces(mode, &corners, start as u32, &mut shape.faces).map_err(at)?;
        let (n_vertices, n_faces) = (shape.n_vertices() as u64, shape.n_faces() as u64);
        limits.check(n_vertices, n_faces).map_err(at)?;
        check_copies(n_faces, accessors.n_bytes).map_err(at)?;
    }
    Ok(shape)
}

/// Appends the triangles of a list, a strip or a fan. Triangles that only join pieces of a strip are left out.
fn push_faces(mode: Mode, corners: &[u32], start: u32, faces: &mut Vec<[VertexId; 3]>) -> Result<(), Fault> {
    let mut push = |face: [u32; 3]| faces.push(face.map(|v| VertexId(v + start)));
    match mode {
        Mode::Strip => {
            for (i, triple) in corners.windows(3).enumerate() {
                let [a, b, c] = [triple[0], triple[1 + i % 2], triple[2 - i % 2]];
                if a != b && b != c && c != a {
                    push([a, b, c]);
                }
            }
        }
        Mode::Fan => {
            if let Some((apex, rim)) = corners.split_first() {
                rim.windows(2).for_each(|edge| push([edge[0], edge[1], *apex]));
            }
        }
        _ => {
            let (triples, rest) = corners.as_chunks();
            if !rest.is_empty() {
                let found = format!("{} indices", corners.len());
                return Err(Fault::syntax("three indices for each triangle", found));
            }
            triples.iter().for_each(|triple| push(*triple));
        }
    }
    Ok(())
}
