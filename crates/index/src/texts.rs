//! Many short texts in one allocation.

use serde::{Deserialize, Serialize};

/// Texts, one after the other.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
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

    pub(crate) fn extend(&mut self, texts: &Self) {
        let start = self.text.len();
        self.text.push_str(&texts.text);
        self.ends.extend(texts.ends.iter().map(|end| start + end));
    }

    /// The text of this number; empty where the ends contradict the text, as in a forged file.
    pub(crate) fn get(&self, i: usize) -> &str {
        let start = i.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.text.get(start..self.ends[i]).unwrap_or_default()
    }

    pub(crate) fn iter(&self) -> impl ExactSizeIterator<Item = &str> {
        (0..self.len()).map(|i| self.get(i))
    }

    pub(crate) fn shrink_to_fit(&mut self) {
        self.text.shrink_to_fit();
        self.ends.shrink_to_fit();
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
        let mut texts: Texts = ["cat", "", "größe"].iter().collect();
        texts.extend(&["dog"].iter().collect());
        assert_eq!(texts.iter().collect::<Vec<_>>(), ["cat", "", "größe", "dog"]);
        let forged = Texts { text: "ö".to_owned(), ends: vec![1, 9, 0] };
        assert_eq!(forged.iter().collect::<Vec<_>>(), ["", "", ""]);
    }
}
