//! Errors between a test and a page.

/// Errors of starting and driving a browser.
#[derive(Debug, thiserror::Error)]
pub enum BrowserError {
    /// A program is not installed.
    #[error(
        "{0} is not installed; the browser tests need it (on Debian: apt-get install chromium chromium-driver)"
    )]
    Missing(&'static str),
    /// A program cannot be started, or a file cannot be opened.
    #[error("cannot start: {0}")]
    Start(std::io::Error),
    /// chromedriver did not print its port, but this.
    #[error("chromedriver did not start; it printed `{0}`: run it on a command line")]
    Silent(String),
    /// The driver cannot be reached, or its response is invalid.
    #[error("chromedriver does not respond: {0}")]
    Connection(String),
    /// The driver or the page reports an error.
    #[error("{command}: {kind}: {message}")]
    Refused {
        /// The command.
        command: String,
        /// Name of the error, such as `no such element`.
        kind: String,
        /// Its text.
        message: String,
    },
    /// An expression did not become true in time.
    #[error("`{expression}` did not become true; its last value was {last}")]
    Never {
        /// The expression.
        expression: String,
        /// Its last value.
        last: String,
    },
    /// A picture cannot be decoded or written.
    #[error("screenshot: {0}")]
    Picture(String),
}
