//! A cache with a limit.

use std::borrow::Borrow;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Values by their keys. If they weigh too much, the least recently used one is dropped first.
#[derive(Debug)]
pub struct Cache<K, V> {
    /// The least recently used one first.
    entries: Mutex<Vec<Entry<K, V>>>,
    limit: usize,
    lifetime: Duration,
}

#[derive(Debug)]
struct Entry<K, V> {
    key: K,
    value: V,
    weight: usize,
    since: Instant,
}

impl<K: PartialEq, V: Clone> Cache<K, V> {
    /// Keeps values up to this weight, and the last one whatever its weight.
    #[must_use]
    pub fn new(limit: usize) -> Self {
        Self { entries: Mutex::default(), limit, lifetime: Duration::MAX }
    }

    /// Drops values older than this.
    #[must_use]
    pub fn with_lifetime(self, lifetime: Duration) -> Self {
        Self { lifetime, ..self }
    }

    /// The value of a key.
    pub fn get<Q: PartialEq + ?Sized>(&self, key: &Q) -> Option<V>
    where
        K: Borrow<Q>,
    {
        let mut entries = self.young();
        let place = entries.iter().position(|entry| entry.key.borrow() == key)?;
        entries[place..].rotate_left(1);
        entries.last().map(|entry| entry.value.clone())
    }

    /// Keeps a value.
    pub fn put(&self, key: K, value: V, weight: usize) {
        self.remove(&key);
        let mut entries = self.young();
        let mut left = self.limit.saturating_sub(weight);
        let too_much = entries.iter().rposition(|entry| {
            let rest = left.checked_sub(entry.weight);
            left = rest.unwrap_or(0);
            rest.is_none()
        });
        entries.drain(..too_much.map_or(0, |last| last + 1));
        entries.push(Entry { key, value, weight, since: Instant::now() });
    }

    /// The value of a key, or one that is made now and kept with a weight of 1.
    ///
    /// # Errors
    /// That of making it.
    pub fn get_or_put<E>(&self, key: &K, make: impl FnOnce() -> Result<V, E>) -> Result<V, E>
    where
        K: Clone,
    {
        if let Some(known) = self.get(key) {
            return Ok(known);
        }
        let made = make()?;
        self.put(key.clone(), made.clone(), 1);
        Ok(made)
    }

    /// Drops the value of a key.
    pub fn remove(&self, key: &K) {
        self.young().retain(|entry| entry.key != *key);
    }

    /// The entries, without old ones. A poisoned lock is harmless: no method panics between two changes.
    fn young(&self) -> MutexGuard<'_, Vec<Entry<K, V>>> {
        let mut entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
        entries.retain(|entry| entry.since.elapsed() < self.lifetime);
        entries
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(cache: &Cache<String, u8>) -> String {
        let mut names: Vec<_> = cache.young().iter().map(|entry| entry.key.clone()).collect();
        names.sort();
        names.concat()
    }

    fn weight(cache: &Cache<String, u8>) -> usize {
        cache.young().iter().map(|entry| entry.weight).sum()
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
        assert_eq!((kept(&cache), weight(&cache), cache.get("a")), ("acd".to_owned(), 70, Some(3)));
        cache.put("b".to_owned(), 1, 500);
        assert_eq!((kept(&cache), weight(&cache)), ("b".to_owned(), 500), "the last one stays");
        cache.put("c".to_owned(), 1, 1);
        assert_eq!((kept(&cache), weight(&cache)), ("c".to_owned(), 1));
    }

    #[test]
    fn old_values_are_dropped() {
        let cache = Cache::new(100).with_lifetime(Duration::ZERO);
        cache.put("a".to_owned(), 1, 30);
        assert_eq!((cache.get("a"), weight(&cache)), (None, 0));
    }
}
