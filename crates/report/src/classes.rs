//! The classes of a list of labels, and the numbers that colours and markers go by.

/// Different labels in the order of their first appearance.
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

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn name(&self, class: usize) -> &'a str {
        self.0[class]
    }

    /// The number of a label's class; that of a label never seen is one past the last.
    pub(crate) fn index(&self, label: &str) -> usize {
        self.0.iter().position(|name| *name == label).unwrap_or(self.0.len())
    }
}
