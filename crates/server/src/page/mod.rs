//! The pages: files embedded in the program.

use std::sync::Arc;

use axum::Router;
use axum::body::Bytes;
use axum::http::HeaderMap;
use axum::routing::get;
use canonform::ContentHash;

use crate::api::{is_known, tag, tagged};
use crate::app::App;
use crate::formats::filled_in;

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const JS: &str = "text/javascript; charset=utf-8";

/// A page with what all pages have in common.
fn whole(text: &str) -> String {
    let shared =
        [("{{icon}}", include_str!("icon.html")), ("{{comparison}}", include_str!("comparison.html"))];
    filled_in(&shared.iter().fold(text.to_owned(), |text, (name, part)| text.replace(name, part.trim_end())))
}

pub(crate) fn router() -> Router<Arc<App>> {
    let files = [
        ("/assets/style.css", CSS, include_str!("style.css")),
        ("/assets/app.js", JS, include_str!("app.js")),
        ("/assets/state.js", JS, include_str!("state.js")),
        ("/assets/ask.js", JS, include_str!("ask.js")),
        ("/assets/shapes.js", JS, include_str!("shapes.js")),
        ("/assets/answer.js", JS, include_str!("answer.js")),
        ("/assets/comparison.js", JS, include_str!("comparison.js")),
        ("/assets/duplicates.js", JS, include_str!("duplicates.js")),
        ("/assets/marks.js", JS, include_str!("marks.js")),
        ("/assets/viewer.js", JS, report::viewer::viewer_js()),
        ("/assets/plotly.js", JS, report::viewer::plotly_js()),
    ];
    let pages = [("/", include_str!("index.html")), ("/duplicates", include_str!("duplicates.html"))];
    let pages = pages.map(|(path, text)| (path, HTML, Bytes::from(whole(text))));
    let files = files.map(|(path, kind, text)| (path, kind, Bytes::from_static(text.as_bytes())));
    pages.into_iter().chain(files).fold(Router::new(), |router, (path, kind, text)| {
        let tag = tag(&ContentHash::of(&[&text]).to_string());
        let answer = move |headers: HeaderMap| async move {
            let content = (!is_known(&headers, &tag)).then_some(text);
            tagged(tag, kind, content)
        };
        router.route(path, get(answer))
    })
}
