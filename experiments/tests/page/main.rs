//! The report as people meet it: opened as a file in a browser, looked at, pointed at, turned, printed.
//!
//! Pictures of it are left in `target/browser`.

#[cfg(test)]
mod report;
