//! Running heavy work without the GIL, so that Ctrl-C ends it and progress is shown.
//!
//! Work runs on a pool of threads, while the calling thread waits for it. Only that thread can be the main thread of
//! Python, which alone handles signals: it looks for them several times a second, and cancels the budget of the work when
//! one raises an exception. Worker threads never touch Python.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use base::{Budget, Exceeded};
use canonform::library::ShapeLimits;
use canonform::{Error, Observer, Progress, Watched};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{Exception, raised, to_python};
use crate::settings::time_limit;

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

/// What the keywords of a call of Python say about the work that it does.
#[derive(Default)]
struct Keywords {
    /// Called with the stage, the steps done and all steps, a few times a second.
    progress: Option<Py<PyAny>>,
    /// The limits, from the beginning of the call.
    budget: Budget,
    threads: Option<usize>,
}

thread_local! {
    /// Those of the calls that this thread is in, the innermost last.
    static CALLS: RefCell<Vec<Arc<Keywords>>> = const { RefCell::new(Vec::new()) };
}

/// Begins a call with these keywords: all work until [`end_call`] is under its limits.
#[pyfunction]
pub(crate) fn begin_call(
    progress: Option<Py<PyAny>>,
    timeout: Option<f64>,
    memory: Option<usize>,
    threads: Option<usize>,
) -> PyResult<()> {
    let limits = ShapeLimits { max_vertices: None, time: time_limit(timeout)?, memory };
    let budget = limits.budget(Budget::unlimited());
    CALLS.with_borrow_mut(|calls| calls.push(Arc::new(Keywords { progress, budget, threads })));
    Ok(())
}

/// Raises an exception if a limit of the call does not suffice, or it needs so many bytes more than it may use: for work in Python.
#[pyfunction]
pub(crate) fn check_call(needed: usize) -> PyResult<()> {
    let budget = &Keywords::current().budget;
    raised(budget.check().and_then(|()| budget.check_memory(needed)))
}

/// Ends the call that began last.
#[pyfunction]
pub(crate) fn end_call() {
    CALLS.with_borrow_mut(|calls| drop(calls.pop()));
}

impl Keywords {
    /// Those of the innermost call.
    fn current() -> Arc<Self> {
        CALLS.with_borrow(|calls| calls.last().cloned()).unwrap_or_default()
    }

    /// Handles signals, shows the progress of work, and looks at the clock for work whose budget does not.
    fn look(&self, py: Python<'_>, watched: &Watched) -> PyResult<()> {
        py.check_signals()?;
        raised(self.budget.check())?;
        let Progress { stage, done, total } = watched.progress();
        if let Some(progress) = self.progress.as_ref().filter(|_| total > 0) {
            progress.call1(py, (stage, done.min(total), total))?;
        }
        Ok(())
    }
}

/// The limit on memory of the current call.
pub(crate) fn memory_limit() -> Option<usize> {
    Keywords::current().budget.memory()
}

/// Runs `work` on the pool without the GIL, as the keywords of the call say.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&dyn Observer) -> Result<T, Error> + Send,
) -> PyResult<T> {
    Ok(run_within(py, &Keywords::current().budget, work)?)
}

/// [`run`] with a budget of its own, which is cancelled when that of the call is over.
pub(crate) fn run_within<T: Send>(
    py: Python<'_>,
    budget: &Budget,
    work: impl FnOnce(&dyn Observer) -> Result<T, Error> + Send,
) -> Result<T, Stopped> {
    let call = Keywords::current();
    let over = |fault: Exceeded| Stopped::Interrupted(to_python(&fault.into()));
    call.budget.check().map_err(over)?;
    let pool = pool(call.threads).map_err(Stopped::Interrupted)?;
    let watched = Watched::new(budget.clone());
    let mut exception = None;
    let outcome = py.detach(|| {
        let (watched, exception) = (&watched, &mut exception);
        pool.in_place_scope(|scope| {
            let (send, receive) = channel();
            // The receiver waits until it has the result.
            scope.spawn(move |_| drop(send.send(work(watched))));
            loop {
                match receive.recv_timeout(INTERVAL) {
                    Ok(result) => return Some(result),
                    // The work has panicked, and the end of the scope passes that on.
                    Err(RecvTimeoutError::Disconnected) => return None,
                    Err(RecvTimeoutError::Timeout) if exception.is_some() => {}
                    Err(RecvTimeoutError::Timeout) => {
                        if let Err(raised) = Python::attach(|py| call.look(py, watched)) {
                            *exception = Some(raised);
                            watched.budget.cancel();
                        }
                    }
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

/// The pools of a process, by their number of threads.
struct Pools {
    process: u32,
    /// The number that [`set_threads`] has set.
    usual: Option<usize>,
    started: BTreeMap<usize, Arc<ThreadPool>>,
}

static POOLS: Mutex<Pools> = Mutex::new(Pools { process: 0, usual: None, started: BTreeMap::new() });

fn pools() -> MutexGuard<'static, Pools> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if pools.process != std::process::id() {
        // The threads of a pool do not survive `fork`, and waiting for those of the parent would never end.
        std::mem::forget(std::mem::take(&mut pools.started));
        pools.process = std::process::id();
    }
    pools
}

/// Where the number of threads comes from unless a call or [`set_threads`] says it, the first that is set: the parent of this
/// process, users of Rust, and those of most other libraries.
const VARIABLES: [&str; 3] = [OF_PARENT, "RAYON_NUM_THREADS", "OMP_NUM_THREADS"];
const OF_PARENT: &str = "CANONFORM_NUM_THREADS";

/// A pool of so many threads; by default the usual number, 0 for all cores.
fn pool(n_threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let mut pools = pools();
    let stated = || VARIABLES.iter().find_map(|name| std::env::var(name).ok()?.parse().ok());
    let n = n_threads.or(pools.usual).or_else(stated).unwrap_or(0).min(1024);
    if let Some(pool) = pools.started.get(&n) {
        return Ok(pool.clone());
    }
    let builder = ThreadPoolBuilder::new().num_threads(n).thread_name(|i| format!("canonform-{i}"));
    let pool =
        builder.build().map_err(|fault| PyRuntimeError::new_err(format!("cannot start threads: {fault}")))?;
    Ok(pools.started.entry(n).or_insert(Arc::new(pool)).clone())
}

/// Sets the number of worker threads, 0 for all cores. Results do not depend on it. Processes that are started from now on
/// have the same number.
#[pyfunction]
pub(crate) fn set_threads(py: Python<'_>, n: i64) -> PyResult<()> {
    let message = || format!("n={n} is not possible: give a number of threads, or 0 for all cores");
    let n = usize::try_from(n).map_err(|_| Exception::OptionError.with(message()))?;
    py.import("os")?.getattr("environ")?.set_item(OF_PARENT, n.to_string())?;
    let others = {
        let mut pools = pools();
        pools.usual = Some(n);
        std::mem::take(&mut pools.started)
    };
    drop(others);
    Ok(())
}

/// The number of worker threads.
#[pyfunction]
pub(crate) fn threads() -> PyResult<usize> {
    Ok(pool(None)?.current_num_threads())
}
