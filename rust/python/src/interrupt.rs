//! Ctrl-C and progress for long runs.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

use polhode::parallel::Watch;
use pyo3::prelude::*;

/// How often Python is asked for signals, in milliseconds: fast enough to feel immediate, rare enough to cost nothing.
const INTERVAL: u64 = 20;
/// How often a progress callback is told, in milliseconds.
const TELLING: u64 = 50;
/// For how long a run is silent on a terminal: most are over by then.
const SILENT: Duration = Duration::from_secs(2);
/// How long a pass over many rows holds Python alone.
const HOLD: Duration = Duration::from_millis(20);

/// The beat of a pass over many rows that holds the GIL: Ctrl-C ends it, other threads of Python have their turn.
pub(crate) struct Beat<'py> {
    py: Python<'py>,
    /// When Python was looked at last; short passes never ask for the time.
    looked: Option<Instant>,
    begun: bool,
}

impl<'py> Beat<'py> {
    pub(crate) fn new(py: Python<'py>) -> Self {
        Self {
            py,
            looked: None,
            begun: false,
        }
    }

    /// Called between blocks of rows, each of far less than a hundredth of a second.
    pub(crate) fn mark(&mut self) -> PyResult<()> {
        if !self.begun {
            self.begun = true;
            return Ok(());
        }
        let looked = *self.looked.get_or_insert_with(Instant::now);
        if looked.elapsed() >= HOLD {
            self.py.check_signals()?;
            self.py.detach(|| ());
            self.looked = Some(Instant::now());
        }
        Ok(())
    }
}

/// The bar that shows on a terminal how far a run is.
enum Bar {
    Unasked,
    /// Nobody would see it.
    Nowhere,
    Shown(Py<PyAny>),
}

/// A run that Python may stop: by Ctrl-C, or by an exception from its progress callback.
pub(crate) struct Interrupt {
    start: Instant,
    /// When Python is to be asked next, in milliseconds since the start: with a progress callback at once, so that the
    /// quickest run tells of itself too.
    due: AtomicU64,
    interval: u64,
    stopped: AtomicBool,
    error: Mutex<Option<PyErr>>,
    progress: Option<Py<PyAny>>,
    /// The bar of a long run without such a callback.
    bar: Mutex<Bar>,
    /// The thread that called: signals of Python are seen by its main thread alone, so no other one may ask in its place.
    caller: ThreadId,
}

impl Interrupt {
    pub(crate) fn new(progress: Option<Py<PyAny>>) -> Self {
        Self {
            caller: thread::current().id(),
            start: Instant::now(),
            due: AtomicU64::new(if progress.is_some() { 0 } else { INTERVAL }),
            interval: if progress.is_some() {
                TELLING
            } else {
                INTERVAL
            },
            stopped: AtomicBool::new(false),
            error: Mutex::new(None),
            progress,
            bar: Mutex::new(Bar::Unasked),
        }
    }

    /// Asks Python, when it is time to, whether to go on; tells the progress callback the fraction done, when given one.
    ///
    /// Called from any thread, attached or not; the thread that called the package asks, the others hear the answer.
    pub(crate) fn poll(&self, fraction: Option<f64>) -> ControlFlow<()> {
        let now = u64::try_from(self.start.elapsed().as_millis()).unwrap_or(u64::MAX - TELLING);
        if now >= self.due.load(Ordering::Relaxed) && thread::current().id() == self.caller {
            self.due.store(now + self.interval, Ordering::Relaxed);
            self.ask(fraction);
        }
        if self.stopped.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn ask(&self, fraction: Option<f64>) {
        let answer = Python::attach(|py| {
            py.check_signals()?;
            match (&self.progress, fraction) {
                (Some(progress), Some(fraction)) => progress.call1(py, (fraction,)).map(|_| ()),
                (None, Some(fraction)) if self.start.elapsed() >= SILENT => self.show(py, fraction),
                _ => Ok(()),
            }
        });
        if let Err(error) = answer {
            self.stop(error);
        }
    }

    /// Shows how far a long run is, where stderr is a terminal.
    fn show(&self, py: Python<'_>, fraction: f64) -> PyResult<()> {
        let mut bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        if matches!(*bar, Bar::Unasked) {
            let made = py
                .import("polhode._progress")?
                .call_method0("bar_of_core")?;
            *bar = if made.is_none() {
                Bar::Nowhere
            } else {
                Bar::Shown(made.unbind())
            };
        }
        if let Bar::Shown(bar) = &*bar {
            bar.call_method1(py, "tell", (fraction,))?;
        }
        Ok(())
    }

    /// Ends the run by this exception, unless another one has done so.
    pub(crate) fn stop(&self, error: PyErr) {
        self.error
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .get_or_insert(error);
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Whether an exception ends the run.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// The end of the run: the exception that stopped it, or a last word to the progress callback when it is complete.
    pub(crate) fn finish(self, py: Python<'_>, complete: bool) -> PyResult<()> {
        let bar = self.bar.into_inner();
        if let Bar::Shown(bar) = bar.unwrap_or_else(PoisonError::into_inner) {
            bar.call_method0(py, "clear")?;
        }
        if let Some(error) = self
            .error
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
        {
            return Err(error);
        }
        if let Some(progress) = self.progress
            && complete
        {
            progress.call1(py, (1.0,))?;
        }
        Ok(())
    }
}

/// Work that Ctrl-C may end, without the interpreter lock.
pub(crate) fn watched<R: Send>(
    py: Python<'_>,
    work: impl FnOnce(&mut Watch<'_>) -> R + Send,
) -> PyResult<R> {
    let interrupt = Interrupt::new(None);
    let result = py.detach(|| work(&mut |_| interrupt.poll(None)));
    interrupt.finish(py, false)?;
    Ok(result)
}
