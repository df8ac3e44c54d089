//! What to draw: plain values with generation numbers, in millimetres.
//!
//! A [`Scene`] is cheap to clone and to compare: its lists are shared and are compared by generation number. The
//! window keeps the arrays that did not change and makes new ones for those that did.

use super::{ColorMap, Gizmo, Vec3};
use std::collections::{HashMap, HashSet};
use std::ops::Deref;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// sRGB-encoded red, green, blue and straight alpha.
pub type Rgba = [u8; 4];

/// An immutable list with a generation number: equal numbers mean equal contents.
#[derive(Clone, Debug)]
pub struct Array<T> {
    generation: u64,
    items: Arc<[T]>,
}

impl<T> Array<T> {
    /// Wraps `items` under a generation number that no other array has.
    #[must_use]
    pub fn new(items: impl Into<Arc<[T]>>) -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        Self { generation: NEXT.fetch_add(1, Ordering::Relaxed), items: items.into() }
    }

    /// The number that changes with the contents; 0 is the empty default.
    #[must_use]
    pub fn generation(&self) -> u64 {
        self.generation
    }
}

impl<T> Default for Array<T> {
    fn default() -> Self {
        Self { generation: 0, items: Arc::new([]) }
    }
}

impl<T> From<Vec<T>> for Array<T> {
    fn from(items: Vec<T>) -> Self {
        Self::new(items)
    }
}

impl<T> Deref for Array<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.items
    }
}

impl<T> PartialEq for Array<T> {
    fn eq(&self, other: &Self) -> bool {
        self.generation == other.generation
    }
}

/// Everything in one picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Colour behind everything; what is seen through it stays clear in a picture.
    pub background: Rgba,
    /// Triangle surfaces.
    pub surfaces: Vec<Surface>,
    /// Line sets: cage edges, wireframes, outlines. Later ones are drawn over earlier ones.
    pub lines: Vec<Lines>,
    /// Points to grab.
    pub handles: Option<Handles>,
    /// Ground grid.
    pub grid: Option<Grid>,
    /// Arrows that move the selection; always on top.
    pub gizmo: Option<Gizmo>,
}

/// Triangles over one list of positions, in parts of one colour each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Vertices, mm.
    pub positions: Array<Vec3>,
    /// What is painted on them. Solid regions that touch should show each shared triangle in one part only.
    pub parts: Vec<Part>,
    /// Scalar field for parts painted [`Paint::Heat`].
    pub scalars: Option<Scalars>,
}

/// The triangles of a surface that look the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Indices into [`Surface::positions`]; counter-clockwise from outside where [`Self::cull_back`] is set.
    pub triangles: Array<[u32; 3]>,
    /// Colour or field.
    pub paint: Paint,
    /// 1 is opaque; less is blended over what lies behind (a ghost, a see-through substrate).
    pub opacity: f32,
    /// Leaves out triangles seen from their back: for closed solids.
    pub cull_back: bool,
}

impl Part {
    /// An opaque part seen from both sides.
    #[must_use]
    pub fn new(triangles: Array<[u32; 3]>, paint: Paint) -> Self {
        Self { triangles, paint, opacity: 1.0, cull_back: false }
    }
}

/// How a part is coloured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint {
    /// One matt colour (alpha is ignored: see [`Part::opacity`]).
    Matt(Rgba),
    /// One colour with the highlights of metal.
    Metal(Rgba),
    /// The surface's scalar field through its colour map, lightly shaded; grey where there is no field.
    Heat,
}

/// A scalar per vertex and how it becomes a colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Scalars {
    /// One finite value per vertex of the surface; with any other count the field is not shown.
    pub values: Array<f32>,
    /// Values at the two ends of the map, in the unit of the field; beyond them the end colours go on.
    pub range: [f32; 2],
    /// The map.
    pub map: ColorMap,
}

impl Scalars {
    /// Place of `value` in the range: 0 at its low end, 1 at its high end, clamped.
    ///
    /// An empty range puts everything at its low end.
    #[must_use]
    pub fn fraction(&self, value: f32) -> f32 {
        let [lo, hi] = self.range;
        if hi > lo { ((value - lo) / (hi - lo)).clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// Straight lines of constant width on the screen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// End points, mm; may be the very array of a surface.
    pub positions: Array<Vec3>,
    /// Pairs of indices into the positions.
    pub edges: Array<[u32; 2]>,
    /// Colour; alpha counts.
    pub color: Rgba,
    /// Width, points.
    pub width: f32,
    /// Factor on the alpha where an opaque surface hides the line: 0 hides it, 1 draws it through.
    pub hidden: f32,
}

/// State of one handle; decides its colour, size and shape.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum HandleState {
    /// At rest: a disc.
    #[default]
    Normal,
    /// Under the pointer: a larger disc.
    Hovered,
    /// Part of the selection: a larger disc.
    Selected,
    /// Not to be moved: a small square.
    Locked,
}

/// Points of constant size on the screen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Handles {
    /// Centers, mm.
    pub positions: Array<Vec3>,
    /// One state per position; missing ones are [`HandleState::Normal`].
    pub states: Array<HandleState>,
    /// Fill for each state, in the order normal, hovered, selected, locked.
    pub fills: [Rgba; 4],
    /// Rim of every handle.
    pub outline: Rgba,
    /// Radius of a normal handle without its rim, points.
    pub radius: f32,
    /// Factor on the alpha where an opaque surface hides the handle.
    pub hidden: f32,
}

/// A grid in a plane of constant z, with the x and y axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Height of the plane, mm.
    pub z: f32,
    /// Distance of thin lines, mm; every tenth line is stronger.
    pub spacing: f32,
    /// Colour of the strong lines; thin ones have less of its alpha.
    pub color: Rgba,
    /// Colours of the x and the y axis.
    pub axes: [Rgba; 2],
}

/// The edges of `triangles`, each once, smaller index first, in ascending order.
#[must_use]
pub fn unique_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let set: HashSet<[u32; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    let mut edges: Vec<[u32; 2]> = set.into_iter().collect();
    edges.sort_unstable();
    edges
}

/// The edges that draw the shape of `triangles`: borders, branches, and folds sharper than `limit` degrees.
///
/// Ascending, smaller index first. Take them from the flat geometry, so that they do not come and go with a bend.
#[must_use]
pub fn crease_edges(positions: &[Vec3], triangles: &[[u32; 3]], limit: f32) -> Vec<[u32; 2]> {
    let mut normals: HashMap<[u32; 2], Vec<Vec3>> = HashMap::new();
    for &[a, b, c] in triangles {
        let [p, q, r] = [a, b, c].map(|v| positions[v as usize]);
        let normal = (q - p).cross(r - p).normalize_or_zero();
        for [from, to] in [[a, b], [b, c], [c, a]] {
            normals.entry([from.min(to), from.max(to)]).or_default().push(normal);
        }
    }
    let least = limit.to_radians().cos();
    let is_flat = |n: &[Vec3]| n.len() == 2 && n[0].dot(n[1]).abs() >= least;
    let mut edges: Vec<[u32; 2]> = normals.into_iter().filter(|(_, n)| !is_flat(n)).map(|(edge, _)| edge).collect();
    edges.sort_unstable();
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_equal_only_to_their_clones() {
        let a = Array::new(vec![1, 2]);
        assert_eq!(a, a.clone(), "a clone shares the generation");
        assert_ne!(a, Array::new(vec![1, 2]), "a new array has a new one");
        assert_eq!(Array::<u8>::default(), Array::default(), "the empty default is one value");
    }

    #[test]
    fn a_square_of_two_triangles_has_five_edges_and_four_creases() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let triangles = [[0, 1, 2], [0, 2, 3]];
        assert_eq!(unique_edges(&triangles), [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]], "with the diagonal");
        let flat = crease_edges(&corners, &triangles, 20.0);
        assert_eq!(flat, [[0, 1], [0, 3], [1, 2], [2, 3]], "the diagonal is flat");
        let folded = corners.map(|p| if p == Vec3::Y { p + Vec3::Z } else { p });
        assert!(crease_edges(&folded, &triangles, 20.0).contains(&[0, 2]), "the diagonal is a fold");
    }

    #[test]
    fn fractions_are_clamped_and_an_empty_range_is_low() {
        let field = |range| Scalars { values: Array::default(), range, map: ColorMap::Viridis };
        let at = |range, value: f32| field(range).fraction(value);
        assert!((at([1.0, 3.0], 2.0) - 0.5).abs() < 1e-6, "the middle");
        assert!(at([1.0, 3.0], 0.0).abs() < 1e-6, "below");
        assert!((at([1.0, 3.0], 9.0) - 1.0).abs() < 1e-6, "above");
        assert!(at([1.0, 1.0], 9.0).abs() < 1e-6, "no range");
    }
}
