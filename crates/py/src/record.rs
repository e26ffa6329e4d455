//! Records of the library as the JSON of the command line, which the Python layer parses.

/// A record as JSON.
pub(crate) fn json(record: impl serde::Serialize) -> String {
    serde_json::to_string(&record).unwrap_or_else(|fault| unreachable!("plain data: {fault}"))
}
