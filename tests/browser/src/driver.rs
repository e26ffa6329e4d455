//! The process `chromedriver`.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use crate::BrowserError;

/// Time limit for things that should take a second.
pub(crate) const PATIENCE: Duration = Duration::from_secs(30);

/// A running chromedriver, stopped when dropped.
pub(crate) struct Driver {
    process: Child,
    pub(crate) port: u16,
}

impl Driver {
    /// Starts it on a free port. It and its browsers put their temporary files into `folder`.
    pub(crate) fn start(program: &Path, folder: &Path) -> Result<Self, BrowserError> {
        let mut process = Command::new(program)
            .arg("--port=0")
            .env("TMPDIR", folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(BrowserError::Start)?;
        let stdout = process.stdout.take();
        let mut driver = Self { process, port: 0 };
        let (sender, receiver) = mpsc::channel();
        // Reads to the end, because the driver blocks when its output is not read.
        thread::spawn(move || {
            for line in stdout.into_iter().flat_map(|stdout| BufReader::new(stdout).lines()) {
                let Ok(line) = line else { break };
                let _ = sender.send(line);
            }
        });
        let mut output = String::new();
        while let Ok(line) = receiver.recv_timeout(PATIENCE) {
            if let Some(port) = port(&line) {
                driver.port = port;
                return Ok(driver);
            }
            output.push_str(&line);
        }
        Err(BrowserError::Silent(output))
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The port in `ChromeDriver was started successfully on port 12345.`
fn port(line: &str) -> Option<u16> {
    let (_, port) = line.split_once("started successfully on port ")?;
    port.trim_end_matches('.').parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_port_is_parsed_from_the_output() {
        assert_eq!(port("ChromeDriver was started successfully on port 34567."), Some(34567));
        assert_eq!(port("Only local connections are allowed."), None);
    }

    #[test]
    fn other_programs_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let absent = Driver::start(&folder.path().join("absent"), folder.path()).err().unwrap();
        assert!(matches!(absent, BrowserError::Start(_)), "{absent}");
        let silent = Driver::start(Path::new("/bin/echo"), folder.path()).err().unwrap();
        assert!(matches!(&silent, BrowserError::Silent(output) if output == "--port=0"), "{silent}");
    }
}
