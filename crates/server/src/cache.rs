//! A cache with a limit in bytes.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use lru::LruCache;

/// Values by name; the least recently used one is dropped first.
pub(crate) struct Cache<V> {
    entries: Mutex<Entries<V>>,
    limit: usize,
    lifetime: Option<Duration>,
}

struct Entries<V> {
    known: LruCache<String, Entry<V>>,
    bytes: usize,
}

struct Entry<V> {
    value: V,
    bytes: usize,
    since: Instant,
}

impl<V: Clone> Cache<V> {
    /// Keeps up to `limit` bytes, and the last value whatever its size.
    pub(crate) fn new(limit: usize) -> Self {
        Self {
            entries: Mutex::new(Entries { known: LruCache::unbounded(), bytes: 0 }),
            limit,
            lifetime: None,
        }
    }

    /// Drops values older than this.
    pub(crate) fn with_lifetime(self, lifetime: Duration) -> Self {
        Self { lifetime: Some(lifetime), ..self }
    }

    pub(crate) fn get(&self, name: &str) -> Option<V> {
        let mut entries = self.lock();
        self.drop_old(&mut entries);
        entries.known.get(name).map(|entry| entry.value.clone())
    }

    pub(crate) fn put(&self, name: String, value: V, bytes: usize) {
        let mut entries = self.lock();
        self.drop_old(&mut entries);
        let entry = Entry { value, bytes, since: Instant::now() };
        let replaced = entries.known.put(name, entry).map_or(0, |entry| entry.bytes);
        entries.bytes = entries.bytes + bytes - replaced;
        while entries.bytes > self.limit && entries.known.len() > 1 {
            let Some((_, oldest)) = entries.known.pop_lru() else { break };
            entries.bytes -= oldest.bytes;
        }
    }

    fn drop_old(&self, entries: &mut Entries<V>) {
        let Some(lifetime) = self.lifetime else { return };
        let old = entries.known.iter().filter(|(_, entry)| entry.since.elapsed() >= lifetime);
        let old: Vec<String> = old.map(|(name, _)| name.clone()).collect();
        for name in old {
            entries.bytes -= entries.known.pop(&name).map_or(0, |entry| entry.bytes);
        }
    }

    /// A poisoned lock is harmless: no method panics between two changes.
    fn lock(&self) -> MutexGuard<'_, Entries<V>> {
        self.entries.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(cache: &Cache<u8>) -> String {
        ["a", "b", "c", "d"].into_iter().filter(|name| cache.lock().known.contains(*name)).collect()
    }

    fn bytes(cache: &Cache<u8>) -> usize {
        cache.lock().bytes
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
