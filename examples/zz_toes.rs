use crowdquilt::motion::{canonical, import, joint, retarget, take::ImportOptions};
fn main() {
    for (f, p) in [("131_01", "cmu-max"), ("60_01_scaled", "cmu-daz-128")] {
        let o = ImportOptions { preset: Some(p.into()), ..Default::default() };
        let m = retarget::to_canonical(&import::load(format!("/work/shared/mocap/bvh/{f}.bvh").as_ref(), &o).unwrap())
            .unwrap();
        let mut g = Vec::new();
        for i in 0..m.len() {
            m.globals(i, &mut g);
            for j in [joint::LEFT_TOE, joint::RIGHT_TOE] {
                let t = g[j].0 + g[j].1 * canonical().joints[j].tip.unwrap();
                if t.y < -0.02 || g[j].0.y < -0.02 {
                    println!(
                        "{f} {i} {j} ball {:.3} tip {:.3} tipdir {:.2} ankle {:.3} planted {}",
                        g[j].0,
                        t,
                        g[j].1 * canonical().joints[j].tip.unwrap() / 0.07,
                        g[j - 1].0,
                        m.plants.iter().any(|p| (p.begin as usize..=p.end as usize).contains(&i))
                    );
                }
            }
        }
    }
}
