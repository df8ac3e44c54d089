//! Carries the whole antenna: pre-warp, Green coordinates, and the rigid feed.
//!
//! Enters: points of the flat antenna as drawn. Leaves: their deformed positions, and for each the rest point that
//! Green coordinates act on, so that a drag can move them again without this computation.
//!
//! The coaxial line is rigid: it does not bend with the sheet. In each plane of the sheet the flat coordinates near the
//! feed are shifted so that their images lie on a straight cylinder along the posed normal at the feed point: within
//! the rigid radius a point's image keeps its flat distance from the axis, beyond it the shift fades out. The rigid
//! radius shrinks from the outer conductor's at the ground to the pin's at the patch, so that the patch's rim stays
//! where the compensation put it. Below the ground the line is swept straight to a flat port plane. All parts go
//! through this one map, so their interfaces stay shared.
//!
//! Not handled: a feed whose line would run into the bent sheet itself (the crossing test of the surface finds it).

use super::split::Image;
use super::{DeformError, SmoothMap, Warp};
use crate::geometry::{DMat2, DMat3, DVec2, DVec3};
use crate::units::to_mm;
use rayon::prelude::*;
use std::cell::RefCell;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// The feed in the flat frame, lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidFeed {
    /// Place of the axis.
    pub center: DVec2,
    /// Radius of the pin: rigid from the ground to the patch.
    pub pin_radius: f64,
    /// Radius of the outer conductor: rigid in the ground.
    pub coax_radius: f64,
    /// Distance over which the shift fades out around the pin in the patch's plane: it should end before the rim.
    pub pin_fade: f64,
    /// Distance over which it fades out around the line in the ground: it should end before the ground does. The
    /// shorter, the less the sheet may be compressed before it folds there.
    pub coax_fade: f64,
    /// Height of the substrate's lower face (negative).
    pub substrate_bottom: f64,
    /// Height of the ground's lower face, where the line begins (negative).
    pub line_top: f64,
    /// Height of the port plane (negative).
    pub port_plane: f64,
}

/// Newton's method ends when a point's image is this close to the cylinder, relative to the outer radius: a picometre.
const CONVERGED: f64 = 1e-9;
/// Newton's method takes 3 to 4 steps for usual bends, some more where the line barely fits.
const MAX_STEPS: usize = 24;
/// Angles at which the shift on the rim is solved for first; see [`Disc`].
const RIM_NODES: usize = 24;
/// Where the line barely fits, the shift is steep: the nodes are doubled up to this many.
const MAX_RIM_NODES: usize = 768;
/// Greatest last harmonics of the rim, relative to the outer radius: a fifth of a nanometre. What they leave out is a
/// step in the map at the rim, which edge splitting would try to follow if it were near its tolerance.
const RIM_TAIL: f64 = 1e-7;
/// Angles of the ring at half the radius.
const INNER_NODES: usize = 12;
/// Longest step, in outer radii: a nearly upright sheet asks for steps out of the cage.
const STRIDE: f64 = 0.3;
/// The sheet stands along the axis, to rounding, where a flat area projects to less than this part of itself.
const UPRIGHT: f64 = 1e-6;

/// Why the feed cannot follow.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FeedError {
    /// The sheet turns away under the coaxial line.
    #[error(
        "the coaxial line of radius {radius_mm:.3} mm does not fit the bend at height {height_mm:.3} mm: increase the \
         bend radius, choose a thinner line, or compensate isometrically (an uncompensated bend is tighter than it says)"
    )]
    DoesNotFit {
        /// Radius that could not be met, mm.
        radius_mm: f64,
        /// Height of the plane in the flat antenna, mm.
        height_mm: f64,
    },
    /// The port plane would lie within the ground.
    #[error("the coaxial line ends inside the bent ground: coax_length must be more than {needed_mm:.3} mm")]
    LineTooShort {
        /// Smallest length, mm.
        needed_mm: f64,
    },
}

/// The posed frame of the feed: origin on the patch's bottom plane, third axis along the posed normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedFrame {
    origin: DVec3,
    axes: DMat3,
}

impl FeedFrame {
    /// Local coordinates of a point: lateral two, then height along the axis.
    fn local(&self, p: DVec3) -> DVec3 {
        self.axes.transpose() * (p - self.origin)
    }
}

/// Where each vertex of the surface sits for Green coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// Rest point in the cage, m; for a vertex of the line below the ground: the point of the ground above it.
    pub rest: Vec<DVec3>,
    /// How far along the line below the ground: 0 for the sheet, 1 on the port plane.
    pub sweep: Vec<f64>,
}

impl FromIterator<Carried> for Placement {
    fn from_iter<I: IntoIterator<Item = Carried>>(points: I) -> Self {
        let (rest, sweep) = points.into_iter().map(|p| (p.rest, p.sweep)).unzip();
        Self { rest, sweep }
    }
}

/// A carried point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// Where it is, m.
    pub position: DVec3,
    /// Its rest point, as in [`Placement`].
    rest: DVec3,
    sweep: f64,
}

impl Image for Carried {
    fn position(self) -> DVec3 {
        self.position
    }
}

/// The map of the whole antenna, on top of Green coordinates or any other smooth map.
#[derive(Clone, Debug)]
pub struct Carry<'a, M> {
    map: &'a M,
    warp: &'a Warp,
    feed: RigidFeed,
    frame: FeedFrame,
    /// The shift in the rigid disc of each plane asked for so far, by the bits of the plane's height.
    discs: RefCell<HashMap<u64, Disc>>,
}

/// The shift in a rigid disc: a trigonometric polynomial of the angle around the feed, whose harmonic h varies from the
/// axis to the rim like `t^h (rim + bow (t^2 - 1))`, t being the part of the radius, as smooth functions do.
///
/// The map is analytic, so on the rim the terms fall off geometrically; nodes are added until the last ones are below
/// [`RIM_TAIL`]. The fade beyond the rim uses that; inside, Newton's method starts from here and needs one step or two.
#[derive(Clone, Debug)]
struct Disc {
    /// Shift on the axis, m.
    axis: DVec2,
    /// Mean shift on the rim and on the ring at half the radius, m.
    mean: [DVec2; 2],
    /// Cosine and sine coefficients of each harmonic on the rim, m.
    rim: Vec<[DVec2; 2]>,
    /// Their change towards the axis, m; of the first harmonics only.
    bow: Vec<[DVec2; 2]>,
}

/// Mean, and cosine and sine coefficients of each harmonic, of values at equal angles `2 pi k / n`.
fn harmonics(values: &[DVec2]) -> (DVec2, Vec<[DVec2; 2]>) {
    let n = values.len();
    let term = |harmonic: usize, wave: fn(f64) -> f64| {
        let weigh = |(k, s): (usize, &DVec2)| *s * wave(TAU * (harmonic * k % n) as f64 / n as f64);
        values.iter().enumerate().map(weigh).sum::<DVec2>() * (2.0 / n as f64)
    };
    let terms = (1..n / 2).map(|h| [term(h, f64::cos), term(h, f64::sin)]).collect();
    (values.iter().sum::<DVec2>() / n as f64, terms)
}

impl Disc {
    /// Interpolates shifts on the axis, on the rim, and on the ring at half the radius.
    fn new(axis: DVec2, rim: &[DVec2], inner: &[DVec2]) -> Self {
        let (rim_mean, rim) = harmonics(rim);
        let (inner_mean, inner) = harmonics(inner);
        let bow = |(h, (rim, inner)): (usize, (&[DVec2; 2], &[DVec2; 2]))| {
            [0, 1].map(|k| (rim[k] - inner[k] * 2.0_f64.powf(h as f64 + 1.0)) / 0.75)
        };
        let bow = rim.iter().zip(&inner).enumerate().map(bow).collect();
        Self { axis, mean: [rim_mean, inner_mean], rim, bow }
    }

    /// Greatest of the last eighth of the rim's harmonics, m: what a finer polynomial would still add.
    fn tail(&self) -> f64 {
        let n = self.rim.len();
        self.rim[n - n.div_ceil(8)..].iter().flatten().map(|c| c.length()).fold(0.0, f64::max)
    }

    /// The shift on the rim, in a direction given as a unit vector.
    fn on_rim(&self, direction: DVec2) -> DVec2 {
        let mut turn = direction;
        let mut sum = self.mean[0];
        for [cosine, sine] in &self.rim {
            sum += *cosine * turn.x + *sine * turn.y;
            turn = turn.rotate(direction);
        }
        sum
    }

    /// About the shift at a place, relative to the radius.
    fn inside(&self, place: DVec2) -> DVec2 {
        let t2 = place.length_squared();
        // The even quartic through axis, ring and rim.
        let [rim, ring] = self.mean.map(|m| m - self.axis);
        let quartic = (rim * 4.0 - ring * 16.0) / 3.0;
        let mut sum = self.axis + ((rim - quartic) + quartic * t2) * t2;
        let mut power = place;
        for ([rim_cos, rim_sin], [bow_cos, bow_sin]) in self.rim.iter().zip(&self.bow) {
            sum += (*rim_cos + *bow_cos * (t2 - 1.0)) * power.x + (*rim_sin + *bow_sin * (t2 - 1.0)) * power.y;
            power = power.rotate(place);
        }
        sum
    }
}

impl<'a, M: SmoothMap> Carry<'a, M> {
    /// Prepares the map.
    ///
    /// # Errors
    /// [`DeformError`] if the warped feed point lies outside the cage or the map has no normal there.
    pub fn new(map: &'a M, warp: &'a Warp, feed: RigidFeed) -> Result<Self, DeformError> {
        let frame = feed_frame(map, warp, &feed)?;
        Ok(Self { map, warp, feed, frame, discs: RefCell::default() })
    }

    /// The feed's posed frame.
    #[must_use]
    pub fn frame(&self) -> FeedFrame {
        self.frame
    }

    /// Carries some flat points, m.
    ///
    /// # Errors
    /// [`DeformError::OutsideCage`] if the warped antenna leaves the cage, [`DeformError::Feed`] if the feed cannot
    /// follow.
    pub fn carry(&self, flat: &[DVec3]) -> Result<Vec<Carried>, DeformError> {
        let placement = self.place(flat)?;
        let mut positions = self.map.positions(&placement.rest)?;
        sweep_line(&self.feed, &self.frame, &placement, &mut positions)?;
        let carried = |(position, (rest, sweep))| Carried { position, rest, sweep };
        Ok(positions.into_iter().zip(placement.rest.into_iter().zip(placement.sweep)).map(carried).collect())
    }

    /// Finds the rest points of some flat points, m.
    ///
    /// # Errors
    /// [`DeformError::OutsideCage`] if the warped antenna leaves the cage, [`DeformError::Feed`] if the feed cannot
    /// follow.
    fn place(&self, flat: &[DVec3]) -> Result<Placement, DeformError> {
        let feed = &self.feed;
        let length = feed.line_top - feed.port_plane;
        let sweep: Vec<f64> = flat.iter().map(|p| ((feed.line_top - p.z) / length).clamp(0.0, 1.0)).collect();
        let sheet: Vec<DVec3> = flat.iter().map(|p| DVec3::new(p.x, p.y, p.z.max(feed.line_top))).collect();
        let mut rest: Vec<DVec3> = sheet.par_iter().map(|&p| self.warp.map(p)).collect();
        let mut rigid = Vec::new();
        let mut guesses = Vec::new();
        for (i, p) in sheet.iter().enumerate() {
            let (radius, reach) = self.rigid_radius(p.z);
            let arm = p.truncate() - feed.center;
            let distance = arm.length();
            if distance <= radius * (1.0 + CONVERGED) {
                let shift = self.in_disc(p.z, |disc| disc.inside(arm / radius))?;
                rigid.push(i);
                guesses.push(rest[i] + shift.extend(0.0));
            } else if distance < radius + reach {
                let fade = (radius + reach - distance) / reach;
                let shift = self.in_disc(p.z, |disc| disc.on_rim(arm / distance))?;
                rest[i] += (shift * (fade * fade * (3.0 - 2.0 * fade))).extend(0.0);
            }
        }
        let targets: Vec<DVec3> = rigid.iter().map(|&i| sheet[i]).collect();
        for (i, solved) in rigid.into_iter().zip(self.solve(&targets, guesses)?) {
            rest[i] = solved;
        }
        Ok(Placement { rest, sweep })
    }

    /// The rigid radius of a plane, and the distance over which the shift fades out beyond it.
    fn rigid_radius(&self, z: f64) -> (f64, f64) {
        let down = (z / self.feed.substrate_bottom).clamp(0.0, 1.0);
        let mix = |top: f64, bottom: f64| top + (bottom - top) * down;
        (mix(self.feed.pin_radius, self.feed.coax_radius), mix(self.feed.pin_fade, self.feed.coax_fade))
    }

    /// Asks the disc of a plane, which is solved for once.
    fn in_disc<T>(&self, z: f64, ask: impl Fn(&Disc) -> T) -> Result<T, DeformError> {
        if let Some(disc) = self.discs.borrow().get(&z.to_bits()) {
            return Ok(ask(disc));
        }
        let mut n_nodes = RIM_NODES;
        let disc = loop {
            let disc = self.solve_disc(z, n_nodes)?;
            if disc.tail() <= RIM_TAIL * self.feed.coax_radius || n_nodes >= MAX_RIM_NODES {
                break disc;
            }
            n_nodes *= 2;
        };
        let answer = ask(&disc);
        self.discs.borrow_mut().insert(z.to_bits(), disc);
        Ok(answer)
    }

    /// Solves for the shift on the axis, at equal angles around the rim of a plane's rigid disc, and half-way.
    fn solve_disc(&self, z: f64, n_nodes: usize) -> Result<Disc, DeformError> {
        let radius = self.rigid_radius(z).0;
        let ring = |n: usize, radius: f64| {
            let arm = move |k: usize| DVec2::from_angle(TAU * k as f64 / n as f64) * radius;
            (0..n).map(move |k| (self.feed.center + arm(k)).extend(z))
        };
        let nodes: Vec<DVec3> =
            ring(1, 0.0).chain(ring(INNER_NODES, radius / 2.0)).chain(ring(n_nodes, radius)).collect();
        let solved = self.solve(&nodes, nodes.iter().map(|&p| self.warp.map(p)).collect())?;
        let shifts: Vec<DVec2> = nodes.iter().zip(solved).map(|(p, s)| (s - self.warp.map(*p)).truncate()).collect();
        let (inner, rim) = shifts[1..].split_at(INNER_NODES);
        Ok(Disc::new(shifts[0], rim, inner))
    }

    /// Rest points whose images have the lateral coordinates of the flat `targets`, by Newton's method from a first
    /// guess; each point goes its own way, so the result does not depend on which points are solved together.
    fn solve(&self, targets: &[DVec3], mut solved: Vec<DVec3>) -> Result<Vec<DVec3>, DeformError> {
        let mut steps = vec![DVec3::ZERO; targets.len()];
        let mut open: Vec<usize> = (0..targets.len()).collect();
        for _ in 0..MAX_STEPS {
            let points: Vec<DVec3> = open.iter().map(|&i| solved[i]).collect();
            let images = self.map.jacobians(&points)?;
            let mut still_open = Vec::new();
            for (&i, (image, jacobian)) in open.iter().zip(images) {
                let wanted = targets[i].truncate() - self.feed.center;
                let miss = wanted - self.frame.local(image).truncate();
                let lateral = self.frame.axes.transpose() * jacobian;
                let plane = DMat2::from_cols(lateral.col(0).truncate(), lateral.col(1).truncate());
                // Past the place where the sheet stands upright there is no solution: take half the step back.
                let upright = plane.determinant() <= UPRIGHT;
                let longest = STRIDE * self.feed.coax_radius;
                let newton = || (plane.inverse() * miss).clamp_length_max(longest).extend(0.0);
                steps[i] = if upright { steps[i] * -0.5 } else { newton() };
                // Newton's method squares the error, so this step is the last one where its root is met.
                if upright || miss.length() > CONVERGED.sqrt() * self.feed.coax_radius {
                    still_open.push(i);
                }
                solved[i] += steps[i];
            }
            open = still_open;
            if open.is_empty() {
                return Ok(solved);
            }
        }
        Err(self.does_not_fit(targets[open[0]]))
    }

    fn does_not_fit(&self, target: DVec3) -> DeformError {
        let radius_mm = to_mm(self.rigid_radius(target.z).0);
        FeedError::DoesNotFit { radius_mm, height_mm: to_mm(target.z) }.into()
    }
}

/// The posed frame at the feed point on the patch's bottom plane.
///
/// # Errors
/// [`DeformError`] if the point lies outside the cage or the map is singular there.
pub fn feed_frame(map: &impl SmoothMap, warp: &Warp, feed: &RigidFeed) -> Result<FeedFrame, DeformError> {
    let (origin, jacobian) = map.jacobians(&[warp.map(feed.center.extend(0.0))])?[0];
    let does_not_fit = FeedError::DoesNotFit { radius_mm: to_mm(feed.pin_radius), height_mm: 0.0 };
    let normal = jacobian.col(0).cross(jacobian.col(1)).try_normalize().ok_or(does_not_fit)?;
    // The frame turns with the sheet's x direction, which a rotation about the axis does not change.
    let second = normal.cross(jacobian.col(0)).try_normalize().ok_or(does_not_fit)?;
    Ok(FeedFrame { origin, axes: DMat3::from_cols(second.cross(normal), second, normal) })
}

/// Moves the vertices of the line below the ground from the ground's image straight down to the port plane.
///
/// * `positions`: images of [`Placement::rest`], m; those of swept vertices are replaced.
///
/// # Errors
/// [`FeedError::LineTooShort`] if the port plane would lie within the ground.
pub fn sweep_line(
    feed: &RigidFeed,
    frame: &FeedFrame,
    placement: &Placement,
    positions: &mut [DVec3],
) -> Result<(), DeformError> {
    let normal = frame.axes.col(2);
    for (position, &sweep) in positions.iter_mut().zip(&placement.sweep) {
        if sweep > 0.0 {
            let height = frame.local(*position).z;
            if height <= feed.port_plane {
                let needed_mm = to_mm(feed.line_top - height);
                return Err(FeedError::LineTooShort { needed_mm }.into());
            }
            *position += normal * (sweep * (feed.port_plane - height));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{GreenCage, GreenMap, Pose};
    use super::*;
    use crate::antenna::{flat_complex, params::tests::paper};
    use crate::cage::{Axis, BendRule, Cage, CageParams, Preset, pose};
    use crate::units::from_mm;
    use std::sync::Arc;

    fn paper_feed() -> RigidFeed {
        let params = paper();
        RigidFeed {
            center: params.feed(),
            pin_radius: params.pin_radius,
            coax_radius: params.coax_radius,
            pin_fade: from_mm(0.8),
            coax_fade: from_mm(5.0),
            substrate_bottom: -params.height,
            line_top: params.ground_bottom(),
            port_plane: params.port_plane(),
        }
    }

    fn bent(axis: Axis, radius_mm: f64) -> GreenMap {
        let params = CageParams { padding: DVec3::splat(from_mm(1.0)), segments: [10, 10] };
        let cage = Cage::around(paper().bounds(), &params).expect("valid");
        let bend = Preset::Bend { axis, radius: from_mm(radius_mm), rule: BendRule::Tangent, kept_plane: 0.0 };
        let posed =
            if radius_mm.is_finite() { pose(&cage, &[bend]).expect("valid") } else { cage.mesh.vertices.clone() };
        let green = GreenCage::new(cage.mesh).expect("closed");
        let pose = Pose::new(&green, &posed).expect("not degenerate");
        GreenMap::new(Arc::new(green), pose)
    }

    #[test]
    fn the_rest_cage_leaves_the_whole_antenna_in_place() {
        let map = bent(Axis::X, f64::INFINITY);
        let warp = Warp::identity(DVec2::splat(0.01));
        let carry = Carry::new(&map, &warp, paper_feed()).expect("inside");
        let plc = flat_complex(&paper()).expect("valid");
        for (p, q) in plc.vertices.iter().zip(carry.carry(&plc.vertices).expect("inside")) {
            assert!(p.distance(q.position) < 1e-14, "{p} went to {q:?}");
        }
    }

    #[test]
    fn pin_and_line_are_straight_cylinders_whatever_the_bend() {
        let params = paper();
        let plc = flat_complex(&params).expect("valid");
        for (axis, radius) in [(Axis::X, 4.5), (Axis::X, 10.0), (Axis::Y, 6.5)] {
            let map = bent(axis, radius);
            let warp = Warp::scale(DVec2::splat(0.01), DVec2::new(1.03, 0.98));
            let carry = Carry::new(&map, &warp, paper_feed()).expect("inside");
            let carried = carry.carry(&plc.vertices).expect("the line fits");
            let mut port_heights = Vec::new();
            for (flat, posed) in plc.vertices.iter().zip(&carried) {
                let local = carry.frame().local(posed.position);
                let arm = flat.truncate() - params.feed();
                let on_pin = arm.length() <= params.pin_radius + 1e-12 && flat.z <= 0.0;
                let on_line = arm.length() <= params.coax_radius + 1e-12 && flat.z <= -params.height;
                if on_pin || on_line {
                    assert!(local.truncate().distance(arm) < 1e-11, "{axis:?} {radius}: {flat} is at {local}");
                }
                if flat.z <= params.port_plane() {
                    port_heights.push(local.z);
                }
            }
            let flatness = port_heights.iter().map(|z| (z - params.port_plane()).abs()).fold(0.0, f64::max);
            assert!(flatness < 1e-14, "{axis:?} {radius}: the port plane is flat to {flatness:e}");
        }
    }

    #[test]
    fn a_line_wider_than_the_bend_is_refused() {
        let map = bent(Axis::X, 4.2);
        let warp = Warp::identity(DVec2::splat(0.01));
        let feed = RigidFeed { coax_radius: from_mm(3.5), ..paper_feed() };
        let carry = Carry::new(&map, &warp, feed).expect("inside");
        let rim = DVec3::new(feed.center.x + feed.coax_radius, feed.center.y, feed.line_top);
        assert!(matches!(carry.carry(&[rim]), Err(DeformError::Feed(_))), "3.5 mm in a 2.6 mm inner radius");
    }
}
