//! Where within a step the law of a motion changes.

/// The halvings that find where within a step the law changes.
const HALVINGS: u32 = 55;

/// Why the equations of a motion change after a step.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Landing {
    None,
    Break,
    Flip,
}

/// The search for the first time in a step at which a feedback has changed its sign or ω passed through zero: a look at its end, then halvings.
pub(super) struct Search {
    before: f64,
    after: f64,
    looks: u32,
    has_found: bool,
}

impl Search {
    /// In a step as long as `h`; over at once unless `is_needed`.
    pub(super) fn new(is_needed: bool, h: f64) -> Self {
        Self {
            before: if h.is_finite() { h } else { 0.0 },
            after: h,
            looks: u32::from(is_needed && h.is_finite()),
            has_found: false,
        }
    }

    /// Where to look next, until it is over.
    pub(super) fn time(&self) -> Option<f64> {
        (self.looks > 0).then_some(0.5 * (self.before + self.after))
    }

    /// Goes on with what was seen there.
    pub(super) fn narrow(&mut self, has_flipped: bool) {
        let middle = 0.5 * (self.before + self.after);
        if self.has_found {
            if has_flipped {
                self.after = middle;
            } else {
                self.before = middle;
            }
            self.looks -= 1;
        } else if has_flipped {
            (self.before, self.has_found, self.looks) = (0.0, true, HALVINGS);
        } else {
            self.looks = 0;
        }
    }

    /// The end of the step.
    pub(super) fn end(&self) -> f64 {
        self.after
    }

    pub(super) fn landing(&self) -> Landing {
        if self.has_found {
            Landing::Flip
        } else {
            Landing::None
        }
    }
}
