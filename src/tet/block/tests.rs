use super::*;
use crate::antenna::params::tests::paper;
use crate::units::from_mm;

#[test]
fn explore() {
    for (metal, coax) in [(Metal::Sheet, true), (Metal::Sheet, false), (Metal::Solid, true)] {
        let s = BlockSettings { rim: from_mm(0.4), inner: from_mm(0.8), layers: 4, metal, coax };
        report("paper", &paper(), &s);
    }
}

fn report(name: &str, p: &PatchParams, s: &BlockSettings) {
    let start = std::time::Instant::now();
    let print = match footprint::triangulate(p, s) {
        Ok(x) => x,
        Err(e) => {
            println!("{name}: {e}");
            return;
        }
    };
    let t2 = start.elapsed();
    let mut angles: Vec<(f64, usize)> = print
        .triangles
        .iter()
        .enumerate()
        .map(|(i, t)| (draft::smallest_angle(t.map(|v| print.points[v])).to_degrees(), i))
        .collect();
    angles.sort_by(|a, b| a.0.total_cmp(&b.0));
    let block = build::<BlockError>(p, s, |f| Ok(f.to_vec())).unwrap();
    let t3 = start.elapsed();
    block.check().unwrap();
    let live = |t: &usize| block.regions[block.tets[*t].region.index()].role != RegionRole::Conductor;
    let stat = |pick: &dyn Fn(&usize) -> bool| {
        let mut d: Vec<f64> = (0..block.tets.len())
            .filter(|t| pick(t))
            .map(|t| prisms::smallest_dihedral(block.corners(t)).to_degrees())
            .collect();
        d.sort_by(f64::total_cmp);
        let r =
            (0..block.tets.len()).filter(|t| pick(t)).map(|t| inradius(block.corners(t))).fold(f64::INFINITY, f64::min);
        format!("dih min {:.2} 1% {:.2} inr {:.4} n {}", d[0], d[d.len() / 100], r * 1e3, d.len())
    };
    println!(
        "{name} {:?} {}: 2d {} pts {} tri, angles {:.1?}, {} <30; live {}; all {}; {:?} {:?}",
        s.metal,
        s.coax,
        print.points.len(),
        print.triangles.len(),
        angles[..4].iter().map(|a| a.0).collect::<Vec<_>>(),
        angles.iter().filter(|a| a.0 < 30.0).count(),
        stat(&live),
        stat(&|_| true),
        t2,
        t3
    );
    for a in &angles[..3] {
        let c = print.triangles[a.1].map(|v| print.points[v] * 1e3);
        println!("    {:.1} at {:.3} {:.3} {:.3}", a.0, c[0], c[1], c[2]);
    }
}

fn inradius(c: [DVec3; 4]) -> f64 {
    let area: f64 =
        super::super::FACES.iter().map(|f| (c[f[1]] - c[f[0]]).cross(c[f[2]] - c[f[0]]).length() / 2.0).sum();
    3.0 * super::super::volume(c) / area
}
