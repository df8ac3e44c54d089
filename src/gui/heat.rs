//! What is painted on the antenna: which quantity, of which part, and how much of the surface has which value.

use super::ui_state::{Heat, HeatPart};
use crate::antenna::{COAX, GROUND, PATCH, PIN, SUBSTRATE};
use crate::geometry::Plc;
use crate::pipeline::Deformed;
use crate::render::{Array, ColorMap, Vec3};
use crate::units::to_mm;
use std::sync::Arc;

/// Bins of the histogram.
pub(super) const N_BINS: usize = 32;
/// Least width of the scale, in the quantity's unit: below it, rounding noise would be painted as blotches at rest.
const LEAST_RANGE: f32 = 0.01;

/// The computed antenna on show, and a number that tells it from others.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnShow<'a> {
    pub(super) deformed: &'a Deformed,
    pub(super) serial: u64,
}

impl Heat {
    /// Unit of the values.
    pub(super) fn unit(self) -> &'static str {
        if self == Self::Distance { "µm" } else { "%" }
    }

    /// The colours: diverging for signed values.
    pub(super) fn map(self) -> ColorMap {
        if self == Self::Distance { ColorMap::Viridis } else { ColorMap::CoolWarm }
    }

    /// A value with its unit.
    pub(super) fn value_text(self, value: f32) -> String {
        match self {
            Self::Distance => format!("{value:.1} µm"),
            _ => format!("{value:+.2} %"),
        }
    }

    /// The value at each vertex in its unit; `None` where the antenna on show has none.
    fn values(self, deformed: &Deformed) -> Option<Vec<f32>> {
        let fields = &deformed.fields;
        let percent = |ratios: &[f64]| ratios.iter().map(|v| (100.0 * (v - 1.0)) as f32).collect::<Vec<f32>>();
        let values = match self {
            Self::None => return None,
            Self::Area => percent(&fields.area_ratio),
            Self::MaxStrain => percent(&fields.stretch_max),
            Self::MinStrain => percent(&fields.stretch_min),
            Self::Thickness => percent(&fields.thickness),
            Self::Distance => {
                let pairs = deformed.positions.iter().zip(&fields.on_cylinder);
                pairs.map(|(p, ideal)| (to_mm(p.distance(*ideal)) * 1e3) as f32).collect()
            }
        };
        (values.len() == deformed.positions.len()).then_some(values)
    }
}

impl HeatPart {
    /// Whether a region is painted.
    pub(super) fn paints(self, region: &str) -> bool {
        match self {
            Self::All => !matches!(region, PIN | COAX),
            Self::Patch => region == PATCH,
            Self::Substrate => region == SUBSTRATE,
            Self::Ground => region == GROUND,
        }
    }

    /// Whether a region decides the range of the scale: of strains on all parts the patch, for it matters most, and the
    /// bend itself strains the ground much more.
    fn rules(self, heat: Heat, region: &str, has_patch: bool) -> bool {
        let is_strain = matches!(heat, Heat::Area | Heat::MaxStrain | Heat::MinStrain);
        if self == Self::All && is_strain && has_patch { region == PATCH } else { self.paints(region) }
    }
}

/// A quantity on the antenna, in its unit.
#[derive(Clone, Debug)]
pub(super) struct Heated {
    /// One per vertex.
    pub(super) values: Array<f32>,
    /// Ends of the scale, by the values of the part that matters.
    pub(super) auto: [f32; 2],
    /// Value and flat area, mm², of each painted facet in the planes of its part. The thin walls, which the bend itself
    /// strains, do not count.
    facets: Arc<[[f32; 2]]>,
}

impl Heated {
    /// The quantity on an antenna; `None` where it has none.
    ///
    /// * `regions`: the triangles that are seen of each region.
    pub(super) fn new<'a>(
        heat: Heat,
        part: HeatPart,
        deformed: &Deformed,
        regions: impl Iterator<Item = (&'a str, &'a [[u32; 3]])>,
    ) -> Option<Self> {
        let values = heat.values(deformed)?;
        let flat: &Plc = &deformed.flat;
        let has_patch = flat.region(PATCH).is_some();
        let mut facets = Vec::new();
        let mut greatest = 0.0_f32;
        for (region, triangles) in regions.filter(|(region, _)| part.paints(region)) {
            for triangle in triangles {
                let [a, b, c] = triangle.map(|v| flat.vertices[v as usize]);
                if (a.z - b.z).abs().max((a.z - c.z).abs()) > 0.0 {
                    continue;
                }
                let own = triangle.map(|v| values[v as usize]);
                if part.rules(heat, region, has_patch) {
                    greatest = own.iter().filter(|v| v.is_finite()).fold(greatest, |m, v| m.max(v.abs()));
                }
                let area = (b - a).cross(c - a).length() / 2.0 * to_mm(1.0).powi(2);
                facets.push([own.iter().sum::<f32>() / 3.0, area as f32]);
            }
        }
        let hi = greatest.max(LEAST_RANGE);
        let lo = if heat == Heat::Distance { 0.0 } else { -hi };
        Some(Self { values: Array::new(values), auto: [lo, hi], facets: facets.into() })
    }

    /// The part of the area, percent, whose value lies in each of [`N_BINS`] even steps from `lo` to `hi`; what lies
    /// beyond counts in the first and the last.
    pub(super) fn bins(&self, [lo, hi]: [f32; 2]) -> [f64; N_BINS] {
        let mut bins = [0.0; N_BINS];
        let whole: f32 = self.facets.iter().map(|f| f[1]).sum();
        for [value, area] in self.facets.iter() {
            let place = (value - lo) / (hi - lo) * N_BINS as f32;
            bins[(place.max(0.0) as usize).min(N_BINS - 1)] += f64::from(100.0 * area / whole.max(f32::MIN_POSITIVE));
        }
        bins
    }

    /// Mean over the area, and the least and the greatest value of a facet.
    pub(super) fn summary(&self) -> [f32; 3] {
        let sums = self.facets.iter().fold([0.0_f32; 2], |[v, a], f| [v + f[0] * f[1], a + f[1]]);
        let ends =
            self.facets.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[lo, hi], f| [lo.min(f[0]), hi.max(f[0])]);
        if self.facets.is_empty() { [0.0; 3] } else { [sums[0] / sums[1], ends[0], ends[1]] }
    }
}

/// Places on a scale of colours, from the top.
pub(super) fn ticks(heat: Heat, [lo, hi]: [f32; 2]) -> [String; 5] {
    let digits = match hi - lo {
        width if width < 2.0 => 2,
        width if width < 100.0 => 1,
        _ => 0,
    };
    [0, 1, 2, 3, 4].map(|k: u8| {
        // Adding zero turns -0 round.
        let value = hi + (lo - hi) * f32::from(k) / 4.0 + 0.0;
        let is_zero = value.abs() < 0.5 * 10_f32.powi(-digits);
        match heat {
            _ if is_zero => format!("0 {}", heat.unit()),
            Heat::Distance => format!("{value:.0$} µm", digits as usize),
            _ => format!("{value:+.0$} %", digits as usize),
        }
    })
}

/// A scale of colours at the view's right.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bar {
    pub(super) map: ColorMap,
    pub(super) title: String,
    /// Values in equal steps, from the top.
    pub(super) ticks: [String; 5],
}

/// The exact cylinder drawn through the antenna: its places, mm.
pub(super) fn ghost(deformed: &Deformed) -> Option<Vec<Vec3>> {
    let places = &deformed.fields.on_cylinder;
    (!places.is_empty()).then(|| super::scene::to_picture(places))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gui::session::first_project;
    use crate::pipeline::deform;
    use crate::task::Task;

    #[test]
    fn the_histogram_is_of_the_area_and_complete() {
        let deformed = deform(&first_project(), &Task::default()).expect("the first project");
        let all: Vec<[u32; 3]> = deformed.flat.facets.iter().map(|f| f.vertices.map(|v| v.raw())).collect();
        for heat in Heat::ALL.into_iter().filter(|h| *h != Heat::None) {
            let heated =
                Heated::new(heat, HeatPart::Patch, &deformed, [(PATCH, &all[..])].into_iter()).expect("painted");
            let bins = heated.bins(heated.auto);
            assert!((bins.iter().sum::<f64>() - 100.0).abs() < 0.1, "{heat:?}: {bins:?}");
            let [mean, lo, hi] = heated.summary();
            assert!(lo <= mean && mean <= hi && heated.auto[1] >= hi, "{heat:?}: {mean} in {lo} to {hi}");
            let narrow = heated.bins([lo, mean]);
            assert!((narrow.iter().sum::<f64>() - 100.0).abs() < 0.1, "{heat:?}: nothing is lost beyond the ends");
        }
        let figures = deformed.figures.as_ref().expect("the template's");
        let thin = Heated::new(Heat::Thickness, HeatPart::Patch, &deformed, [(PATCH, &all[..])].into_iter());
        let mean = f64::from(thin.expect("measured").summary()[0]) / 100.0;
        assert!((mean - figures.thickness_error).abs() < 0.02, "{mean} beside the figure");
    }

    #[test]
    fn ticks_have_a_unit_and_no_negative_zero() {
        assert_eq!(ticks(Heat::Area, [-0.5, 0.5]), ["+0.50 %", "+0.25 %", "0 %", "-0.25 %", "-0.50 %"], "signed");
        assert_eq!(ticks(Heat::Distance, [0.0, 40.0])[..2], ["40.0 µm", "30.0 µm"], "length");
        assert_eq!(ticks(Heat::Distance, [0.0, 400.0])[..2], ["400 µm", "300 µm"], "greater length");
    }
}
