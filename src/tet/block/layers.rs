//! The layers of the block, and what each holds over a triangle of the footprint.

use super::footprint::Cover;
use super::{BlockSettings, COAX_ID, GROUND_ID, Metal, PATCH_ID, PIN_ID, SUBSTRATE_ID};
use crate::antenna::PatchParams;
use crate::geometry::RegionId;

/// Thickness of the uppermost substrate layer relative to the lowest: the field is strongest at the patch's rim. Much
/// less flattens the tetrahedra where the footprint is coarse.
const TAPER: f64 = 0.95;
/// Greatest thickness of a layer of the coaxial line, in radii of its outer conductor; its triangles are about as large.
const LINE_LAYER: f64 = 0.25;

/// What a layer belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Line,
    Ground,
    Substrate,
    Patch,
}

/// The planes from below and the parts between them.
#[derive(Clone, Debug)]
pub(super) struct Layers {
    /// Heights of the planes, ascending, m.
    pub(super) planes: Vec<f64>,
    /// One per gap between planes.
    parts: Vec<Part>,
    metal: Metal,
    /// The plane of the substrate's lower face.
    pub(super) ground_plane: usize,
    /// The plane of the substrate's upper face.
    pub(super) patch_plane: usize,
}

impl Layers {
    /// The layers for valid parameters and settings.
    pub(super) fn new(params: &PatchParams, settings: &BlockSettings) -> Self {
        let solid = settings.metal == Metal::Solid;
        let line_top = if solid { params.ground_bottom() } else { -params.height };
        let mut layers = Self {
            planes: vec![if settings.coax { params.port_plane() } else { line_top }],
            parts: Vec::new(),
            metal: settings.metal,
            ground_plane: 0,
            patch_plane: 0,
        };
        if settings.coax {
            let n = ((line_top - params.port_plane()) / (LINE_LAYER * params.coax_radius)).ceil();
            layers.add(Part::Line, line_top, &vec![1.0; whole(n)]);
        }
        if solid {
            layers.add(Part::Ground, -params.height, &[1.0]);
        }
        layers.ground_plane = layers.parts.len();
        let n = settings.layers;
        let taper = |k: usize| 1.0 + (TAPER - 1.0) * k as f64 / (n - 1).max(1) as f64;
        layers.add(Part::Substrate, 0.0, &(0..n).map(taper).collect::<Vec<_>>());
        layers.patch_plane = layers.parts.len();
        if solid {
            layers.add(Part::Patch, params.patch_thickness, &[1.0]);
        }
        layers
    }

    /// Adds layers up to a plane, as thick as the given weights.
    fn add(&mut self, part: Part, top: f64, weights: &[f64]) {
        let bottom = self.planes[self.planes.len() - 1];
        let total: f64 = weights.iter().sum();
        let mut below = 0.0;
        for weight in &weights[..weights.len() - 1] {
            below += weight;
            self.planes.push(bottom + (top - bottom) * (below / total));
        }
        self.planes.push(top);
        self.parts.extend(vec![part; weights.len()]);
    }

    /// The region of the prism over a triangle in the layer above a plane; none outside the block.
    pub(super) fn region(&self, layer: usize, cover: Cover) -> Option<RegionId> {
        let number = match self.parts[layer] {
            Part::Line if cover.sheath => COAX_ID,
            Part::Line if cover.pin => PIN_ID,
            Part::Line => return None,
            Part::Ground if cover.sheath => COAX_ID,
            Part::Ground if cover.pin => PIN_ID,
            Part::Ground => GROUND_ID,
            Part::Substrate if cover.pin => PIN_ID,
            Part::Substrate => SUBSTRATE_ID,
            Part::Patch if cover.patch => PATCH_ID,
            Part::Patch => return None,
        };
        Some(RegionId::new(number))
    }

    /// True if patch and ground are sheets on the substrate.
    pub(super) fn has_sheets(&self) -> bool {
        self.metal == Metal::Sheet
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive count")]
fn whole(count: f64) -> usize {
    count.max(1.0) as usize
}
