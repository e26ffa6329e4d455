//! A page of its own that shows a surface, for frames in notebooks.

use std::io::Write;
use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use sha2::{Digest, Sha256};

use super::{BUNDLE, Geometry, PRELUDE, plotly_js, viewer_js};
use crate::markup::escape;

/// A page of HTML that shows a surface to turn and zoom: 0.7 MB of scripts, packed, and the surface.
///
/// It fetches nothing, and its policy allows its own scripts only. Before the surface is drawn, and without scripts or
/// WebGL, the page is transparent. Without [`scene_scripts`] the page asks the page around it for them.
pub fn scene_page(geometry: &Geometry, title: &str) -> String {
    let [islands, hashes] = &*SCRIPTS;
    let start = include_str!("scene.js");
    let scene = serde_json::to_string(geometry).unwrap_or_default();
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\n\
         <meta http-equiv=\"content-security-policy\" content=\"default-src 'none'; script-src {hashes} {start_hash}; \
         style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'\">\n\
         <style>html,body{{height:100%;margin:0;overflow:hidden}}body{{font:13px sans-serif}}#view{{height:100%}}\
         .canonform-title{{margin:0}}.canonform-fallback{{position:absolute;bottom:0}}</style></head>\n\
         <body><div id=\"view\"></div>\n{islands}{scene}<script>{start}</script></body></html>\n",
        title = escape(title),
        start_hash = script_hash(start),
        scene = packed("scene", &scene),
    )
}

/// The part of every [`scene_page`] that all share: its scripts, packed.
pub fn scene_scripts() -> &'static str {
    &SCRIPTS[0]
}

/// The scripts as elements that are not run, and their hashes.
static SCRIPTS: LazyLock<[String; 2]> = LazyLock::new(|| {
    // The bundle is packed already, and packing it again takes a second.
    let bundle = plotly_js().strip_prefix(PRELUDE).unwrap_or_default();
    let islands = [packed("prelude", PRELUDE), island("plotly", BUNDLE), packed("viewer", viewer_js())];
    [islands.concat(), [PRELUDE, bundle, viewer_js()].map(script_hash).join(" ")]
});

/// A script in a content-security policy.
pub(crate) fn script_hash(script: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(script)))
}

/// Text as an element that is not run.
fn packed(id: &str, text: &str) -> String {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    // Writing to memory cannot fail.
    let _ = encoder.write_all(text.as_bytes());
    island(id, &encoder.finish().unwrap_or_default())
}

/// Bytes of gzip as such an element, in base64.
fn island(id: &str, bytes: &[u8]) -> String {
    format!("<script type=\"text/plain\" id=\"{id}\">{}</script>\n", STANDARD.encode(bytes))
}
