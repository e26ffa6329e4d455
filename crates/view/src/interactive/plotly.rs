//! plotly's own script, out of the crate that carries it.

use std::sync::LazyLock;

/// The text of plotly.js, for one `<script>` element: about 4.7 MB, MIT licensed, asking for no address as long as
/// no map is drawn. A few lines before it keep it from being warned of by browsers. It contains no `</script`.
#[must_use]
pub fn plotly_js() -> &'static str {
    static SCRIPT: LazyLock<String> = LazyLock::new(|| {
        // The crate hands out `<script>` elements, plotly's first; the one behind it typesets formulas, which nothing here needs.
        let elements = plotly::Plot::offline_js_sources();
        let first = elements.split("</script>").next().unwrap_or_default();
        let body = first.find('>').map_or("", |end| &first[end + 1..]);
        format!("{}{body}", include_str!("prelude.js"))
    });
    &SCRIPT
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_whole_script_and_no_second_one() {
        let script = plotly_js();
        assert!((3_000_000..5_500_000).contains(&script.len()), "one script: {} bytes", script.len());
        assert!(script.contains("\n/**\n* plotly.js v"));
        assert!(!script.to_ascii_lowercase().contains("</script") && !script.contains("<!--"));
        assert!(script.contains("Copyright") && script.contains("MIT license"), "its licence stays with it");
    }
}
