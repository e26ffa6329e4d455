//! Locations of the programs.

use std::env;
use std::path::PathBuf;

use crate::BrowserError;

/// Paths of the browser and its driver.
pub(crate) struct Programs {
    pub(crate) browser: PathBuf,
    pub(crate) driver: PathBuf,
}

impl Programs {
    /// Searches `PATH`.
    pub(crate) fn find() -> Result<Self, BrowserError> {
        let folders: Vec<PathBuf> = env::var_os("PATH").iter().flat_map(env::split_paths).collect();
        Self::find_in(&folders)
    }

    fn find_in(folders: &[PathBuf]) -> Result<Self, BrowserError> {
        let find = |names: &[&'static str]| {
            let paths = names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
            paths.into_iter().find(|path| path.is_file()).ok_or(BrowserError::Missing(names[0]))
        };
        Ok(Self {
            browser: find(&["chromium", "chromium-browser", "google-chrome"])?,
            driver: find(&["chromedriver"])?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_programs_are_named_with_the_remedy() {
        let folder = tempfile::tempdir().unwrap();
        let find = || Programs::find_in(&[folder.path().join("absent"), folder.path().to_owned()]);
        for name in ["chromium", "chromedriver"] {
            let error = find().err().unwrap();
            assert!(matches!(error, BrowserError::Missing(program) if program == name), "{error}");
            assert!(error.to_string().contains("apt-get install"));
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let found = find().unwrap();
        assert_eq!(found.driver, folder.path().join("chromedriver"));
        assert_eq!(found.browser, folder.path().join("chromium"));
    }
}
