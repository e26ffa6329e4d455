//! Many short texts in one allocation.

/// Texts, one after the other.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Texts {
    text: String,
    /// The end of each.
    ends: Vec<usize>,
}

impl Texts {
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(crate) fn push(&mut self, text: &str) {
        self.text.push_str(text);
        self.ends.push(self.text.len());
    }

    pub(crate) fn get(&self, i: usize) -> &str {
        let start = i.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.text[start..self.ends[i]]
    }
}

impl<T: AsRef<str>> FromIterator<T> for Texts {
    fn from_iter<I: IntoIterator<Item = T>>(texts: I) -> Self {
        let mut all = Self::default();
        texts.into_iter().for_each(|text| all.push(text.as_ref()));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_come_back_in_order() {
        let texts: Texts = ["cat", "", "größe", "dog"].iter().collect();
        assert_eq!((0..4).map(|i| texts.get(i)).collect::<Vec<_>>(), ["cat", "", "größe", "dog"]);
    }
}
