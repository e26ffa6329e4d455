//! Tests of the report page in a browser: hovering, clicking, rotating, narrow screens, dark mode, print.
//!
//! Screenshots are written to `target/browser`.

#[cfg(test)]
mod interruption;
#[cfg(test)]
mod report;
