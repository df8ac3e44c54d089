//! What may be wrong with welded bodies, each with its places.

use super::BodyFault;
use super::fault::MAX_PLACES;
use crate::geometry::bvh::Aabb;
use crate::geometry::{DVec3, Plc, Region, RegionId, VertexId, inside, intersect};
use crate::task::{Cancelled, Task};
use std::collections::{BTreeMap, HashMap, HashSet};

/// How often, and where first.
pub(super) type Places = (usize, Vec<DVec3>);

pub(super) fn add_place((count, places): &mut Places, place: DVec3) {
    *count += 1;
    if places.len() < MAX_PLACES {
        places.push(place);
    }
}

/// Places where two bodies, or two parts of one, want the same room.
#[derive(Debug, Default)]
pub(super) struct Clashes(BTreeMap<[RegionId; 2], Places>);

impl Clashes {
    pub(super) fn add(&mut self, [a, b]: [RegionId; 2], place: DVec3) {
        add_place(self.0.entry([a.min(b), a.max(b)]).or_default(), place);
    }

    pub(super) fn into_faults(self, regions: &[Region]) -> impl Iterator<Item = BodyFault> {
        self.0.into_iter().map(|([a, b], (count, places))| {
            let [first, second] = [a, b].map(|r| regions[r.index()].name.clone());
            if a == b {
                BodyFault::SelfCrossing { body: first, count, places }
            } else {
                BodyFault::Overlap { bodies: [first, second], count, places }
            }
        })
    }
}

/// Everything that is wrong with a complex of bodies: first what is open, else what overlaps.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn inspect(plc: &Plc, task: &Task) -> Result<Vec<BodyFault>, Cancelled> {
    let phase = task.phase("checking bodies", 3);
    let mut faults: Vec<BodyFault> = plc.solids().flat_map(|(id, region)| rims(plc, id, region)).collect();
    for look in [crossings, nested] {
        task.check()?;
        phase.advance(1);
        if faults.is_empty() {
            faults = look(plc);
        }
    }
    Ok(faults)
}

/// Edges of a body that do not have one face on each side.
fn rims(plc: &Plc, id: RegionId, region: &Region) -> Vec<BodyFault> {
    let faces = plc.boundary_faces(id);
    let mut runs: HashMap<[VertexId; 2], usize> = HashMap::new();
    for face in &faces {
        (0..3).for_each(|k| *runs.entry([face[k], face[(k + 1) % 3]]).or_default() += 1);
    }
    let (mut open, mut branching) = (Places::default(), Places::default());
    for face in &faces {
        for k in 0..3 {
            let [a, b] = [face[k], face[(k + 1) % 3]];
            let place = || plc.vertices[a.index()].midpoint(plc.vertices[b.index()]);
            match (runs[&[a, b]], runs.get(&[b, a])) {
                (1, None) => add_place(&mut open, place()),
                (1, Some(1)) => {}
                // Told once for both directions.
                (_, back) if a < b || back.is_none() => add_place(&mut branching, place()),
                _ => {}
            }
        }
    }
    let body = || region.name.clone();
    let open = (open.0 > 0).then(|| BodyFault::Open { body: body(), count: open.0, places: open.1 });
    let branching =
        (branching.0 > 0).then(|| BodyFault::Branching { body: body(), count: branching.0, places: branching.1 });
    open.into_iter().chain(branching).collect()
}

/// Facets that cross.
fn crossings(plc: &Plc) -> Vec<BodyFault> {
    let faces: Vec<_> = plc.facets.iter().map(|f| f.vertices).collect();
    let mut clashes = Clashes::default();
    for crossing in intersect::crossings(&plc.vertices, &faces) {
        let [f, g] = [crossing.first.index(), crossing.second.index()];
        // Facets cross in all bodies that they bound; one pair is enough to tell.
        clashes.add([plc.facets[f].back, plc.facets[g].back], plc.corners(f).iter().sum::<DVec3>() / 3.0);
    }
    clashes.into_faults(&plc.regions).collect()
}

/// Bodies that lie within others, wholly or in part, without a facet that crosses.
fn nested(plc: &Plc) -> Vec<BodyFault> {
    let ids: Vec<RegionId> = plc.solids().map(|(id, _)| id).collect();
    let surfaces: Vec<_> = ids.iter().map(|&id| plc.boundary(id)).collect();
    let boxes: Vec<Aabb> = surfaces.iter().map(|s| Aabb::around(&s.vertices)).collect();
    let mut clashes = Clashes::default();
    for (a, &inner) in ids.iter().enumerate() {
        for (b, &outer) in ids.iter().enumerate() {
            if a == b || !boxes[a].meets(&boxes[b]) {
                continue;
            }
            let inside = patches(plc, inner, outer).into_iter().find(|&p| inside::contains(&surfaces[b], p));
            if let Some(place) = inside {
                clashes.add([inner, outer], place);
            }
        }
    }
    clashes.into_faults(&plc.regions).collect()
}

/// One place in each part of a body's surface that another body's edges bound and that is not shared with it.
fn patches(plc: &Plc, of: RegionId, other: RegionId) -> Vec<DVec3> {
    let edges = |f: [VertexId; 3]| (0..3).map(move |k| [f[k].min(f[(k + 1) % 3]), f[k].max(f[(k + 1) % 3])]);
    let walls: HashSet<[VertexId; 2]> = plc.boundary_faces(other).into_iter().flat_map(edges).collect();
    let own: Vec<[VertexId; 3]> = plc
        .facets
        .iter()
        .filter(|f| [f.back, f.front].contains(&of) && ![f.back, f.front].contains(&other))
        .map(|f| f.vertices)
        .collect();
    let mut at: HashMap<[VertexId; 2], Vec<usize>> = HashMap::new();
    for (k, &face) in own.iter().enumerate() {
        edges(face).filter(|e| !walls.contains(e)).for_each(|e| at.entry(e).or_default().push(k));
    }
    let mut is_seen = vec![false; own.len()];
    let mut places = Vec::new();
    for first in 0..own.len() {
        if is_seen[first] {
            continue;
        }
        places.push(own[first].iter().map(|v| plc.vertices[v.index()]).sum::<DVec3>() / 3.0);
        let mut stack = vec![first];
        while let Some(k) = stack.pop() {
            if !std::mem::replace(&mut is_seen[k], true) {
                stack.extend(edges(own[k]).filter_map(|e| at.get(&e)).flatten());
            }
        }
    }
    places
}
