//! From the nodes of a scene to one mesh.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use nalgebra::{Matrix4, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::data::{Data, part};
use super::schema::{Index, Mesh, Node, Root};
use crate::polygons::{Assembly, check_copies};
use crate::prelude::*;

const TRIANGLES: u32 = 4;
const STRIP: u32 = 5;
const FAN: u32 = 6;

/// Puts the instances of the default scene together.
pub(super) fn read<'a>(data: &'a Data<'_>, limits: &'a ReadLimits) -> Result<Assembly<'a>, Located> {
    let root = data.root;
    let mut scene =
        Scene { assembly: Assembly::new(limits, data.n_bytes), meshes: HashMap::new(), data, limits };
    if root.nodes.is_empty() {
        (0..root.meshes.len()).try_for_each(|number| scene.append(number, &Matrix4::identity()))?;
        return Ok(scene.assembly);
    }
    let mut visited = vec![false; root.nodes.len()];
    let mut open: Vec<(Index, Matrix4<f64>)> = Vec::new();
    open.extend(roots(root)?.into_iter().rev().map(|node| (node, Matrix4::identity())));
    while let Some((number, above)) = open.pop() {
        let node = part(&root.nodes, "node", number)?;
        if std::mem::replace(&mut visited[number], true) {
            let found = "a node with several parents, or among its own children";
            return Err(Fault::syntax("a tree of nodes", found).in_part("node", number));
        }
        if node.is_hidden() {
            continue;
        }
        let here = above * transform(node);
        if let Some(mesh) = node.mesh {
            scene.append(mesh, &node.skin.map_or(here, |_| Matrix4::identity()))?;
        }
        open.extend(node.children.iter().rev().map(|child| (*child, here)));
    }
    Ok(scene.assembly)
}

/// The nodes at the top of the default scene, else of the first; of a file without scenes, all that are not children.
fn roots(root: &Root) -> Result<Vec<Index>, Located> {
    if let Some(scene) = root.scene.or((!root.scenes.is_empty()).then_some(0)) {
        return Ok(part(&root.scenes, "scene", scene)?.nodes.clone());
    }
    let mut tops = vec![true; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| &node.children) {
        tops.get_mut(*child).into_iter().for_each(|is_top| *is_top = false);
    }
    Ok((0..tops.len()).filter(|node| tops[*node]).collect())
}

fn transform(node: &Node) -> Matrix4<f64> {
    if let Some(matrix) = node.matrix {
        return Matrix4::from_column_slice(&matrix.map(f64::from));
    }
    let [x, y, z] = node.translation.unwrap_or_default().map(f64::from);
    let [i, j, k, w] = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]).map(f64::from);
    let scale = Vector3::from(node.scale.unwrap_or([1.0; 3]).map(f64::from));
    // In the file the quaternion has 32 bits, or is not exactly of length one.
    let turn = match [i, j, k] {
        [0.0, 0.0, 0.0] => Matrix4::identity(),
        _ => UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)).to_homogeneous(),
    };
    Translation3::new(x, y, z).to_homogeneous() * turn * Matrix4::new_nonuniform_scaling(&scale)
}

/// What has to do with the shape and is ignored.
pub(super) fn ignored(root: &Root) -> Vec<&'static str> {
    let primitives = || root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let has_others = primitives().any(|primitive| primitive.mode.is_some_and(|mode| mode < TRIANGLES));
    [
        (root.scenes.len() > 1, "all scenes but the default one"),
        (root.nodes.iter().any(|node| node.skin.is_some()), "skins: meshes are in their bind pose"),
        (primitives().any(|primitive| !primitive.targets.is_empty()), "morph targets"),
        (!root.animations.is_empty(), "animations"),
        (root.nodes.iter().any(Node::is_hidden), "hidden nodes"),
        (has_others, "points and lines"),
    ]
    .into_iter()
    .filter_map(|(is_ignored, what)| is_ignored.then_some(what))
    .collect()
}

/// The scene so far.
struct Scene<'a> {
    assembly: Assembly<'a>,
    /// The meshes of the file, each decoded once.
    meshes: HashMap<Index, TriMesh>,
    data: &'a Data<'a>,
    limits: &'a ReadLimits,
}

impl Scene<'_> {
    /// Appends an instance of a mesh.
    fn append(&mut self, number: Index, place: &Matrix4<f64>) -> Result<(), Located> {
        let shape = match self.meshes.entry(number) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                let mesh = part(&self.data.root.meshes, "mesh", number)?;
                new.insert(decode(mesh, self.data, self.limits)?)
            }
        };
        self.assembly.append(shape, place).in_part("mesh", number)
    }
}

/// The vertices and faces of a mesh before it is placed.
fn decode(mesh: &Mesh, data: &Data<'_>, limits: &ReadLimits) -> Result<TriMesh, Located> {
    let mut shape = TriMesh::default();
    // Where the vertices of an accessor begin, and their number.
    let mut known: HashMap<Index, (usize, usize)> = HashMap::new();
    for primitive in &mesh.primitives {
        let mode = primitive.mode.unwrap_or(TRIANGLES);
        if mode > FAN {
            return Err(Fault::syntax("the mode of a primitive, 0 to 6", "another number").whole());
        }
        let position = primitive.attributes.get("POSITION").copied();
        let Some(position) = position.filter(|_| mode >= TRIANGLES) else { continue };
        let (start, count) = match known.entry(position) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => {
                let start = shape.n_vertices();
                let whole = (start as u64).saturating_add(data.len(position)?);
                limits.check(whole, 0).in_part("accessor", position)?;
                shape.positions.extend(data.positions(position)?);
                *new.insert((start, shape.n_vertices() - start))
            }
        };
        let corners = match primitive.indices {
            Some(index) => data.indices(index, count)?,
            None => (0..count as u32).collect(),
        };
        let accessor = primitive.indices.unwrap_or(position);
        push_faces(mode, &corners, start as u32, &mut shape.faces).in_part("accessor", accessor)?;
        let (n_vertices, n_faces) = (shape.n_vertices() as u64, shape.n_faces() as u64);
        limits.check(n_vertices, n_faces).in_part("accessor", accessor)?;
        check_copies(n_faces, data.n_bytes).in_part("accessor", accessor)?;
    }
    Ok(shape)
}

/// Appends the triangles of a list, a strip or a fan. Triangles that only join pieces of a strip are left out.
fn push_faces(mode: u32, corners: &[u32], start: u32, faces: &mut Vec<[VertexId; 3]>) -> Result<(), Fault> {
    let mut push = |face: [u32; 3]| faces.push(face.map(|v| VertexId(v + start)));
    match (mode, corners) {
        (STRIP, _) => {
            for (i, triple) in corners.windows(3).enumerate() {
                let [a, b, c] = [triple[0], triple[1 + i % 2], triple[2 - i % 2]];
                if a != b && b != c && c != a {
                    push([a, b, c]);
                }
            }
        }
        (FAN, [apex, rim @ ..]) => rim.windows(2).for_each(|edge| push([edge[0], edge[1], *apex])),
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
