//! `canonform info`.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use base::object;
use canonform::mesh::io::{FileFacts, MeshFile, extension};
use canonform::mesh::{
    MeshReport, RepairReport, Shortcut, ShortcutKind, cut_shortcuts, is_noisy, repair, validate,
};
use serde::Serialize;

use crate::args::{Common, InfoArgs};
use crate::batch::Failure;
use crate::input::{check_dropped, expand, named, read_file};
use crate::output::{Answer, Fact, count, exit_code, print, print_json};

#[derive(Serialize)]
struct MeshInfo {
    path: PathBuf,
    /// What the file says beside the mesh.
    file: FileFacts,
    mesh: MeshReport,
    /// Whether comparison and search smooth the repaired mesh, because it is noisy.
    noisy: bool,
    /// Places where distant parts of the repaired surface are joined; comparison and search separate them.
    shortcuts: Vec<Shortcut>,
    /// What a repair would change.
    repair: RepairReport,
}

/// Reports on meshes; unreadable ones are listed and do not stop the others.
pub(crate) fn info(args: &InfoArgs, common: &Common) -> Result<ExitCode> {
    let (mut meshes, mut failed) = (Vec::new(), Vec::new());
    for path in expand(&args.meshes)?.into_iter().map(|shape| shape.path) {
        let report = read_file(&path, common).and_then(|MeshFile { mesh, facts, .. }| {
            let repaired =
                repair(&mesh, &args.repair.options(), &()).map_err(|fault| named(&path, fault.into()))?;
            let mut shortcuts = cut_shortcuts(&repaired.mesh, repaired.intrinsic.topology(), &())?.shortcuts;
            for shortcut in &mut shortcuts {
                shortcut.vertex = repaired.remap.to_old(shortcut.vertex);
            }
            let (path, noisy) = (path.clone(), is_noisy(&repaired.mesh));
            let mesh = validate(if mesh.faces.is_empty() { &repaired.mesh } else { &mesh });
            Ok(MeshInfo { path, file: facts, mesh, noisy, shortcuts, repair: repaired.report })
        });
        match report {
            Ok(info) => {
                if !common.json {
                    print(&answer(&info).text(common))?;
                }
                let name = info.path.display().to_string();
                check_dropped(&name, info.repair.dropped_area_share, args.repair.max_dropped);
                meshes.push(info);
            }
            Err(fault) => failed.push(Failure::new(path, &fault)),
        }
    }
    let code = exit_code(failed.is_empty());
    if common.json {
        print_json(&object! { meshes, failed })?;
    } else if meshes.len() > 1 {
        let mut formats = BTreeMap::<String, usize>::new();
        meshes.iter().for_each(|mesh| *formats.entry(extension(&mesh.path)).or_default() += 1);
        let formats: Vec<String> = formats.iter().map(|(format, n)| format!("{n} {format}")).collect();
        print(&format!("{} meshes: {}", meshes.len(), formats.join(", ")))?;
    }
    Ok(code)
}

fn answer(info: &MeshInfo) -> Answer {
    let mesh = &info.mesh;
    let kind = match (mesh.n_components, mesh.n_boundary_edges) {
        (1, 0) => "a closed surface".to_owned(),
        (1, _) => format!("a surface with {}", count(mesh.n_boundary_loops, "boundary loop")),
        (n, _) => format!("a surface in {n} pieces"),
    };
    let uncertainty = info.repair.uncertainty();
    let mut changes = info.repair.summary();
    changes.retain(|line| Some(line) != uncertainty.as_ref());
    let repair = match (changes.is_empty(), &uncertainty) {
        (true, None) => "nothing to repair",
        (true, Some(_)) => "its coordinates are coarse",
        (false, _) => "it would be repaired",
    };
    let (path, n_vertices, n_faces) = (info.path.display(), mesh.n_vertices, mesh.n_faces);
    // Five significant digits.
    let short = |x: f64| format!("{x:.4e}").parse().unwrap_or(x);
    let [length, width, height] = mesh.size.map(short);
    let mut size = format!("{length} x {width} x {height}");
    size.extend(mesh.volume.map(|volume| format!(", volume {}", short(volume))));
    let mut facts = vec![("size", size)];
    facts.extend((!changes.is_empty()).then(|| ("would repair", changes.join("; "))));
    let noisy = "yes; compare, index and search smooth it first";
    facts.extend(info.noisy.then(|| ("noisy", noisy.to_owned())));
    facts.extend(info.shortcuts.first().map(|first| {
        let more = info.shortcuts.len() - 1;
        let more = if more > 0 { format!(" (and {more} more, see --details)") } else { String::new() };
        ("probable shortcut", shortcut_in_words(first) + &more)
    }));
    let ignored = &info.file.ignored;
    facts.extend((!ignored.is_empty()).then(|| ("ignored", ignored.join(", "))));
    let notes = info.file.notes.iter().cloned().chain(uncertainty);
    facts.extend(notes.map(|note| ("uncertain", note)));
    let mut details = facts_of(mesh);
    let FileFacts { unit, instances, .. } = &info.file;
    details.extend(unit.map(|unit| ("unit of length", unit.name().to_owned())));
    details.extend(instances.filter(|n| *n > 1).map(|n| ("put together from", format!("{n} meshes"))));
    let others = info.shortcuts.iter().skip(1);
    details.extend(others.map(|shortcut| ("probable shortcut", shortcut_in_words(shortcut))));
    Answer {
        sentence: format!("{path}: {kind}, {n_vertices} vertices and {n_faces} faces; {repair}"),
        facts,
        details,
    }
}

fn shortcut_in_words(shortcut: &Shortcut) -> String {
    let Shortcut { kind, vertex, girth, detour } = shortcut;
    let what = match kind {
        ShortcutKind::Pinch => format!("parts share vertex {vertex}"),
        ShortcutKind::Handle => format!("a handle {girth:.4} around at vertex {vertex}"),
    };
    format!("{what}; without it, its sides are {detour:.4} apart; compare, index and search cut it")
}

/// General properties, then the defects that were found.
fn facts_of(mesh: &MeshReport) -> Vec<Fact> {
    let mut rows = vec![
        ("vertices, edges, faces", format!("{}, {}, {}", mesh.n_vertices, mesh.n_edges, mesh.n_faces)),
        ("components", mesh.n_components.to_string()),
        ("boundary", format!("{} edges in {} loops", mesh.n_boundary_edges, mesh.n_boundary_loops)),
        ("Euler characteristic", mesh.euler_characteristic.to_string()),
    ];
    rows.extend(mesh.genus.map(|genus| ("genus", genus.to_string())));
    rows.extend([
        ("area", format!("{:.6}", mesh.area)),
        ("bounding box diagonal", format!("{:.6}", mesh.bounding_box_diagonal)),
        (
            "edge length",
            format!(
                "{:.4e} to {:.4e}, mean {:.4e}",
                mesh.min_edge_length, mesh.max_edge_length, mesh.mean_edge_length
            ),
        ),
        ("obtuse triangles", format!("{:.1} %", 100.0 * mesh.obtuse_share)),
    ]);
    let faults = [
        ("degenerate faces", mesh.degenerate_faces),
        ("duplicate faces", mesh.duplicate_faces),
        ("faces without area", mesh.zero_area_faces),
        ("unreferenced vertices", mesh.unreferenced_vertices),
        ("duplicate vertices", mesh.duplicate_vertices),
        ("non-manifold edges", mesh.non_manifold_edges),
        ("non-manifold vertices", mesh.non_manifold_vertices),
        ("flipped faces", mesh.flipped_faces),
    ];
    rows.extend(faults.into_iter().filter(|(_, n)| *n > 0).map(|(name, n)| (name, n.to_string())));
    rows.extend((!mesh.orientable).then(|| ("orientable", "no".to_owned())));
    rows
}
