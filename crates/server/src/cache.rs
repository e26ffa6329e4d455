//! A cache with a limit in bytes.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Values by name; the least recently used one is dropped first.
pub(crate) struct Cache<V> {
    /// The least recently used one first.
    entries: Mutex<Vec<Entry<V>>>,
    limit: usize,
    lifetime: Duration,
}

struct Entry<V> {
    name: String,
    value: V,
    bytes: usize,
    since: Instant,
}

impl<V: Clone> Cache<V> {
    /// Keeps up to `limit` bytes, and the last value whatever its size.
    pub(crate) fn new(limit: usize) -> Self {
        Self { entries: Mutex::default(), limit, lifetime: Duration::MAX }
    }

    /// Drops values older than this.
    pub(crate) fn with_lifetime(self, lifetime: Duration) -> Self {
        Self { lifetime, ..self }
    }

    pub(crate) fn get(&self, name: &str) -> Option<V> {
        let mut entries = self.young();
        let place = entries.iter().position(|entry| entry.name == name)?;
        entries[place..].rotate_left(1);
        entries.last().map(|entry| entry.value.clone())
    }

    pub(crate) fn put(&self, name: String, value: V, bytes: usize) {
        let mut entries = self.young();
        entries.retain(|entry| entry.name != name);
        let mut left = self.limit.saturating_sub(bytes);
        let too_much = entries.iter().rposition(|entry| {
            let rest = left.checked_sub(entry.bytes);
            left = rest.unwrap_or(0);
            rest.is_none()
        });
        entries.drain(..too_much.map_or(0, |last| last + 1));
        entries.push(Entry { name, value, bytes, since: Instant::now() });
    }

    /// The entries, without old ones. A poisoned lock is harmless: no method panics between two changes.
    fn young(&self) -> MutexGuard<'_, Vec<Entry<V>>> {
        let mut entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
        entries.retain(|entry| entry.since.elapsed() < self.lifetime);
        entries
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(cache: &Cache<u8>) -> String {
        let mut names: Vec<_> = cache.young().iter().map(|entry| entry.name.clone()).collect();
        names.sort();
        names.concat()
    }

    fn bytes(cache: &Cache<u8>) -> usize {
        cache.young().iter().map(|entry| entry.bytes).sum()
    }

    #[test]
    fn the_least_recently_used_value_is_dropped_first() {
        let cache = Cache::new(100);
        for name in ["a", "b", "c"] {
            cache.put(name.to_owned(), 1, 30);
        }
        assert_eq!((kept(&cache), cache.get("a")), ("abc".to_owned(), Some(1)));
        cache.put("d".to_owned(), 2, 30);
        assert_eq!(kept(&cache), "acd");
        cache.put("a".to_owned(), 3, 10);
        assert_eq!((kept(&cache), bytes(&cache), cache.get("a")), ("acd".to_owned(), 70, Some(3)));
        cache.put("b".to_owned(), 1, 500);
        assert_eq!((kept(&cache), bytes(&cache)), ("b".to_owned(), 500), "the last one stays");
        cache.put("c".to_owned(), 1, 1);
        assert_eq!((kept(&cache), bytes(&cache)), ("c".to_owned(), 1));
    }

    #[test]
    fn old_values_are_dropped() {
        let cache = Cache::new(100).with_lifetime(Duration::ZERO);
        cache.put("a".to_owned(), 1, 30);
        assert_eq!((cache.get("a"), bytes(&cache)), (None, 0));
    }
}
