//! The pipeline in numbered steps: takes in, a checked crowd out.
//!
//! `cargo run --release --example pipeline -- [SEED] [TAKES] [CAPTURES] [SCENE]`

use std::path::Path;

use crowdquilt::deform::Limits;
use crowdquilt::tiling::{Options, Scene, study, tile};
use crowdquilt::{check, patch, samples};

fn main() -> crowdquilt::Result<()> {
    let args: Vec<String> = std::env::args().collect();
    let seed = args.get(1).and_then(|s| s.parse().ok()).unwrap_or(1);
    let out = Path::new("out/pipeline");
    // 1. Generate sample captures, unless there are others.
    let takes = args.get(2).map_or_else(|| out.join("captures"), Into::into);
    if args.len() < 3 {
        samples::write(&takes, seed)?;
    }
    // 2. Cut motion patches out of the takes, and find out who can go on with what.
    let mut set = patch::cut_folder(&takes, args.get(3).map(Path::new))?;
    study(&mut set, Limits::default(), &|_| true)?;
    // 3. Tile a scene, the demo's unless there is another.
    let scene = args.get(4).map_or_else(|| Ok(Scene::demo()), |path| Scene::load(Path::new(path)))?;
    let options = Options { seed, ..Options::default() };
    let outcome = tile(&scene, &set, &options, &mut |p| {
        let together = p.multi_person_share * 100.0;
        eprint!("\r{:?}: {} patches, {} characters, {together:.1} % together ", p.phase, p.patches, p.characters);
        true
    })?;
    eprintln!();
    println!("{:?} in {:.2} s", outcome.status, outcome.solve_secs);
    // 4. Check the result.
    println!("{:?}", check::summary(&outcome.crowd));
    println!("{}", check::check(&outcome.crowd));
    // 5. Save it.
    std::fs::create_dir_all(out).map_err(|e| crowdquilt::Error::io(out, e))?;
    outcome.crowd.save(&out.join("crowd.crowd"))
}
