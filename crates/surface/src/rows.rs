//! Rows of unequal length, stored back to back.

/// A list of `T` for each of a number of rows.
///
/// ```
/// use canonform_surface::Rows;
///
/// let rows = Rows::collect(3, [(2, 'a'), (0, 'b'), (2, 'c')].into_iter());
/// assert_eq!(rows.row(2), ['a', 'c']);
/// assert!(rows.row(1).is_empty());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rows<T> {
    offsets: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy> Rows<T> {
    /// Sorts `(row, item)` pairs by row; items of a row keep their order. Linear time.
    ///
    /// # Panics
    /// If a row is not below `n_rows`.
    pub fn collect(n_rows: usize, pairs: impl Iterator<Item = (usize, T)> + Clone) -> Self {
        let mut offsets = vec![0u32; n_rows + 1];
        for (row, _) in pairs.clone() {
            offsets[row + 1] += 1;
        }
        for row in 0..n_rows {
            offsets[row + 1] += offsets[row];
        }
        let mut next = offsets.clone();
        let filler = pairs.clone().next().map(|(_, item)| item);
        let mut items: Vec<T> = filler.map_or_else(Vec::new, |item| vec![item; offsets[n_rows] as usize]);
        for (row, item) in pairs {
            items[next[row] as usize] = item;
            next[row] += 1;
        }
        Self { offsets, items }
    }

    /// Rows whose items lie back to back: row `i` has the items from `offsets[i]` to `offsets[i + 1]`.
    ///
    /// # Panics
    /// If the offsets are not ascending from zero to the number of items.
    pub fn from_offsets(offsets: Vec<u32>, items: Vec<T>) -> Self {
        assert!(offsets.is_sorted() && offsets.first() == Some(&0), "offsets ascend from zero");
        assert_eq!(offsets.last().map(|end| *end as usize), Some(items.len()), "all items are in a row");
        Self { offsets, items }
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The items of a row.
    #[inline]
    pub fn row(&self, row: usize) -> &[T] {
        &self.items[self.range(row)]
    }

    /// Where the items of a row are among [all items](Self::items).
    #[inline]
    pub fn range(&self, row: usize) -> std::ops::Range<usize> {
        self.offsets[row] as usize..self.offsets[row + 1] as usize
    }

    /// The items of all rows, one row after the other.
    #[inline]
    pub fn items(&self) -> &[T] {
        &self.items
    }
}
