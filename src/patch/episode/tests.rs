use super::*;
use crate::motion::retarget;
use crate::samples;

fn show(motions: &[Motion]) {
    let found = detect(motions, &EpisodeOptions::default());
    println!("{:?} {:?}\n{:?}", found.thresholds, found.frames, found.why_nothing());
    for p in &found.pairs { println!("{p}"); }
    for e in &found.events {
        println!("  EVENT {:?} {:?} {}..{}", e.kind, e.people, e.begin, e.end);
        for s in &e.signs {
            println!("      {:?} {:?}: {} {}", s.kind, s.people, s.begin, s.end);
            for t in &s.touching { println!("        {:?} {:?} {}..{} gap {:.3}", t.a.1, t.b.1, t.begin, t.end, t.gap); }
        }
    }
}

#[test]
fn probe_real() {
    let folder = std::path::Path::new("/work/shared/mocap");
    for name in ["18_01-19_01", "60_03-61_03", "60_05-61_05"] {
        let path = std::path::PathBuf::from(format!("examples/cmu/{name}.take.json"));
        let mut take = crate::motion::take::TakeFile::load(&path).unwrap();
        let options = crate::patch::CutOptions { captures: Some(folder.into()), ..Default::default() };
        for raw in [true, false] {
            if raw { take.contacts.clear() } else { take = crate::motion::take::TakeFile::load(&path).unwrap(); }
            let motions = crate::patch::load_take(&path, &take, &options).unwrap();
            println!("{name} raw {raw}");
            let now = std::time::Instant::now();
            show(&motions);
            println!("{:?}", now.elapsed());
            if name.starts_with("18") {
                for f in 0..motions[0].len() {
                    let p: Vec<_> = motions.iter().map(|m| { let mut g = Vec::new(); m.globals(f, &mut g); crate::motion::contacts::palm(&g, crate::motion::joint::RIGHT_HAND) }).collect();
                    print!("{f}:{:.3} ", p[0].distance(p[1]));
                }
                println!();
            }
        }
    }
}

#[test]
fn probe() {
    let takes: Vec<_> = samples::generate(1).into_iter().map(|t| (retarget::take(&t.clips).unwrap(), t.file)).collect();
    let motions: Vec<&[Motion]> = takes.iter().map(|t| t.0.as_slice()).collect();
    for together in [true] {
        let all = detect_all(&motions, &EpisodeOptions::default());
        for ((motions, file), found) in takes.iter().zip(&all) {
            if motions.len() < 2 { continue; }
            let found = if together { found } else { &detect(motions, &EpisodeOptions::default()) };
            println!("{} {} frames {:?}", file.name, motions[0].len(), found.thresholds);
            if together { for c in &file.contacts { println!("   truth {:?} {:?}: {:.1}..{:.1}", c.a, c.b, c.begin * 30.0, c.end * 30.0); } }
            for p in &file.patches { println!("  core {:?}", p.core.map(|c| c.map(|t| t * 30.0))); }
            println!("{:?}", found.why_nothing());
            for e in &found.events {
                println!("  EVENT {:?} {:?} {}..{}", e.kind, e.people, e.begin, e.end);
                for s in &e.signs {
                    println!("      {:?} {:?}: {} {}", s.kind, s.people, s.begin, s.end);
                    for t in &s.touching { println!("        {:?} {:?} {}..{} gap {:.3}", t.a.1, t.b.1, t.begin, t.end, t.gap); }
                }
            }
        }
    }
}
