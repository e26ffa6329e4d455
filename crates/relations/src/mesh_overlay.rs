//! Two meshes laid over each other in space.

use mesh::TriMesh;
use nalgebra::Point3;

use super::exact::same_vertices;
use super::geometry::MeshGeometry;
use super::{Relation, RelationKind};

/// Two meshes laid over each other by the best motion, reflection and change of size, at the size of the first and in its
/// units.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshOverlay {
    /// The meshes, without repeated positions, degenerate and duplicate faces and unused vertices.
    pub meshes: [TriMesh; 2],
    /// For every vertex of either mesh, its distance from the surface of the other.
    pub gaps: [Vec<f64>; 2],
}

impl Relation {
    /// The meshes, for which this relation was found, laid over each other, if they are alike as rigid bodies: one surface, at any size or mirrored, or variants of a part.
    ///
    /// ```
    /// use canonform_relations::{MeshGeometry, Relation};
    /// use descriptors::ShapeDistance;
    /// use mesh::shapes;
    /// use rigid::Handedness;
    ///
    /// let (ring, ball) = (shapes::torus(24, 12, 2.0, 0.7), shapes::icosphere(2));
    /// let [a, b, c] = [&ring, &shapes::subdivide(&ring), &ball].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
    /// let found = Relation::by_distance(ShapeDistance { fused: 0.1, combined: 0.1 }, 1.0, Handedness::Unknown);
    /// let overlay = found.clone().by_meshes([&a, &b]).overlay([&a, &b]).unwrap();
    /// assert!(overlay.gaps.iter().flatten().all(|gap| *gap < 1e-3));
    /// assert!(found.by_meshes([&a, &c]).overlay([&a, &c]).is_none());
    /// ```
    pub fn overlay(&self, [a, b]: [&MeshGeometry; 2]) -> Option<MeshOverlay> {
        if !(self.kind.is_one_surface() || self.kind == RelationKind::Variant) {
            return None;
        }
        let map = self.map.or_else(|| same_vertices(a, b).map(|same| same.map))?;
        // The map leads to the second mesh at unit area.
        let size = a.size() / map.scale;
        let laid = |mesh: &TriMesh, place: &dyn Fn(&Point3<f64>) -> Point3<f64>| TriMesh {
            positions: mesh.positions.iter().map(|p| place(p) * size).collect(),
            faces: mesh.faces.clone(),
        };
        let meshes = [laid(a.mesh(), &|p| map.apply(p)), laid(b.mesh(), &|p| *p)];
        let gaps = [(a, b, map, size), (b, a, map.inverse(), a.size())].map(|(from, to, map, size)| {
            let near = from.mesh().positions.iter().map(|p| to.surface.tree().nearest(&map.apply(p)));
            near.map(|near| near.map_or(f64::NAN, |near| near.sq_distance.sqrt() * size)).collect()
        });
        Some(MeshOverlay { meshes, gaps })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Vector3};

    use super::*;
    use crate::tests::related;
    use mesh::shapes::lopsided_torus;

    #[test]
    fn copies_coincide_at_the_size_of_the_first() {
        let mesh = lopsided_torus();
        let turn = Rotation3::from_euler_angles(0.3, 2.0, -1.0);
        for (scale, flip) in [(1.0, 1.0), (25.4, 1.0), (0.5, -1.0)] {
            let mut other = mesh::shapes::subdivide(&mesh);
            other.positions.iter_mut().for_each(|p| {
                *p = turn * Point3::new(flip * p.x, p.y, p.z) * scale + Vector3::new(5.0, 2.0, 3.0);
            });
            for other in [
                &other,
                &TriMesh { positions: other.positions[..mesh.n_vertices()].to_vec(), ..mesh.clone() },
            ] {
                let [a, b] = [&mesh, other].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
                let found = related(&a, &b).overlay([&a, &b]).unwrap();
                let most = found.gaps.iter().flatten().copied().fold(0.0, f64::max);
                assert!(most < 1e-3 * a.size(), "{scale} {flip}: {most}");
                for laid in &found.meshes {
                    assert!((laid.root_of_area() / a.size() - 1.0).abs() < 1e-3);
                }
            }
        }
    }
}
