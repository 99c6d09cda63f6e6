//! How long a crowd patch takes: `cargo run --release --example crowd_patches [patches per row [n]]`.
//!
//! Squares of 8 m, period 10 s, n people in and n out, up to four objects and three standing people.

use std::time::Instant;

use crowdquilt::check::world::check_patch;
use crowdquilt::world::{FramePatch, Limits, Method, Options, solve};

fn main() {
    let count: u64 = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(300);
    let only = std::env::args().nth(2).and_then(|n| n.parse().ok());
    println!("method       n  patches   solved  untouched  median ms   p95 ms   max ms  restarts  curves");
    for method in [Method::Curves, Method::Particles] {
        for n in [4, 8, 16, 30].into_iter().filter(|&n| only.is_none_or(|only: usize| only == n)) {
            row(method, n, count);
        }
    }
}

fn row(method: Method, n: usize, count: u64) {
    let (mut millis, mut solved, mut restarts, mut solves) = (Vec::new(), 0, 0, 0);
    let mut untouched = 0;
    for seed in 0..count {
        let frame = FramePatch::sample(n, seed).expect("there is room");
        let options = Options { seed, method, ..Options::default() };
        let mut least = f64::INFINITY;
        // The fastest of three: other processes take the core for some milliseconds now and then.
        let mut solution = None;
        for _ in 0..3 {
            let begin = Instant::now();
            solution = Some(solve(&frame, &Limits::default(), &options).expect("valid"));
            least = least.min(begin.elapsed().as_secs_f64() * 1e3);
        }
        millis.push(least);
        let solution = solution.expect("solved thrice");
        untouched += u64::from(check_patch(&solution.patch, &Limits::default()).collision_free(&Limits::default()));
        solved += u64::from(solution.ok());
        restarts += u64::from(solution.restarts);
        solves += solution.solves;
    }
    millis.sort_by(f64::total_cmp);
    let at = |share: f64| millis[((millis.len() - 1) as f64 * share) as usize];
    println!(
        "{:9} {n:4}  {count:7}  {:6.1}%  {:8.1}%  {:9.3}  {:7.3}  {:7.3}  {:8.2}  {:6.0}",
        format!("{method:?}").to_lowercase(),
        100.0 * solved as f64 / count as f64,
        100.0 * untouched as f64 / count as f64,
        at(0.5),
        at(0.95),
        at(1.0),
        restarts as f64 / count as f64,
        solves as f64 / count as f64,
    );
}
