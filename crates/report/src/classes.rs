//! The distinct labels of a list, numbered for colours and markers.

/// Distinct labels in the order of their first appearance.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Classes<'a>(Vec<&'a str>);

impl<'a> Classes<'a> {
    pub(crate) fn of(labels: impl IntoIterator<Item = &'a str>) -> Self {
        let mut names: Vec<&str> = Vec::new();
        for label in labels {
            if !names.contains(&label) {
                names.push(label);
            }
        }
        Self(names)
    }

    pub(crate) fn names(&self) -> &[&'a str] {
        &self.0
    }

    /// The number of a label's class. An unknown label has the number after the last.
    pub(crate) fn index(&self, label: &str) -> usize {
        self.0.iter().position(|name| *name == label).unwrap_or(self.0.len())
    }
}
