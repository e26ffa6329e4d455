//! Running heavy work without the GIL, so that Ctrl-C ends it and progress is shown.
//!
//! Work runs on a pool of threads, while the calling thread waits for it. Only that thread can be the main thread of
//! Python, which alone handles signals: it looks for them several times a second, and cancels the budget of the work when
//! one raises an exception. Worker threads never touch Python: the waiting thread makes their calls.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use base::{Budget, Exceeded};
use canonform::{Error, Observer};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{Exception, to_python};

/// Time between two looks for signals.
const INTERVAL: Duration = Duration::from_millis(50);

/// Why work did not finish.
pub(crate) enum Stopped {
    /// A signal handler raised this exception.
    Interrupted(PyErr),
    /// The work failed.
    Failed(Error),
}

impl From<Stopped> for PyErr {
    fn from(stopped: Stopped) -> Self {
        match stopped {
            Stopped::Interrupted(exception) => exception,
            Stopped::Failed(fault) => to_python(&fault),
        }
    }
}

impl Stopped {
    /// Whether the budget was cancelled, though not by a signal to this call.
    pub(crate) fn is_cancelled(&self) -> bool {
        matches!(self, Self::Failed(Error::Exceeded(Exceeded::Cancelled)))
    }
}

/// Runs `work` on the pool without the GIL. `progress` is called with the stage, the steps done and all steps, a few times
/// a second.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    budget: &Budget,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&dyn Observer) -> Result<T, Error> + Send,
) -> Result<T, Stopped> {
    run_calling(py, budget, progress, |observer, _| work(observer))
}

/// A call of Python.
type Call = Box<dyn FnOnce(Python<'_>) -> PyResult<()> + Send>;

/// What work tells the thread that waits for it.
enum Message<T> {
    Call(Call),
    Done(Result<T, Error>),
}

/// Makes calls of Python for work.
pub(crate) struct Caller<'a>(&'a dyn Fn(Call));

impl Caller<'_> {
    /// The result of a call. If it raises an exception, that ends the work.
    pub(crate) fn call<T: Send + 'static>(
        &self,
        call: impl FnOnce(Python<'_>) -> PyResult<T> + Send + 'static,
    ) -> Result<T, Error> {
        let (send, receive) = channel();
        (self.0)(Box::new(move |py| {
            let _ = send.send(call(py)?);
            Ok(())
        }));
        receive.recv().map_err(|_| Exceeded::Cancelled.into())
    }
}

/// [`run`] for work that calls Python.
pub(crate) fn run_calling<T: Send>(
    py: Python<'_>,
    budget: &Budget,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&dyn Observer, &Caller<'_>) -> Result<T, Error> + Send,
) -> Result<T, Stopped> {
    let pool = pool().map_err(Stopped::Interrupted)?;
    let watched = Watched { budget: budget.clone(), stage: Mutex::default(), done: AtomicUsize::new(0) };
    let mut exception = None;
    let outcome = py.detach(|| {
        let (watched, exception) = (&watched, &mut exception);
        pool.in_place_scope(|scope| {
            let (send, receive) = channel();
            scope.spawn(move |_| {
                // The receiver waits until it has the result.
                let tell = |message| drop(send.send(message));
                let result = work(watched, &Caller(&|call| tell(Message::Call(call))));
                tell(Message::Done(result));
            });
            loop {
                let raised = match receive.recv_timeout(INTERVAL) {
                    Ok(Message::Done(result)) => return Some(result),
                    // The work has panicked, and the end of the scope passes that on.
                    Err(RecvTimeoutError::Disconnected) => return None,
                    _ if exception.is_some() => continue,
                    Ok(Message::Call(call)) => Python::attach(call),
                    Err(RecvTimeoutError::Timeout) => Python::attach(|py| watched.look(py, progress)),
                };
                if let Err(raised) = raised {
                    *exception = Some(raised);
                    watched.budget.cancel();
                }
            }
        })
    });
    match (outcome, exception) {
        (_, Some(exception)) => Err(Stopped::Interrupted(exception)),
        (Some(result), None) => result.map_err(Stopped::Failed),
        (None, None) => unreachable!("a panic has left the scope"),
    }
}

/// [`run`] with a budget of its own.
pub(crate) fn run_alone<T: Send>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&dyn Observer) -> Result<T, Error> + Send,
) -> PyResult<T> {
    Ok(run(py, &Budget::unlimited(), progress, work)?)
}

/// The state of some work, for the thread that waits for it.
struct Watched {
    budget: Budget,
    stage: Mutex<(String, usize)>,
    done: AtomicUsize,
}

impl Watched {
    /// Handles signals and shows progress.
    fn look(&self, py: Python<'_>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
        py.check_signals()?;
        if let Some(progress) = progress {
            let (stage, total) = self.stage.lock().unwrap_or_else(PoisonError::into_inner).clone();
            if total > 0 {
                progress.call1(py, (stage, self.done.load(Ordering::Relaxed).min(total), total))?;
            }
        }
        Ok(())
    }
}

impl Observer for Watched {
    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn begin(&self, stage: &str, total: usize) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = (stage.to_owned(), total);
        self.done.store(0, Ordering::Relaxed);
    }

    fn step(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }
}

/// The pool, and the process that it belongs to.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The pool of this process. The threads of a pool do not survive `fork`, so a child gets its own.
fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut current = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match current.take() {
        Some((process, pool)) if process == std::process::id() => {
            *current = Some((process, pool.clone()));
            return Ok(pool);
        }
        // Waiting for the threads of the parent would never end.
        Some(of_parent) => std::mem::forget(of_parent),
        None => {}
    }
    let pool = Arc::new(started(0)?);
    *current = Some((std::process::id(), pool.clone()));
    Ok(pool)
}

fn started(n_threads: usize) -> PyResult<ThreadPool> {
    let pool = ThreadPoolBuilder::new().num_threads(n_threads).thread_name(|i| format!("canonform-{i}"));
    pool.build().map_err(|fault| PyRuntimeError::new_err(format!("cannot start threads: {fault}")))
}

/// Sets the number of worker threads, 0 for all cores. Results do not depend on it.
#[pyfunction]
pub(crate) fn set_threads(n: i64) -> PyResult<()> {
    let message = || format!("n={n} is not possible: give a number of threads, or 0 for all cores");
    let n = usize::try_from(n).map_err(|_| Exception::Option.with(&message()))?;
    // The pool of a parent process is left alone.
    drop(pool()?);
    let new = Arc::new(started(n.min(1024))?);
    let old = POOL.lock().unwrap_or_else(PoisonError::into_inner).replace((std::process::id(), new));
    drop(old);
    Ok(())
}

/// The number of worker threads.
#[pyfunction]
pub(crate) fn threads() -> PyResult<usize> {
    Ok(pool()?.current_num_threads())
}
