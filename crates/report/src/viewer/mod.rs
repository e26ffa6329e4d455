//! Surfaces and plots in the browser.
//!
//! meshes and numbers -> [`Geometry`] (JSON) -> [`viewer_js`] on top of [`plotly_js`] -> a scene in the page
//!
//! The scripts run under a content-security policy without `unsafe-eval` and request no address. They need
//! `script-src` for their own text, `style-src 'unsafe-inline'` for the rules that plotly inserts, and
//! `img-src data: blob:` for the images that plotly offers as downloads.

mod geometry;
mod scene;
mod words;

use std::io::Read;
use std::sync::LazyLock;

use flate2::read::GzDecoder;

use crate::color::{hex, perceptual_stops};

pub use geometry::Geometry;
pub(crate) use scene::script_hash;
pub use scene::{scene_page, scene_scripts};

/// The viewer: a script that defines the global `canonform` and uses `Plotly` from its first view on.
///
/// `canonform.view(element, geometry | [geometry, ...], options)` draws surfaces into one scene; the head of the
/// script describes its interface.
pub fn viewer_js() -> &'static str {
    static SCRIPT: LazyLock<String> = LazyLock::new(|| {
        include_str!("viewer.js").replace("COLOR_STOPS", &perceptual_stops().map(hex).join(" "))
    });
    &SCRIPT
}

/// The text of plotly.js for one `<script>` element: 1.6 MB, MIT licensed.
///
/// It contains the traces `scatter`, `heatmap` and `mesh3d`, requests no address, evaluates no text as code and
/// contains no `</script`. A prelude keeps browsers from warning about how plotly reads canvases.
pub fn plotly_js() -> &'static str {
    static SCRIPT: LazyLock<String> = LazyLock::new(|| {
        let mut script = PRELUDE.to_owned();
        // The tests unpack the bundle, so it is known to be readable.
        let _ = GzDecoder::new(BUNDLE).read_to_string(&mut script);
        script
    });
    &SCRIPT
}

const PRELUDE: &str = include_str!("prelude.js");

const BUNDLE: &[u8] = include_bytes!("../../assets/plotly/plotly.js.gz");
