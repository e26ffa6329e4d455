//! Marching from triangle to triangle with virtual sources.
//!
//! | module | what is in it |
//! |---|---|
//! | `window` | what a triangle sees of the source |
//! | `crossing` | windows that cross sides, and the distances they give, in lanes |
//! | `triangles` | the triangles and their neighbours, laid out for speed |
//! | `front` | the loop over rounds, and the distances of the vertices |
//!
//! 1. **Start.** The triangles around the source see it directly.
//! 2. **March.** Each round takes the triangles of one bucket, by the distances of their centroids. Their windows
//!    cross the two other sides. A triangle keeps the window through which its centroid is nearest; all windows of a
//!    round are computed before any is replaced.
//! 3. **Reach the vertices.** A vertex takes the least distance that the windows of its triangles give.
//! 4. **Relax edges.** Vertices are lowered along edges, edges that were flipped away, and links.
//! 5. **Start again** from the ends of links, from vertices where parts touch, and next to triangles that no window
//!    has reached, if that makes a triangle nearer.

mod crossing;
mod front;
mod triangles;
mod window;

pub(super) use front::TriangleFront;
pub(super) use triangles::Triangles;
