//! A bounded number of places for clients. If all are taken, the client that delays the server most loses its place.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;

use crate::pace::Pace;

/// A client with a smaller delay keeps its place.
const TOLERATED: Duration = Duration::from_millis(250);

/// Pause between two attempts to get a place.
const RETRY_PAUSE: Duration = Duration::from_millis(20);

/// The places.
#[derive(Debug)]
pub(crate) struct Places {
    limit: usize,
    /// Clients, each with what is notified when its place is lost, which identifies it.
    holders: Mutex<Vec<(Arc<Pace>, Arc<Notify>)>>,
}

/// A place, returned when dropped.
#[derive(Debug)]
pub(crate) struct Place {
    places: Arc<Places>,
    lost: Arc<Notify>,
}

impl Places {
    pub(crate) fn new(limit: usize) -> Arc<Self> {
        Arc::new(Self { limit: limit.max(1), holders: Mutex::default() })
    }

    /// A free place, or that of the client with the longest delay.
    pub(crate) fn try_enter(self: &Arc<Self>, pace: &Arc<Pace>) -> Option<Place> {
        let mut holders = self.lock();
        if holders.len() >= self.limit {
            let delays = holders.iter().enumerate().map(|(i, (pace, _))| (pace.delay(), i));
            let (_, slowest) = delays.filter(|(delay, _)| *delay >= TOLERATED).max()?;
            holders.swap_remove(slowest).1.notify_one();
        }
        let lost = Arc::new(Notify::new());
        holders.push((pace.clone(), lost.clone()));
        Some(Place { places: self.clone(), lost })
    }

    /// Waits for a place.
    pub(crate) async fn enter(self: &Arc<Self>, pace: &Arc<Pace>) -> Place {
        loop {
            match self.try_enter(pace) {
                Some(place) => return place,
                None => tokio::time::sleep(RETRY_PAUSE).await,
            }
        }
    }

    /// A poisoned lock is harmless: no method panics between two changes.
    fn lock(&self) -> MutexGuard<'_, Vec<(Arc<Pace>, Arc<Notify>)>> {
        self.holders.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Place {
    /// Waits until another client gets this place.
    pub(crate) async fn lost(&self) {
        self.lost.notified().await;
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.lock().retain(|(_, lost)| !Arc::ptr_eq(lost, &self.lost));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pace::Phase;

    #[test]
    fn the_slowest_client_loses_its_place_and_only_that_one() {
        let places = Places::new(2);
        let [first, second, third, fourth] = [(); 4].map(|()| Arc::new(Pace::new(Duration::from_secs(10))));
        let slow = places.try_enter(&first).unwrap();
        let quick = places.try_enter(&second).unwrap();
        assert!(places.try_enter(&third).is_none(), "nobody is slow yet");
        std::thread::sleep(2 * TOLERATED);
        second.moved(1 << 20);
        let new = places.try_enter(&third).unwrap();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().unwrap();
        runtime.block_on(async {
            tokio::time::timeout(Duration::from_secs(10), slow.lost()).await.unwrap();
            assert!(tokio::time::timeout(TOLERATED, quick.lost()).await.is_err());
        });
        drop(slow);
        assert_eq!(places.lock().len(), 2, "its place was taken, not freed");
        // Those that wait for the server keep their places.
        [&second, &third].iter().for_each(|pace| pace.begin(Phase::Working));
        std::thread::sleep(2 * TOLERATED);
        assert!(places.try_enter(&fourth).is_none());
        drop((quick, new));
        assert_eq!(places.lock().len(), 0);
    }
}
