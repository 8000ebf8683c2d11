//! The times at which a controller looks at the body: again after each period.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The most periods of a run: their times take 8 bytes each.
const MOST_PERIODS: f64 = 1e8;

/// Times at equal distances.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    period: f64,
    /// The first of the times; where the run begins by default.
    epoch: Option<f64>,
}

impl Clock {
    /// # Errors
    /// For a period that is not positive.
    pub(super) fn new(period: f64) -> PyResult<Self> {
        if period > 0.0 && period.is_finite() {
            return Ok(Self {
                period,
                epoch: None,
            });
        }
        Err(PyValueError::new_err(format!(
            "period: must be positive, got {period}"
        )))
    }

    /// Whether it begins with the run.
    pub(super) fn needs_epoch(&self) -> bool {
        self.epoch.is_none()
    }

    pub(super) fn start_at(&mut self, t: f64) {
        self.epoch.get_or_insert(t);
    }

    /// The times after `from`, until `to`, of a run that begins at `from`.
    pub(super) fn times(&self, from: f64, to: f64) -> Vec<f64> {
        let epoch = self.epoch.unwrap_or(from);
        let first = ((from - epoch) / self.period).floor().max(0.0);
        let count = ((to - epoch) / self.period - first).max(0.0);
        let mut times = Vec::new();
        let mut k = 0.0;
        while k <= count {
            times.push(epoch + (first + k) * self.period);
            k += 1.0;
        }
        times
    }

    /// Why a run from one time to another cannot be, if it cannot: that of a load which is `what`, and whose state is not known before
    /// `event`.
    pub(super) fn check(&self, (from, to): (f64, f64), what: &str, event: &str) -> PyResult<()> {
        if to < from {
            return Err(PyValueError::new_err(format!(
                "t: {what} cannot go backward in time: what its states were before {event} is not known"
            )));
        }
        let count = (to - from) / self.period;
        if count > MOST_PERIODS {
            return Err(PyValueError::new_err(format!(
                "period: {:?} makes {count:.1e} updates in this run, more than {MOST_PERIODS:.0e}",
                self.period
            )));
        }
        Ok(())
    }

    /// Whether one of the times is `t`, in a run that began at `start`.
    pub(super) fn is_due(&self, t: f64, start: f64) -> bool {
        let epoch = self.epoch.unwrap_or(start);
        let k = ((t - epoch) / self.period).round();
        k >= 0.0 && t == epoch + k * self.period
    }

    /// The last of the times up to `t`, in a run that began at `start`; before the first one it is that.
    pub(super) fn last(&self, t: f64, start: f64) -> f64 {
        let epoch = self.epoch.unwrap_or(start);
        let k = ((t - epoch) / self.period).floor().max(0.0);
        // The quotient is rounded.
        let is_next = t >= epoch + (k + 1.0) * self.period;
        let is_late = k > 0.0 && t < epoch + k * self.period;
        let k = k + f64::from(u8::from(is_next)) - f64::from(u8::from(is_late));
        epoch + k * self.period
    }
}
