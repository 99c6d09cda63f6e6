//! The pipeline in numbered steps: takes in, a checked crowd out.
//!
//! `cargo run --release --example pipeline -- TAKES [CAPTURES] [SEED]`

use std::path::Path;

use crowdquilt::tiling::{Options, Scene, tile};
use crowdquilt::{check, patch};

fn main() -> crowdquilt::Result<()> {
    let args: Vec<String> = std::env::args().collect();
    let takes = args.get(1).map_or("out/demo/captures", String::as_str);
    let captures = args.get(2).filter(|a| !a.is_empty());
    // 1. Cut motion patches out of takes.
    let set = patch::cut_folder(Path::new(takes), captures.map(Path::new))?;
    // 2. Tile the demo's scene.
    let options = Options { seed: args.get(3).and_then(|s| s.parse().ok()).unwrap_or(1), ..Options::default() };
    let outcome = tile(&Scene::demo(), &set, &options, &mut |p| {
        eprint!(
            "\r{:?}: {} patches, {} characters, {:.1} % together, {:.1} s ",
            p.phase,
            p.patches,
            p.characters,
            p.multi_person_share * 100.0,
            p.secs
        );
        true
    })?;
    println!("{:?} in {:.2} s", outcome.status, outcome.solve_secs);
    // 3. Check the result.
    println!("{:?}", check::summary(&outcome.crowd));
    println!("{}", check::check(&outcome.crowd));
    // 4. Save it.
    outcome.crowd.save(Path::new("out/pipeline.crowd"))
}
