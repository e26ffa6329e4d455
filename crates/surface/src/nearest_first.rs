//! A queue in the order of distances.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Items in the ascending order of a number that is not negative, such as a distance, and of themselves where it is equal.
///
/// ```
/// use canonform_surface::NearestFirst;
///
/// let mut queue = NearestFirst::default();
/// [(2.5, 'c'), (0.5, 'b'), (0.5, 'a')].into_iter().for_each(|(distance, item)| queue.push(distance, item));
/// assert_eq!(queue.pop(), Some((0.5, 'a')));
/// queue.push(1.0, 'd');
/// assert_eq!(std::iter::from_fn(|| queue.pop()).map(|(_, item)| item).collect::<String>(), "bdc");
/// ```
#[derive(Debug, Clone)]
pub struct NearestFirst<T>(BinaryHeap<Reverse<(u64, T)>>);

impl<T: Ord> Default for NearestFirst<T> {
    fn default() -> Self {
        Self(BinaryHeap::new())
    }
}

impl<T: Ord> NearestFirst<T> {
    /// Adds an item at a distance, which must not be negative.
    #[inline]
    pub fn push(&mut self, distance: f64, item: T) {
        // Numbers that are not negative are ordered as their bits are.
        self.0.push(Reverse((distance.to_bits(), item)));
    }

    /// Removes all items.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Removes the nearest item.
    #[inline]
    pub fn pop(&mut self) -> Option<(f64, T)> {
        self.0.pop().map(|Reverse((bits, item))| (f64::from_bits(bits), item))
    }
}
