//! Writes creatures as a collection, a folder for each family:
//! `cargo run -p canonform-datasets --example creatures -- FOLDER FAMILIES POSES SEED`.

use std::error::Error;
use std::fs;
use std::path::Path;

use canonform_datasets::{CreatureOptions, creatures};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, n_families, n_poses, seed] = &arguments[..] else {
        return Err("use: creatures FOLDER FAMILIES POSES SEED".into());
    };
    let options = CreatureOptions {
        seed: seed.parse()?,
        n_families: n_families.parse()?,
        n_poses: n_poses.parse()?,
        ..CreatureOptions::default()
    };
    for shape in creatures(&options)? {
        let family = Path::new(folder).join(&shape.label);
        fs::create_dir_all(&family)?;
        mesh::io::write(&family.join(format!("{}.off", shape.name)), &shape.mesh)?;
    }
    Ok(())
}
