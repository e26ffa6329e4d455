//! From the nodes of a scene to one mesh.

use std::collections::HashMap;

use nalgebra::{Matrix4, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use surface::VertexId;

use super::accessors::Accessors;
use super::container::missing;
use super::schema::{Index, Mesh, Mode, Node, Primitive, Root};
use crate::error::{Fault, Located, Place};
use crate::io::limits::ReadLimits;
use crate::io::polygons::{append_placed, check_copies};

/// What a scene consists of.
#[derive(Default)]
pub(super) struct Scene {
    pub(super) positions: Vec<Point3<f64>>,
    pub(super) faces: Vec<[VertexId; 3]>,
    /// Nodes with a mesh.
    pub(super) instances: usize,
}

/// Puts the instances of the default scene together.
pub(super) fn read(
    root: &Root,
    accessors: &Accessors<'_>,
    n_bytes: u64,
    limits: &ReadLimits,
) -> Result<Scene, Located> {
    let mut scene = Scene::default();
    let mut meshes = Meshes { root, accessors, known: HashMap::new(), n_bytes, limits };
    if root.nodes.is_empty() {
        for number in 0..root.meshes.len() {
            meshes.append(number, None, &mut scene)?;
        }
        return Ok(scene);
    }
    let mut visited = vec![false; root.nodes.len()];
    let mut open: Vec<(Index, Option<Matrix4<f64>>)> = Vec::new();
    open.extend(roots(root)?.into_iter().rev().map(|node| (node, None)));
    while let Some((number, above)) = open.pop() {
        let node = root.nodes.get(number).ok_or_else(|| missing("node", number, root.nodes.len()))?;
        if std::mem::replace(&mut visited[number], true) {
            let found = "a node with several parents, or among its own children".to_owned();
            return Err(Fault::Syntax { expected: "a tree of nodes", found }.at(Place::Part("node", number)));
        }
        let here = match (above, transform(node)) {
            (Some(above), Some(own)) => Some(above * own),
            (above, own) => above.or(own),
        };
        if let Some(mesh) = node.mesh {
            let place = if node.skin.is_some() { None } else { here };
            meshes.append(mesh, place, &mut scene)?;
        }
        open.extend(node.children.iter().rev().map(|child| (*child, here)));
    }
    Ok(scene)
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
fn transform(node: &Node) -> Option<Matrix4<f64>> {
    if let Some(matrix) = node.matrix {
        let matrix = Matrix4::from_column_slice(&matrix.map(f64::from));
        return (matrix != Matrix4::identity()).then_some(matrix);
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
    let matrix = Translation3::new(x, y, z).to_homogeneous() * turn * Matrix4::new_nonuniform_scaling(&scale);
    (matrix != Matrix4::identity()).then_some(matrix)
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
        is_used(primitives().any(no_faces), "points and lines"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn is_of_faces(mode: Mode) -> bool {
    matches!(mode, Mode::Triangles | Mode::Strip | Mode::Fan)
}

/// The vertices and faces of a mesh before it is placed.
#[derive(Default)]
struct Shape {
    positions: Vec<Point3<f64>>,
    faces: Vec<[u32; 3]>,
}

/// The meshes of the file, each decoded once.
struct Meshes<'a> {
    root: &'a Root,
    accessors: &'a Accessors<'a>,
    known: HashMap<usize, Shape>,
    n_bytes: u64,
    limits: &'a ReadLimits,
}

impl Meshes<'_> {
    /// Appends an instance of a mesh.
    fn append(
        &mut self,
        number: Index,
        place: Option<Matrix4<f64>>,
        scene: &mut Scene,
    ) -> Result<(), Located> {
        let at = |fault: Fault| fault.at(Place::Part("mesh", number));
        if !self.known.contains_key(&number) {
            let mesh = self
                .root
                .meshes
                .get(number)
                .ok_or_else(|| missing("mesh", number, self.root.meshes.len()))?;
            let shape = self.decode(mesh)?;
            self.known.insert(number, shape);
        }
        let Some(shape) = self.known.get(&number) else { return Ok(()) };
        let vertices = (scene.positions.len() + shape.positions.len()) as u64;
        let faces = (scene.faces.len() + shape.faces.len()) as u64;
        self.limits.check(vertices, faces).map_err(at)?;
        if scene.instances > 0 {
            check_copies(vertices + faces, self.n_bytes).map_err(at)?;
        }
        append_placed(&shape.positions, &shape.faces, place.as_ref(), &mut scene.positions, &mut scene.faces)
            .map_err(at)?;
        scene.instances += 1;
        Ok(())
    }

    fn decode(&self, mesh: &Mesh) -> Result<Shape, Located> {
        let mut shape = Shape::default();
        let mut starts: HashMap<usize, (usize, usize)> = HashMap::new();
        for primitive in &mesh.primitives {
            let mode = primitive.mode;
            if let Mode::Unknown = mode {
                let found = "another number".to_owned();
                return Err(Fault::Syntax { expected: "the mode of a primitive, 0 to 6", found }.whole());
            }
            let position = primitive.attributes.get("POSITION").copied();
            let Some(position) = position.filter(|_| is_of_faces(mode)) else { continue };
            let (start, count) = match starts.get(&position) {
                Some(known) => *known,
                None => {
                    let start = shape.positions.len();
                    let count = self.accessors.len(position)?;
                    let at = Place::Part("accessor", position);
                    let whole = (start as u64).saturating_add(count);
                    self.limits.check(whole, 0).map_err(|fault| fault.at(at))?;
                    shape.positions.extend(self.accessors.positions(position)?.into_iter().map(Point3::from));
                    let count = shape.positions.len() - start;
                    starts.insert(position, (start, count));
                    (start, count)
                }
            };
            let (corners, at) = match primitive.indices {
                Some(index) => (self.accessors.indices(index, count)?, Place::Part("accessor", index)),
                None => ((0..count as u32).collect(), Place::Part("accessor", position)),
            };
            push_faces(mode, &corners, start as u32, &mut shape.faces).map_err(|fault| fault.at(at))?;
            let (vertices, faces) = (shape.positions.len() as u64, shape.faces.len() as u64);
            self.limits.check(vertices, faces).map_err(|fault| fault.at(at))?;
            check_copies(faces, self.n_bytes).map_err(|fault| fault.at(at))?;
        }
        Ok(shape)
    }
}

/// Appends the triangles of a list, a strip or a fan. Triangles that only join pieces of a strip are left out.
fn push_faces(mode: Mode, corners: &[u32], start: u32, faces: &mut Vec<[u32; 3]>) -> Result<(), Fault> {
    let mut push = |face: [u32; 3]| faces.push(face.map(|v| v + start));
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
                return Err(Fault::Syntax { expected: "three indices for each triangle", found });
            }
            triples.iter().for_each(|triple| push(*triple));
        }
    }
    Ok(())
}
