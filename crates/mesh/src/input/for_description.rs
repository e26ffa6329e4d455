//! The mesh on which a surface is measured for its description.

use std::borrow::Cow;

use base::{Budget, Exceeded, Observer};

use super::surface::Surface;
use crate::holes::fill_holes;
use crate::noise::denoise;
use crate::refine::refine;
use crate::shortcuts::cut_shortcuts;

/// Longest edge, relative to the square root of the area. Equilateral triangles of this size have about 720 vertices.
///
/// Errors of the spectrum and of distances fall with the square of the edge length, and the cost of a description rises with
/// the number of vertices. On built-in creatures of 1,000 vertices, subdivision changes the combined distance by 0.29 in the
/// median, and by 0.14 with 0.03, which costs 1.6 times as much; other shapes are several units apart.
const LONGEST: f64 = 0.04;

/// The same for meshes of fewer vertices than [`FEW`], which splitting edges in halves would otherwise refine to 2,000 vertices: a
/// square with its diagonals has edges of both lengths.
const LONGEST_OF_FEW: f64 = LONGEST * std::f64::consts::SQRT_2;

/// Meshes of fewer vertices are blocks rather than bodies.
const FEW: usize = 100;

/// Longest boundary of a hole that is closed, relative to the square root of the area. A round hole of this length has 8 %
/// of the area; those of scans have jagged boundaries, or reach around limbs. The rim of a cup is longer.
const LONGEST_HOLE: f64 = 1.0;

/// The same if the surface may be a part of a shape, so that longer boundaries may be cuts. Rims of cut limbs are longer, holes
/// of scans mostly shorter.
const LONGEST_HOLE_OF_PART: f64 = 0.15;

/// Most vertices that are added. Needles could need any number.
const MOST: usize = 10_000;

impl Surface {
    /// The surface that is described: without [shortcuts](crate::cut_shortcuts) and
    /// [noise](crate::denoise), with small [holes](crate::fill_holes) closed and long edges split. Coarse meshes are then
    /// measured as accurately as fine ones, and neither subdivision, noise, small holes nor a weld of two parts that touch
    /// change much. The first vertices are those of the repaired mesh, and so are the links. A mesh without such damage
    /// stays the same surface.
    ///
    /// ```
    /// use canonform_mesh::{Surface, shapes};
    ///
    /// let coarse = Surface::new(&shapes::icosphere(2), &Default::default(), &())?;
    /// let fine = coarse.for_description(&())?;
    /// assert!(fine.mesh().n_vertices() > 1000);
    /// assert!((fine.mesh().area() / coarse.mesh().area() - 1.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Exceeded`].
    pub fn for_description(&self, observer: &dyn Observer) -> Result<Self, Exceeded> {
        self.prepared(LONGEST_HOLE, &observer.budget())
    }

    /// The surface that is described as a part: as [`for_description`](Self::for_description), but its long boundaries stay.
    ///
    /// # Errors
    /// [`Exceeded`].
    pub fn for_part(&self, observer: &dyn Observer) -> Result<Self, Exceeded> {
        self.prepared(LONGEST_HOLE_OF_PART, &observer.budget())
    }

    fn prepared(&self, longest_hole: f64, budget: &Budget) -> Result<Self, Exceeded> {
        let topology = self.intrinsic().topology();
        let opened = cut_shortcuts(self.mesh(), topology, budget)?;
        let topology = match opened.cut.remap.is_identity() {
            true => Cow::Borrowed(topology),
            false => Cow::Owned(opened.cut.mesh.topology()),
        };
        let smooth = denoise(&opened.cut.mesh, &topology);
        let mesh = smooth.as_ref().unwrap_or(&opened.cut.mesh);
        let size = mesh.root_of_area();
        if size.is_nan() || size <= 0.0 {
            return Ok(self.clone());
        }
        let filled = fill_holes(mesh, &topology, longest_hole * size);
        let longest = if mesh.n_vertices() < FEW { LONGEST_OF_FEW } else { LONGEST };
        let fine = refine(&filled.mesh, longest * size, mesh.n_vertices() + MOST);
        let made = opened.cut.then(filled).then(fine);
        Ok(match smooth.is_some() || !made.remap.is_identity() {
            true => self.with_mesh(made, opened.shortcuts),
            false => self.clone(),
        })
    }
}
