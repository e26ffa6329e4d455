//! Rows of unequal length stored back to back.

/// A list of `T` for every row.
#[derive(Debug, Clone)]
pub(crate) struct Rows<T> {
    offsets: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy> Rows<T> {
    /// Sorts `(row, item)` pairs by counting; items keep their order inside a row.
    pub(crate) fn collect(n_rows: usize, pairs: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        let mut offsets = vec![0u32; n_rows + 1];
        for (row, _) in pairs.clone() {
            offsets[row as usize + 1] += 1;
        }
        for row in 0..n_rows {
            offsets[row + 1] += offsets[row];
        }
        let mut next = offsets.clone();
        let filler = pairs.clone().next().map(|(_, item)| item);
        let mut items: Vec<T> = filler.map_or_else(Vec::new, |item| vec![item; offsets[n_rows] as usize]);
        for (row, item) in pairs {
            items[next[row as usize] as usize] = item;
            next[row as usize] += 1;
        }
        Self { offsets, items }
    }

    pub(crate) fn n_rows(&self) -> usize {
        self.offsets.len() - 1
    }

    #[inline]
    pub(crate) fn of(&self, row: u32) -> &[T] {
        let row = row as usize;
        &self.items[self.offsets[row] as usize..self.offsets[row + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_keep_their_order_inside_a_row() {
        let pairs = [(2, 'a'), (0, 'b'), (2, 'c'), (0, 'd'), (2, 'e')];
        let rows = Rows::collect(4, pairs.into_iter());
        assert_eq!(rows.n_rows(), 4);
        let expected: [&[char]; 4] = [&['b', 'd'], &[], &['a', 'c', 'e'], &[]];
        for (row, items) in expected.into_iter().enumerate() {
            assert_eq!(rows.of(row as u32), items);
        }
        assert_eq!(Rows::<u8>::collect(1, std::iter::empty()).of(0), &[]);
    }
}
