//! Hashes.
use canonform_datasets as d;
use d::*;
fn bytes(m: &mesh::TriMesh) -> Vec<u8> {
    let mut out = Vec::new();
    for p in &m.positions {
        for c in p.iter() {
            out.extend(c.to_bits().to_le_bytes());
        }
    }
    for f in &m.faces {
        for v in f {
            out.extend(v.0.to_le_bytes());
        }
    }
    out
}
fn main() {
    let folder = std::path::PathBuf::from(std::env::args().nth(1).unwrap());
    std::fs::create_dir_all(&folder).unwrap();
    let save = |name: &str, b: Vec<u8>| std::fs::write(folder.join(name), b).unwrap();
    for seed in [0, 1] {
        let o = ArticulatedOptions { seed, n_vertices: 1200 };
        for s in articulated(&o).unwrap() {
            save(&format!("a{seed}-{}", s.name), bytes(&s.mesh));
        }
        for f in Family::all() {
            for b in 1..3 {
                let s = articulated_at_rest(f, b, 4, &o).unwrap();
                save(&format!("b{seed}-{}", s.shape.name), [bytes(&s.shape.mesh), bytes(&s.rest)].concat());
            }
        }
        let o = CreatureOptions { seed, n_families: 60, n_poses: 2, n_vertices: 1000 };
        for s in creatures(&o).unwrap() {
            save(&format!("c{seed}-{}", s.name), bytes(&s.mesh));
        }
    }
    let o = ArticulatedOptions { seed: 0, n_vertices: 1200 };
    let cat = articulated_shape(Family::Cat, 3, &o).unwrap().mesh;
    for k in DamageKind::ALL {
        for s in 1..=5 {
            save(&format!("d-{}-{s}", k.name().replace(' ', "_")), bytes(&k.at(s).apply(&cat, 5)));
        }
    }
    for (i, k) in [
        Damage::Subdivide(1),
        Damage::Remesh,
        Damage::Slice(0.7),
        Damage::Slice(0.5),
        Damage::Move,
        Damage::Scale,
        Damage::Mirror,
    ]
    .into_iter()
    .enumerate()
    {
        save(&format!("e-{i}"), bytes(&k.apply(&cat, 6)));
    }
    let mut p = Vec::new();
    for s in scan(&cat, 500, 0.1, 3) {
        for c in s.position.iter() {
            p.extend(c.to_bits().to_le_bytes());
        }
    }
    save("scan", p);
    for f in broken_meshes() {
        save(&format!("z-{}", f.name), [f.defect.as_bytes(), &f.content].concat());
    }
}
