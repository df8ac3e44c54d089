//! Axes: the range of the data, round ticks, and where a value lies along the axis.

/// How values are spread along an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Scale {
    /// Evenly, with round ticks.
    Linear,
    /// By their logarithm, with the ticks given; powers of ten where none are.
    Log(Vec<f64>),
}

/// A label with its unit, and a scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What is laid off, with its unit.
    pub label: String,
    scale: Scale,
}

impl Axis {
    /// An axis with even steps.
    #[must_use]
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), scale: Scale::Linear }
    }

    /// A logarithmic axis with the ticks given, or powers of ten where none are.
    #[must_use]
    pub fn log(label: &str, ticks: &[f64]) -> Self {
        Self { label: label.to_owned(), scale: Scale::Log(ticks.to_vec()) }
    }

    /// Ticks and range for some values.
    pub(super) fn spread(&self, values: impl Iterator<Item = f64>) -> Spread {
        let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        match &self.scale {
            Scale::Linear if lo <= hi => linear(lo, hi),
            Scale::Linear => linear(0.0, 1.0),
            Scale::Log(ticks) if ticks.is_empty() && lo <= hi => decades(lo, hi),
            Scale::Log(ticks) => {
                let (first, last) = (ticks[0].min(lo), ticks[ticks.len() - 1].max(hi));
                let margin = (last / first).powf(0.02);
                Spread { lo: first / margin, hi: last * margin, ticks: ticks.clone(), log: true }
            }
        }
    }
}

/// Room between the data and the frame, as part of the data's range.
const MARGIN: f64 = 0.04;
/// Wanted number of intervals between ticks.
const INTERVALS: f64 = 6.0;

fn linear(lo: f64, hi: f64) -> Spread {
    let (lo, hi) = if hi > lo { (lo, hi) } else { (lo - 0.5, hi + 0.5) };
    let rough = (hi - lo) / INTERVALS;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().find(|m| m * power >= rough).unwrap_or(10.0) * power;
    let margin = MARGIN * (hi - lo);
    let (lo, hi) = (lo - margin, hi + margin);
    let (first, last) = ((lo / step).ceil(), (hi / step).floor());
    let ticks: Vec<f64> = (0..=(last - first) as usize).map(|i| (first + i as f64) * step).collect();
    Spread { lo, hi, ticks, log: false }
}

fn decades(lo: f64, hi: f64) -> Spread {
    let (first, last) = (lo.max(f64::MIN_POSITIVE).log10().floor() as i32, hi.max(1e-300).log10().ceil() as i32);
    let last = last.max(first + 1);
    let ticks: Vec<f64> = (first..=last).map(|e| 10_f64.powi(e)).collect();
    Spread { lo: ticks[0], hi: ticks[ticks.len() - 1], ticks, log: true }
}

/// A range with its ticks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spread {
    pub(super) lo: f64,
    pub(super) hi: f64,
    pub(super) ticks: Vec<f64>,
    pub(super) log: bool,
}

impl Spread {
    /// Place of a value: 0 at the lower end, 1 at the upper.
    pub(super) fn place(&self, value: f64) -> f64 {
        if self.log {
            (value / self.lo).ln() / (self.hi / self.lo).ln()
        } else {
            (value - self.lo) / (self.hi - self.lo)
        }
    }

    /// The text of a tick: as few digits as tell it from its neighbors, with a true minus sign.
    pub(super) fn text(&self, tick: f64) -> String {
        let step = if self.log { tick } else { self.ticks[1] - self.ticks[0] };
        // Two digits more than the step's magnitude at most; trailing zeros are cut for all ticks alike.
        let decimals = (0..12).find(|&d| is_whole(step * 10_f64.powi(d))).unwrap_or(2);
        let text = format!("{tick:.*}", decimals as usize);
        let text = if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
            text.trim_start_matches('-').to_owned()
        } else {
            text
        };
        text.replace('-', "\u{2212}")
    }
}

fn is_whole(value: f64) -> bool {
    (value - value.round()).abs() < 1e-6 * value.abs().max(1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_ticks_are_round_and_cover_the_data() {
        for (lo, hi) in [(-17.9, 0.4), (0.0, 1.0), (8.1, 12.8), (-0.003, 0.0009), (5.0, 5.0)] {
            let spread = Axis::linear("").spread([lo, hi].into_iter());
            assert!(spread.lo <= lo && spread.hi >= hi, "{lo} {hi}: {spread:?}");
            assert!((4..=9).contains(&spread.ticks.len()), "{spread:?}");
            let steps: Vec<f64> = spread.ticks.windows(2).map(|t| spread.place(t[1]) - spread.place(t[0])).collect();
            assert!(steps.iter().all(|s| (s - steps[0]).abs() < 1e-12), "even: {spread:?}");
        }
        let spread = Axis::linear("").spread([-17.9, 0.4].into_iter());
        let texts: Vec<String> = spread.ticks.iter().map(|&t| spread.text(t)).collect();
        assert_eq!(texts, ["\u{2212}15", "\u{2212}10", "\u{2212}5", "0"], "texts");
    }

    #[test]
    fn logarithmic_places_are_even_in_ratio() {
        let spread = Axis::log("", &[4.0, 10.0, 100.0]).spread([4.2, 100.0].into_iter());
        let step = spread.place(20.0) - spread.place(10.0);
        assert!((spread.place(100.0) - spread.place(50.0) - step).abs() < 1e-12, "equal ratios, equal steps");
        assert_eq!(spread.text(10.0), "10", "text");
        let errors = Axis::log("", &[]).spread([3e-4, 0.11].into_iter());
        assert_eq!(errors.ticks.len(), 5, "1e-4 to 1: {errors:?}");
        assert_eq!(errors.text(errors.ticks[0]), "0.0001", "small tick");
    }
}
