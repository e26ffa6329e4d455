//! The chapters of the user guide that run `experiments`.

use std::path::Path;

use guide::Chapter;

#[test]
#[ignore = "slow: make test-all"]
fn the_guide_shows_what_experiments_do() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/guide");
    let chapters = Chapter::all(&folder).unwrap();
    let ours: Vec<&Chapter> = chapters.iter().filter(|chapter| chapter.runs("experiments")).collect();
    assert!(!ours.is_empty());
    for chapter in ours {
        let program = Path::new(env!("CARGO_BIN_EXE_experiments"));
        let run = guide::run(chapter, &[program], &[]).unwrap();
        if std::env::var_os("CANONFORM_WRITE_DOCS").is_some() {
            std::fs::write(&chapter.path, run.updated(chapter)).unwrap();
        }
        assert!(run.faults.is_empty(), "{}", run.faults.join("\n"));
    }
}
