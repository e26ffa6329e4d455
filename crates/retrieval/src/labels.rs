//! Class labels.

/// Class names and the class of each shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Labels {
    classes: Vec<String>,
    of: Vec<usize>,
    sizes: Vec<usize>,
}

impl Labels {
    /// Takes the class name of each shape. Classes are numbered in alphabetical order.
    pub fn new<S: AsRef<str>>(names: &[S]) -> Self {
        let mut classes: Vec<String> = names.iter().map(|name| name.as_ref().to_owned()).collect();
        classes.sort();
        classes.dedup();
        let of: Vec<usize> = names
            .iter()
            .map(|name| classes.partition_point(|class| class.as_str() < name.as_ref()))
            .collect();
        let mut sizes = vec![0; classes.len()];
        of.iter().for_each(|&class| sizes[class] += 1);
        Self { classes, of, sizes }
    }

    /// Number of shapes.
    pub fn n_points(&self) -> usize {
        self.of.len()
    }

    /// The class names, sorted.
    pub fn classes(&self) -> &[String] {
        &self.classes
    }

    /// The class of shape `i`, as an index into [`classes`](Self::classes).
    pub fn class(&self, i: usize) -> usize {
        self.of[i]
    }

    /// Number of shapes in a class.
    pub fn size(&self, class: usize) -> usize {
        self.sizes[class]
    }

    /// Whether shape `i` is scored as a query: its class has more than two members (the convention of the
    /// Princeton shape benchmark).
    pub fn is_query(&self, i: usize) -> bool {
        self.size(self.of[i]) > 2
    }
}
