//! What can go wrong between a test and a page.

/// Errors of starting and of driving a browser.
#[derive(Debug, thiserror::Error)]
pub enum BrowserError {
    /// A program is not installed.
    #[error(
        "{program} is not installed; install it (on Debian: apt-get install chromium chromium-driver) for the tests \
         in a browser"
    )]
    Missing {
        /// Which.
        program: &'static str,
    },
    /// A program or a file that cannot be opened.
    #[error("cannot start: {0}")]
    Start(std::io::Error),
    /// chromedriver did not say where it listens.
    #[error("chromedriver did not start: it said `{said}`; try it on a command line")]
    Silent {
        /// Its words.
        said: String,
    },
    /// The driver cannot be reached, or answers what is no answer.
    #[error("chromedriver does not answer: {0}")]
    Connection(String),
    /// The driver or the page says no.
    #[error("{command}: {kind}: {message}")]
    Refused {
        /// What was asked.
        command: String,
        /// Name of the error, such as `no such element`.
        kind: String,
        /// Its words.
        message: String,
    },
    /// Something did not become true.
    #[error("waited in vain for `{expression}`; it was {last}")]
    Never {
        /// The expression.
        expression: String,
        /// Its last value.
        last: String,
    },
    /// A picture that cannot be read or written.
    #[error("screenshot: {0}")]
    Picture(String),
}
