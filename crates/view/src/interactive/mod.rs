//! Surfaces and plots that a browser shows and lets turn.
//!
//! Meshes and numbers of a record -> [`Geometry`] (JSON) -> [`VIEWER_JS`] on top of [`plotly_js`] -> a scene in the page
//!
//! The viewer works under a content-security policy without `unsafe-eval`. It needs
//! `script-src` for its own text and plotly's, `style-src 'unsafe-inline'` for the rules that plotly inserts, and
//! `img-src data: blob:` for plotly's downloads of pictures; nothing else, and no address.

pub mod base64;
mod geometry;
mod plotly;

pub use geometry::Geometry;
pub use geometry::hex;
pub use plotly::plotly_js;

/// The viewer: a plain script that defines the global `canonform` and expects `Plotly` before its first view.
///
/// `canonform.view(element, geometry | [geometry, ...], options)` draws surfaces into one scene; the head of the
/// script describes it all.
pub const VIEWER_JS: &str = include_str!("viewer.js");
