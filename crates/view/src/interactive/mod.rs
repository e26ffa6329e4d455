//! Surfaces and plots in the browser.
//!
//! meshes and numbers -> [`Geometry`] (JSON) -> [`viewer_js`] on top of [`plotly_js`] -> a scene in the page
//!
//! The scripts run under a content-security policy without `unsafe-eval` and request no address. They need
//! `script-src` for their own text, `style-src 'unsafe-inline'` for the rules that plotly inserts, and
//! `img-src data: blob:` for the images that plotly offers as downloads.

pub mod base64;
mod geometry;
mod plotly;

use std::sync::LazyLock;

use crate::color::{hex, perceptual_stops};

pub use geometry::Geometry;
pub use plotly::plotly_js;

/// The viewer: a script that defines the global `canonform` and uses `Plotly` from its first view on.
///
/// `canonform.view(element, geometry | [geometry, ...], options)` draws surfaces into one scene; the head of the
/// script describes its interface.
#[must_use]
pub fn viewer_js() -> &'static str {
    static SCRIPT: LazyLock<String> = LazyLock::new(|| {
        include_str!("viewer.js").replace("COLOR_STOPS", &perceptual_stops().map(hex).join(" "))
    });
    &SCRIPT
}
