//! Plays the deformation from flat to full, for looking only: the project and its history stay as they are.

/// Time that the way from flat to full takes, s.
const DURATION: f64 = 3.0;

/// How much of the deformation is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Play {
    /// 0 is flat, 1 is as designed.
    pub(super) amount: f64,
    /// Whether it grows by itself.
    pub(super) is_running: bool,
}

impl Default for Play {
    fn default() -> Self {
        Self { amount: 1.0, is_running: false }
    }
}

impl Play {
    /// From flat, growing by itself.
    pub(super) const START: Self = Self { amount: 0.0, is_running: true };

    /// Held at a part of the deformation.
    pub(super) fn held(amount: f64) -> Self {
        Self { amount: amount.clamp(0.0, 1.0), is_running: false }
    }

    /// Whether less than the whole deformation is shown.
    pub(super) fn is_on(self) -> bool {
        self.amount < 1.0
    }

    /// What it is after `seconds`.
    pub(super) fn after(self, seconds: f64) -> Self {
        let amount = self.amount + seconds / DURATION;
        match self.is_running {
            true if amount < 1.0 => Self { amount, ..self },
            true => Self::default(),
            false => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_play_grows_to_the_whole_and_ends_there() {
        let half = Play::START.after(DURATION / 2.0);
        assert!(half.is_on() && half.is_running && (half.amount - 0.5).abs() < 1e-12, "{half:?}");
        assert_eq!(half.after(DURATION), Play::default(), "as designed");
        assert_eq!(Play::held(0.3).after(DURATION), Play::held(0.3), "held");
    }
}
