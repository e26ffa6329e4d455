//! A bounded number of places for clients. If all are taken, the client that delays the server most loses its place.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;

use crate::pace::{Pace, Phase};

/// A client with a smaller delay keeps its place.
const TOLERATED: Duration = Duration::from_millis(250);

/// Pause between two attempts to get a place, unless one becomes free before.
const RETRY_PAUSE: Duration = Duration::from_millis(50);

/// The places.
#[derive(Debug)]
pub(crate) struct Places {
    limit: usize,
    holders: Mutex<Vec<Holder>>,
    freed: Notify,
}

#[derive(Debug)]
struct Holder {
    pace: Arc<Pace>,
    /// Notified when the place is lost. Also identifies the holder.
    lost: Arc<Notify>,
    /// The place cannot be lost any more.
    kept: bool,
}

/// A place, returned when dropped.
#[derive(Debug)]
pub(crate) struct Place {
    places: Arc<Places>,
    lost: Arc<Notify>,
}

impl Places {
    pub(crate) fn new(limit: usize) -> Arc<Self> {
        Arc::new(Self { limit: limit.max(1), holders: Mutex::new(Vec::new()), freed: Notify::new() })
    }

    /// A free place, or that of the client with the longest delay.
    pub(crate) fn try_enter(self: &Arc<Self>, pace: &Arc<Pace>) -> Option<Place> {
        let mut holders = self.lock();
        if holders.len() >= self.limit {
            let slowest = (0..holders.len())
                .filter(|i| !holders[*i].kept && holders[*i].pace.phase() != Phase::Working)
                .map(|i| (holders[i].pace.delay(), i))
                .filter(|(delay, _)| *delay >= TOLERATED)
                .max()?;
            holders.swap_remove(slowest.1).lost.notify_one();
        }
        let lost = Arc::new(Notify::new());
        holders.push(Holder { pace: pace.clone(), lost: lost.clone(), kept: false });
        Some(Place { places: self.clone(), lost })
    }

    /// Waits for a place.
    pub(crate) async fn enter(self: &Arc<Self>, pace: &Arc<Pace>) -> Place {
        loop {
            if let Some(place) = self.try_enter(pace) {
                return place;
            }
            // Either way, try again.
            let _ = tokio::time::timeout(RETRY_PAUSE, self.freed.notified()).await;
        }
    }

    /// A poisoned lock is harmless: no method panics between two changes.
    fn lock(&self) -> MutexGuard<'_, Vec<Holder>> {
        self.holders.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Place {
    /// Waits until another client gets this place.
    pub(crate) async fn lost(&self) {
        self.lost.notified().await;
    }

    /// From now on the place cannot be lost.
    pub(crate) fn keep(&self) {
        let mut holders = self.places.lock();
        if let Some(holder) = holders.iter_mut().find(|holder| Arc::ptr_eq(&holder.lost, &self.lost)) {
            holder.kept = true;
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.lock().retain(|holder| !Arc::ptr_eq(&holder.lost, &self.lost));
        self.places.freed.notify_one();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runtime() -> tokio::runtime::Runtime {
        tokio::runtime::Builder::new_current_thread().enable_time().build().unwrap()
    }

    #[test]
    fn the_slowest_client_loses_its_place_and_only_that_one() {
        let places = Places::new(2);
        let [first, second, third] = [(); 3].map(|()| Arc::new(Pace::new(1000)));
        let slow = places.try_enter(&first).unwrap();
        let quick = places.try_enter(&second).unwrap();
        assert!(places.try_enter(&third).is_none(), "nobody is slow yet");
        std::thread::sleep(2 * TOLERATED);
        second.moved(1 << 20);
        let new = places.try_enter(&third).unwrap();
        runtime().block_on(async {
            tokio::time::timeout(Duration::from_secs(10), slow.lost()).await.unwrap();
            assert!(tokio::time::timeout(TOLERATED, quick.lost()).await.is_err());
        });
        drop(slow);
        assert_eq!(places.lock().len(), 2, "its place was taken, not freed");
        drop((quick, new));
        assert_eq!(places.lock().len(), 0);
    }

    #[test]
    fn a_client_that_waits_for_the_server_keeps_its_place() {
        let places = Places::new(1);
        let pace = Arc::new(Pace::new(1000));
        let place = places.try_enter(&pace).unwrap();
        pace.begin(Phase::Working);
        std::thread::sleep(2 * TOLERATED);
        assert!(places.try_enter(&pace).is_none());
        pace.begin(Phase::Receiving);
        place.keep();
        std::thread::sleep(2 * TOLERATED);
        assert!(places.try_enter(&pace).is_none());
        drop(place);
        runtime().block_on(places.enter(&pace));
    }
}
