//! The scripts of the page, and the policy that allows no others.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::viewer::{plotly_js, viewer_js};

/// Runs before anything is drawn, so that what scripts fill is shown instead of the static figures.
const FIRST: &str = "document.documentElement.classList.add('js');";

/// All scripts but the first, in the order in which they run.
fn scripts() -> [&'static str; 8] {
    [
        plotly_js(),
        viewer_js(),
        include_str!("scripts/plots.js"),
        include_str!("scripts/charts.js"),
        include_str!("scripts/surfaces.js"),
        include_str!("scripts/explorer.js"),
        include_str!("scripts/gallery.js"),
        include_str!("scripts/start.js"),
    ]
}

/// For the head of the page: the content-security policy and the first script.
///
/// The policy allows scripts by their hashes, so nothing else on the page can run, and forbids all requests. plotly
/// inserts style rules and makes images of its plots.
pub(super) fn head() -> String {
    let hash = |script: &str| format!(" 'sha256-{}'", STANDARD.encode(Sha256::digest(script)));
    let hashes: String = std::iter::once(FIRST).chain(scripts()).map(hash).collect();
    format!(
        "<meta http-equiv=\"content-security-policy\" content=\"default-src 'none'; script-src{hashes}; \
         style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'\">\n<script>{FIRST}</script>\n"
    )
}

/// For the end of the page.
pub(super) fn tail() -> String {
    scripts().map(|script| format!("<script>{script}</script>\n")).concat()
}

/// Data for the scripts. The special characters of HTML are escaped as JSON does, so no text can end the element.
pub(super) fn island(id: &str, data: &Value) -> String {
    let json = data.to_string().replace('&', "\\u0026").replace('<', "\\u003c").replace('>', "\\u003e");
    format!("<script type=\"application/json\" id=\"{id}\">{json}</script>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_cannot_end_its_element_and_reads_back() {
        let data = serde_json::json!({"name": "</script><img src=x onerror=\"alert(1)\"><!-- &amp;"});
        let html = island("x", &data);
        let json = html.strip_prefix("<script type=\"application/json\" id=\"x\">").unwrap();
        let json = json.strip_suffix("</script>\n").unwrap();
        assert!(!json.contains(['<', '>', '&']), "{json}");
        assert_eq!(serde_json::from_str::<Value>(json).unwrap(), data);
    }

    #[test]
    fn scripts_do_not_end_their_element_or_need_what_the_policy_forbids() {
        for script in scripts() {
            assert!(!script.to_ascii_lowercase().contains("</script") && !script.contains("<!--"));
        }
        for script in &scripts()[1..] {
            let code: String = script.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
            for forbidden in ["innerHTML", "eval(", "new Function", "document.write", "http://", "https://"] {
                assert!(!code.contains(forbidden), "{forbidden}");
            }
        }
        let head = head();
        assert_eq!(head.matches("'sha256-").count(), 9);
        assert!(!head.contains("unsafe-eval") && head.contains("default-src 'none'"));
    }
}
