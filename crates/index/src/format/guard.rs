//! A boundary that turns panics of the storage library into errors.
//!
//! redb trusts its own files and panics when they contradict themselves. Checksums exclude accidents, but a file from
//! elsewhere may have been changed together with its checksums. So every call of redb goes through [`guarded`], also
//! when a value of redb is dropped.

use std::cell::Cell;
use std::ops::{Deref, DerefMut};
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether this thread is inside [`guarded`], where panics are not printed.
    static IS_GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work` and returns the message of its panic, if it panics. Nothing is printed then.
pub(super) fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    static SILENT_HOOK: Once = Once::new();
    SILENT_HOOK.call_once(|| {
        let usual = take_hook();
        set_hook(Box::new(move |panic| {
            if !IS_GUARDED.get() {
                usual(panic);
            }
        }));
    });
    let outer = IS_GUARDED.replace(true);
    // A value that was used during a panic is used again only through this function, or dropped.
    let result = catch_unwind(AssertUnwindSafe(work));
    IS_GUARDED.set(outer);
    result.map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message").to_owned()
    })
}

/// A value of redb, whose destructor may panic.
#[derive(Debug)]
pub(crate) struct Guarded<T>(Option<T>);

impl<T> Guarded<T> {
    pub(crate) fn new(value: T) -> Self {
        Self(Some(value))
    }

    pub(super) fn into_inner(mut self) -> Option<T> {
        self.0.take()
    }
}

impl<T> Deref for Guarded<T> {
    type Target = T;

    fn deref(&self) -> &T {
        match &self.0 {
            Some(value) => value,
            None => unreachable!("the value is taken by consuming functions only"),
        }
    }
}

impl<T> DerefMut for Guarded<T> {
    fn deref_mut(&mut self) -> &mut T {
        match &mut self.0 {
            Some(value) => value,
            None => unreachable!("the value is taken by consuming functions only"),
        }
    }
}

impl<T> Drop for Guarded<T> {
    fn drop(&mut self) {
        let value = self.0.take();
        // What has been committed is on disk already.
        let _ = guarded(|| drop(value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Bomb;

    impl Drop for Bomb {
        fn drop(&mut self) {
            panic!("dropped");
        }
    }

    #[test]
    fn panics_become_messages() {
        assert_eq!(guarded(|| 7), Ok(7));
        assert_eq!(guarded(|| panic!("page {}", 3)), Err::<(), _>("page 3".to_owned()));
        assert_eq!(guarded(|| panic!("plain")), Err::<(), _>("plain".to_owned()));
        // A panic inside leaves the outer one guarded.
        assert_eq!(
            guarded(|| {
                let _ = guarded(|| panic!("inner"));
                panic!("outer")
            }),
            Err::<(), _>("outer".to_owned())
        );
        drop(Guarded::new(Bomb));
    }
}
