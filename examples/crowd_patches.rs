//! How long a crowd patch takes, and how people walk in it: `cargo run --release --example crowd_patches [patches] [n]`.
//!
//! Squares of 8 m, period 10 s, n people in and n out, up to four objects and three standing people.

use crowdquilt::check::world::{PatchReport, check_patch};
use crowdquilt::world::{Creation, Limits, Method, measure_creation, measure_replay, measure_walk, scenes};

fn main() -> crowdquilt::Result<()> {
    let argument = |n: usize| std::env::args().nth(n).and_then(|n| n.parse::<usize>().ok());
    let count = argument(1).unwrap_or(300) as u64;
    let sizes = argument(2).map_or(vec![4, 8, 16, 30], |n| vec![n]);
    println!("method         n  patches   solved  untouched  median ms   p95 ms   max ms  restarts  curves");
    let mut reports = Vec::new();
    for method in [Method::Curves, Method::Particles] {
        for &n in &sizes {
            let creation = measure_creation(method, n, count)?;
            let checked: Vec<PatchReport> =
                creation.patches.iter().map(|patch| check_patch(patch, &Limits::default())).collect();
            print(method, &creation, &checked);
            if method == Method::Curves {
                reports.push((n, checked));
            }
        }
    }
    for (n, checked) in &reports {
        println!("\nmethod curves, n = {n}                   least   median      p95  greatest");
        quantiles("greatest acceleration, m/s2", checked, |r| &r.acceleration);
        quantiles("greatest turning, deg/s", checked, |r| &r.turning);
        quantiles("greatest speed, m/s", checked, |r| &r.speed);
        quantiles("least speed, m/s", checked, |r| &r.slowest);
    }
    let walk = measure_walk(&scenes::street(1)?, 10_000.0, 4, 1)?;
    let at = |share: f64| walk.frames[((walk.frames.len() - 1) as f64 * share) as usize];
    println!("\n10 km of street, one patch a frame: {} patches made, {} kept", walk.made, walk.resident);
    println!("a frame: median {:.2} ms, p99 {:.2} ms, most {:.2} ms", at(0.5), at(0.99), at(1.0));
    println!("\n  kinds    people   MB   M/s at 1 s   M/s at 1 h   a patch, us");
    for (kinds, unique) in [(64, false), (1_000, false), (1_000, true)] {
        let r = measure_replay(1_000_000, kinds, unique)?;
        let (megabytes, early, late) = (r.bytes as f64 / 1e6, r.early / 1e6, r.late / 1e6);
        println!("{:7} {:9} {megabytes:4.0} {early:12.0} {late:12.0} {:13.3}", r.kinds, r.people, r.single_micros);
    }
    Ok(())
}

fn print(method: Method, creation: &Creation, checked: &[PatchReport]) {
    let count = creation.patches.len() as f64;
    let untouched = checked.iter().filter(|r| r.collision_free(&Limits::default())).count();
    println!(
        "{:9} {:6}  {count:7}  {:6.1}%  {:8.1}%  {:9.3}  {:7.3}  {:7.3}  {:8.2}  {:6.0}",
        format!("{method:?}").to_lowercase(),
        creation.walkers,
        100.0 * creation.solved as f64 / count,
        100.0 * untouched as f64 / count,
        creation.quantile(0.5),
        creation.quantile(0.95),
        creation.quantile(1.0),
        creation.restarts as f64 / count,
        creation.solves as f64 / count,
    );
}

/// Of one figure of all walkers of all patches.
fn quantiles(name: &str, checked: &[PatchReport], figure: impl Fn(&PatchReport) -> &Vec<f64>) {
    let mut values: Vec<f64> = checked.iter().flat_map(figure).copied().collect();
    values.sort_by(f64::total_cmp);
    let scale = if name.contains("deg") { 1f64.to_degrees() } else { 1.0 };
    let at = |share: f64| scale * values[((values.len() - 1) as f64 * share) as usize];
    println!("{name:32}  {:8.2} {:8.2} {:8.2}  {:8.2}", at(0.0), at(0.5), at(0.95), at(1.0));
}
