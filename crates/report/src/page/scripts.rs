//! The scripts of the page, and the policy that lets these run and no other.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use sha2::{Digest, Sha256};

use view::interactive::{VIEWER_JS, plotly_js};

/// Before anything is seen: what only scripts can fill may be shown, what stands in for it not.
const FIRST: &str = "document.documentElement.classList.add('js');";

/// All scripts but the first, in the order they run.
fn scripts() -> [&'static str; 8] {
    [
        plotly_js(),
        VIEWER_JS,
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
/// Scripts are named by their hashes, so nothing else on the page can become one, and no address may be asked for
/// anything. plotly inserts style rules and makes pictures of its plots.
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

/// Data for the scripts, which nothing in it can leave: every character that means something in HTML is written as an
/// escape of JSON.
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
    fn no_script_ends_early_or_needs_what_the_policy_forbids() {
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
