//! Exact distances on polyhedral surfaces.
//!
//! | module | what it does |
//! |---|---|
//! | `order` | leaves out faces that repeat another, and makes neighbours neighbours in memory |
//! | `faces`, `fan` | the faces, and the corners around every vertex with their angles |
//! | `window` | what an edge sees of a source through one strip of unfolded faces |
//! | `envelope` | leaves of the windows at an edge what may be shortest |
//! | `frame`, `apex` | a face laid out, windows falling through it, and what its apex sees of them |
//! | `front` | labels of vertices, their order, windows that wait |
//! | `wave`, `emission` | how the front advances, and where new windows come from |

mod apex;
mod emission;
mod envelope;
mod faces;
mod fan;
mod frame;
mod front;
mod order;
mod wave;
mod window;

#[cfg(test)]
mod tests;

use surface::IntrinsicMesh;

use crate::Source;
use crate::solver::{DistanceSolver, Pool, within};
use faces::Surface;
use fan::Fans;
use order::{Renumbered, renumbered};
use wave::Scratch;

/// Exact distances on the surface: no other error than rounding.
///
/// A shortest path runs straight through the faces it crosses, laid out in the plane, and bends only
/// at vertices with a total angle above `2 pi`, or above `pi` on the boundary. A **window** is the
/// part of an edge from which one such vertex, or the source, is seen through one strip of faces;
/// windows are passed on from edge to edge, like light, and where several fall on a point the
/// nearest counts.
///
/// | paper | here | meaning |
/// |---|---|---|
/// | `(b0, b1)` | `start..end` | the interval of the edge, which lies on the x-axis |
/// | `(d0, d1)` | `(x, -depth)` | the source laid out in the plane of the edge, instead of two distances |
/// | `sigma` | `offset` | distance of the vertex where the path bends |
/// | `d(v)` | label | shortest known path to a vertex |
///
/// The distance at the point `t` of the edge is `offset + sqrt((t - x)^2 + depth^2)`.
///
/// * **Order.** Windows wait at an edge until the nearer of its ends is the nearest vertex of the
///   front, and are then taken through the next face together; most edges are crossed once. Any
///   order gives the same distances, but not as fast.
/// * **Pruning.** Of the windows that wait at an edge on one side only the lower envelope goes on,
///   cut where a path through an end of the edge is shorter; of several that the apex of the next
///   face sees, only the nearest goes on to both sides of it. A vertex where paths bend sends
///   windows only into directions at least half a turn away from where it was reached. Windows of
///   the same source that meet again behind a vertex without curvature are joined.
/// * **Any mesh.** At an edge with more than two faces windows go into all the others; where faces
///   do not form one fan around a vertex, at the ends of links and of edges without length, paths
///   bend in any direction. Orientation does not matter. Of faces with the same vertices one is
///   enough. A face without area is blown up to `1e-12` of its longest edge. Of faces with a side of
///   no length, which repair drops, several in a row may hide a way through them.
/// * **Guarantees.** Every distance is the length of a path, up to rounding; symmetric, and never
///   longer than along edges. Infinite where nothing leads. It always ends: the number of windows
///   is bounded, by a limit that no known surface comes near.
/// * **Cost.** `O(p^2)` at worst in the number of vertices, near `O(p^1.2)` in practice, linear on
///   flat parts; about 400 bytes a vertex.
///
/// After Mitchell, Mount and Papadimitriou 1987; the splitting of windows at one apex only is Xin
/// and Wang's 2009, the order by vertices that of Qin et al. 2016 (`mitchell1987`, `xin2009`, `qin2016` in
/// `REFERENCES.bib`). **Deviation:** sources are kept unfolded, so that no roots are
/// needed but where two windows are compared; windows are compared with their neighbours on the
/// same side of an edge only.
#[derive(Debug)]
pub struct Exact {
    surface: Surface,
    fans: Fans,
    /// Both directions of every link: from, to, length; sorted.
    links: Vec<(u32, u32, f64)>,
    /// How many faces light may cross in a row around one vertex.
    max_turn: i32,
    /// The numbers inside of vertices and faces.
    vertices: Vec<u32>,
    faces: Vec<u32>,
    scratch: Pool<Scratch>,
}

impl Exact {
    /// Prepares a surface.
    #[must_use]
    pub fn new(mesh: &IntrinsicMesh) -> Self {
        let Renumbered { mesh, vertices, faces } = renumbered(mesh);
        let surface = Surface::new(&mesh);
        let fans = Fans::new(&mesh, &surface);
        let mut links: Vec<(u32, u32, f64)> = Vec::with_capacity(2 * mesh.links().len());
        for link in mesh.links() {
            let ([a, b], length) = (link.ends.map(|v| v.0), link.length / surface.unit);
            links.extend([(a, b, length), (b, a, length)]);
        }
        links.sort_unstable_by(|p, q| (p.0, p.1).cmp(&(q.0, q.1)).then(p.2.total_cmp(&q.2)));
        let max_turn = i32::try_from(fans.max_valence()).unwrap_or(i32::MAX);
        Self { surface, fans, links, max_turn, vertices, faces, scratch: Pool::default() }
    }
}

impl DistanceSolver for Exact {
    fn n_vertices(&self) -> usize {
        self.vertices.len()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        let unit = self.surface.unit;
        self.scratch.with(|scratch| {
            scratch.front.reset(out.len(), 3 * self.surface.faces.len());
            wave::run(self, scratch, max_distance / unit, |wave| {
                sources.iter().for_each(|source| wave.leave_source(source));
            });
            for (distance, vertex) in out.iter_mut().zip(&self.vertices) {
                *distance = within(scratch.front.distance(*vertex) * unit, max_distance);
            }
        });
    }
}
