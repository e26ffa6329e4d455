//! A mesh that distances can be measured on.

use std::path::Path;
use std::time::Instant;

use nalgebra::Point3;

use mesh::{RepairOptions, Repaired, TriMesh, io, repair};
use surface::{IntrinsicMesh, VertexId};

use crate::PipelineError;

/// A repaired mesh, its intrinsic geometry, and the way back to the vertices of the input.
#[derive(Debug, Clone)]
pub struct Surface {
    /// The repaired mesh, the report on it, and where each input vertex went.
    pub repaired: Repaired,
    /// Connectivity and edge lengths of the repaired mesh, with its bridges.
    pub intrinsic: IntrinsicMesh,
    /// The faces of the input, over the vertices of the input.
    pub input_faces: Vec<[VertexId; 3]>,
    /// For every vertex of the repaired mesh the first input vertex that became it.
    input_vertex: Vec<VertexId>,
    /// Seconds to read the file; zero for a mesh in memory.
    pub load_seconds: f64,
    /// Seconds to repair it and to build the connectivity.
    pub repair_seconds: f64,
}

impl Surface {
    /// Reads and repairs a mesh file.
    ///
    /// # Errors
    /// [`PipelineError::Mesh`].
    pub fn read(path: &Path, options: &RepairOptions) -> Result<Self, PipelineError> {
        let start = Instant::now();
        let mesh = io::read(path)?;
        let load_seconds = start.elapsed().as_secs_f64();
        Ok(Self { load_seconds, ..Self::new(&mesh, options)? })
    }

    /// Repairs a mesh in memory.
    ///
    /// # Errors
    /// [`PipelineError::Mesh`].
    pub fn new(mesh: &TriMesh, options: &RepairOptions) -> Result<Self, PipelineError> {
        let start = Instant::now();
        let repaired = repair(mesh, options)?;
        let intrinsic = repaired.intrinsic();
        let mut input_vertex = vec![VertexId(u32::MAX); repaired.mesh.n_vertices()];
        for (input, vertex) in repaired.input_to_repaired.iter().enumerate().rev() {
            if let Some(vertex) = vertex {
                input_vertex[vertex.index()] = VertexId::from(input);
            }
        }
        Ok(Self {
            repaired,
            intrinsic,
            input_faces: mesh.faces.clone(),
            input_vertex,
            load_seconds: 0.0,
            repair_seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// The repaired mesh.
    #[must_use]
    pub fn mesh(&self) -> &TriMesh {
        &self.repaired.mesh
    }

    /// Number of vertices of the input.
    #[must_use]
    pub fn n_input_vertices(&self) -> usize {
        self.repaired.input_to_repaired.len()
    }

    /// Where an input vertex is in the repaired mesh.
    ///
    /// # Errors
    /// [`PipelineError::NoSuchVertex`] and [`PipelineError::DroppedVertex`].
    pub fn repaired_vertex(&self, input: VertexId) -> Result<VertexId, PipelineError> {
        let n_vertices = self.n_input_vertices();
        let found = self.repaired.input_to_repaired.get(input.index());
        found
            .ok_or(PipelineError::NoSuchVertex { vertex: input, n_vertices })?
            .ok_or(PipelineError::DroppedVertex { vertex: input })
    }

    /// The first input vertex that became this vertex of the repaired mesh.
    #[must_use]
    pub fn input_vertex(&self, vertex: VertexId) -> VertexId {
        self.input_vertex[vertex.index()]
    }

    /// The input's faces over new positions of its vertices. Vertices that the repair left out have no
    /// position: they are left out here too, with the faces that name them.
    #[must_use]
    pub fn with_positions(&self, positions: &[Point3<f64>]) -> TriMesh {
        let to_repaired = &self.repaired.input_to_repaired;
        let mut number = vec![None; to_repaired.len()];
        let mut kept = Vec::with_capacity(to_repaired.len());
        for (input, vertex) in to_repaired.iter().enumerate() {
            if let Some(vertex) = vertex {
                number[input] = Some(VertexId::from(kept.len()));
                kept.push(positions[vertex.index()]);
            }
        }
        let renumbered = |face: &[VertexId; 3]| {
            let [a, b, c] = face.map(|v| number[v.index()]);
            Some([a?, b?, c?])
        };
        TriMesh { positions: kept, faces: self.input_faces.iter().filter_map(renumbered).collect() }
    }

    /// Values of the repaired vertices, in the order of the input; `missing` where a vertex was left out.
    #[must_use]
    pub fn in_input_order<T: Copy>(&self, values: &[T], missing: T) -> Vec<T> {
        let value = |vertex: &Option<VertexId>| vertex.map_or(missing, |v| values[v.index()]);
        self.repaired.input_to_repaired.iter().map(value).collect()
    }
}
