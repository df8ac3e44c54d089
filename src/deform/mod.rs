//! Green coordinates: weights of points in a cage, and the map that a posed cage makes of them.
//!
//! A point p in a closed triangle cage is written as `p = Σ phi_i v_i + Σ psi_f n_f` over the cage's vertices and its
//! faces' outward unit normals. A posed cage carries it to `Σ phi_i v'_i + Σ psi_f s_f n'_f`, with the stretch factor
//! `s_f` of each face [LLC08, eq. (2)]. The map is smooth inside, nearly conformal, and exactly a similarity where the
//! pose is one.
//!
//! - [`GreenCage`]: the cage at rest with what every evaluation needs; decides inside or outside.
//! - [`Pose`]: posed vertices `v'_i` and stretched normals `s_f n'_f`.
//! - [`GreenWeights`]: `phi` and `psi` of many points, f64, for repeated poses; [`PreviewWeights`]: their f32 copy.
//! - [`GreenMap`]: positions and Jacobians of many points for one pose, without storing weights.
//! - [`Carry`]: the map of the whole antenna: a [`Warp`] of the flat plane, the Green map, and the rigid feed.
//! - [`split()`]: divides the flat surface until it follows a map to a tolerance.
//!
//! Method: closed forms of the single- and double-layer potentials of a triangle with linear hat functions. With
//! `a_i = v_i - p`, the solid angle Ω of a face and the line integrals `L_k = ∫ ds/r` of its edges, everything is
//! rational in `a_i`. Eight points at a time run through vector code: distances once per vertex, `L` once per unique
//! edge, one arctangent per face. Where Σ phi differs from 1 by more than 1e-12, or the surface is so close that
//! rounding could decide the side, the point goes through a scalar path with an exact inside test, which gives the
//! interior limits on and at any distance from faces, edges and vertices.
//!
//! Lengths are metres (nothing depends on the unit). Results are the same bits for any number of threads, any vector
//! width and any grouping of the points.
//!
//! Source: \[LLC08\] Lipman, Levin, Cohen-Or, "Green Coordinates", SIGGRAPH 2008; \[Urago\] for the potentials of a
//! triangle. Not handled: points outside the cage (an error), cages that cross themselves at rest.

mod block;
mod cage;
mod carry;
mod columns;
mod elementary;
mod error;
mod evaluator;
mod gradient;
mod map;
mod pose;
mod preview;
#[cfg(test)]
mod samples;
mod single;
mod smooth_map;
mod split;
mod warp;
mod weights;

pub use cage::GreenCage;
pub use carry::{Carried, Carry, FeedError, FeedFrame, Placement, RigidFeed, feed_frame, sweep_line};
pub use error::DeformError;
pub use map::GreenMap;
pub use pose::Pose;
pub use preview::PreviewWeights;
pub use smooth_map::SmoothMap;
pub use split::{Image, SplitSettings, SplitSurface, split};
pub use warp::Warp;
pub use weights::GreenWeights;
