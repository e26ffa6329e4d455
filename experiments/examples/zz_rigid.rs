#[allow(dead_code)]
#[path = "../src/parts.rs"]
mod parts;
use canonform::Surface;
use descriptors::rigid_signature;
use rayon::prelude::*;
fn main() {
  for seed in [0u64, 1] {
    let shapes = parts::parts(seed, 110, 4);
    let found: Vec<(String, Vec<f64>)> = shapes.par_iter().map(|s| {
        let surface = Surface::new(&s.mesh, &Default::default(), &()).unwrap();
        (s.label.clone(), rigid_signature(surface.for_description(&()).unwrap().mesh()).values)
    }).collect();
    let family = |s: &str| s.split('-').next().unwrap().to_owned();
    for r in [0..1, 1..4, 4..20, 20..27, 0..27] {
        let d = |a: &Vec<f64>, b: &Vec<f64>| a[r.clone()].iter().zip(&b[r.clone()]).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
        let mut w = vec![]; let mut v = vec![];
        for i in 0..found.len() { for j in 0..i {
            let (a, b) = (&found[i], &found[j]);
            let x = d(&a.1, &b.1);
            if a.0 == b.0 { w.push(x) } else if family(&a.0) == family(&b.0) { v.push(x) }
        } }
        let rms = |v: &Vec<f64>| (v.iter().map(|x| x * x).sum::<f64>() / v.len().max(1) as f64).sqrt();
        println!("{r:?}: copies {:.5} family {:.4}", rms(&w), rms(&v));
    }
  }
}
