//! Topological shortcuts: places where two distant parts of a surface touch and became one.
//!
//! Scanners and reconstruction weld a hand to the hip that it touches. Paths through the contact are much shorter than those
//! of the true surface, so distances all over the shape change. A contact in one vertex is a *pinch*, a wider one a *handle*
//! whose girth is small beside the surfaces that it joins (topological noise, Guskov and Wood 2001, `guskov2001`).

mod handle;
mod pinch;
mod shortcut;
mod spike;

use std::borrow::Cow;
use std::cell::OnceCell;

use base::{Exceeded, Observer};
use surface::Topology;

use crate::regions::SmoothRegions;
use crate::tri_mesh::TriMesh;
use shortcut::MOST;

pub use shortcut::{CutSurface, Shortcut, ShortcutKind};

/// Cuts the shortcuts of a surface between points that are otherwise at least 0.3 times the square root of the area apart:
/// shared vertices get a copy for each part of the surface, handles are cut along the shortest loop around them, which leaves
/// two holes for [`fill_holes`](crate::fill_holes).
///
/// The surface stays in one piece: a vertex that is the only connection of two parts stays shared. A handle is a shortcut if
/// it is narrow, at most 0.3 times the square root of the area around, and the surface widens on both sides of its narrowest
/// place, which the tube of a ring or of the handle of a cup does not. Edges of more than two faces stay, and so do all handles of a
/// surface with such edges and of a [mechanical part](crate::SmoothRegions).
///
/// # Errors
/// [`Exceeded`] if the time of the budget is over or it was cancelled.
///
/// ```
/// use canonform_mesh::{cut_shortcuts, shapes, validate};
/// use surface::VertexId;
///
/// // Two opposite vertices of a ball become one.
/// let mut ball = shapes::icosphere(3);
/// let far = (0..ball.n_vertices()).min_by(|&a, &b| {
///     let height = |v: usize| (ball.positions[v] + ball.positions[0].coords).coords.norm();
///     height(a).total_cmp(&height(b))
/// });
/// let far = VertexId::from(far.unwrap());
/// ball.faces.iter_mut().flatten().filter(|v| **v == far).for_each(|v| *v = VertexId(0));
/// let opened = cut_shortcuts(&ball, &ball.topology(), &())?;
/// assert_eq!(opened.shortcuts.len(), 1);
/// assert!(opened.shortcuts[0].detour > 2.5);
/// assert_eq!(validate(&opened.cut.mesh).non_manifold_vertices, 0);
/// # Ok::<(), base::Exceeded>(())
/// ```
pub fn cut_shortcuts(
    mesh: &TriMesh,
    topology: &Topology,
    observer: &dyn Observer,
) -> Result<CutSurface, Exceeded> {
    let budget = &observer.budget();
    let size = mesh.root_of_area();
    let mut opened = pinch::cut(mesh, topology, DETOUR * size);
    let mut topology = Cow::Borrowed(topology);
    // The holes of a part that is made of planes and cylinders are meant. Few surfaces have handles, so that only theirs are
    // looked at.
    let is_mechanical = OnceCell::new();
    loop {
        if !opened.cut.remap.is_identity() {
            topology = Cow::Owned(opened.cut.mesh.topology());
        }
        let limits = [GIRTH * size, DETOUR * size];
        let Some((next, shortcut)) = handle::cut(&opened.cut.mesh, &topology, limits, budget)? else { break };
        if *is_mechanical.get_or_init(|| SmoothRegions::of(mesh).is_mechanical) {
            break;
        }
        let n_cut = opened.shortcuts.len() + 1;
        opened.cut = opened.cut.then(next);
        opened.shortcuts.push(shortcut);
        if n_cut >= MOST {
            break;
        }
    }
    Ok(opened)
}

/// Girth of the widest handle that is cut, relative to the square root of the area.
const GIRTH: f64 = 0.3;

/// Least distance between the sides of a shortcut once it is cut, relative to the square root of the area. Parts that meet
/// nearby, as at the seams of a coarse mesh, change few distances. A round value: the law `shortcuts` finds all single welds
/// of creatures with it.
const DETOUR: f64 = 0.3;
