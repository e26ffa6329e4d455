//! `canonform info`.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use budget::Budget;
use mesh::io::{FileFacts, MeshFile};
use mesh::{MeshReport, RepairReport, Shortcut, ShortcutKind, cut_shortcuts, is_noisy, repair, validate};
use serde::Serialize;

use crate::args::{Common, InfoArgs};
use crate::input::{check_dropped, expand, named, read_file};
use crate::output::{exit_code, facts, print, print_json};

#[derive(Serialize)]
struct InfoJson {
    meshes: Vec<MeshInfo>,
    failed: Vec<Failure>,
}

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

#[derive(Serialize)]
struct Failure {
    path: PathBuf,
    error: String,
}

/// Reports on meshes; unreadable ones are listed and do not stop the others.
pub(crate) fn info(args: &InfoArgs, common: &Common) -> Result<ExitCode> {
    let mut json = InfoJson { meshes: Vec::new(), failed: Vec::new() };
    for path in expand(&args.meshes)?.into_iter().map(|shape| shape.path) {
        let report = read_file(&path, common).and_then(|MeshFile { mesh, facts, .. }| {
            let repaired =
                repair(&mesh, &args.repair.options()).map_err(|fault| named(&path, fault.into()))?;
            let mut shortcuts = cut_shortcuts(&repaired.mesh, &Budget::unlimited())?.shortcuts;
            // The first vertex of the input that was mapped to that of the repaired mesh.
            for shortcut in &mut shortcuts {
                let place = repaired.input_to_repaired.iter().position(|v| *v == Some(shortcut.vertex));
                shortcut.vertex = place.map_or(shortcut.vertex, Into::into);
            }
            let mesh = if mesh.faces.is_empty() { &repaired.mesh } else { &mesh };
            Ok((facts, validate(mesh), is_noisy(&repaired.mesh), shortcuts, repaired.report))
        });
        match report {
            Ok((file, mesh, noisy, shortcuts, repair)) => {
                let info = MeshInfo { path, file, mesh, noisy, shortcuts, repair };
                if !common.json {
                    print(&table(&info))?;
                }
                let name = info.path.display().to_string();
                check_dropped(&name, info.repair.dropped_area_share, args.repair.max_dropped);
                json.meshes.push(info);
            }
            Err(fault) => {
                let error = crate::remedy::message(&fault);
                terminal::error(&error);
                json.failed.push(Failure { path, error });
            }
        }
    }
    if common.json {
        print_json(&json)?;
    }
    Ok(exit_code(json.failed.is_empty()))
}

fn table(info: &MeshInfo) -> String {
    let mut rows = facts_of(&info.mesh);
    let FileFacts { unit, instances, ignored } = &info.file;
    rows.extend(unit.map(|unit| ("unit of length", unit.name().to_owned())));
    rows.extend(instances.filter(|n| *n > 1).map(|n| ("put together from", format!("{n} meshes"))));
    rows.extend(ignored.iter().map(|what| ("ignored", (*what).to_owned())));
    if info.noisy {
        rows.push(("noisy", "yes; compare, index and search smooth it first".to_owned()));
    }
    rows.extend(info.shortcuts.iter().map(|shortcut| ("probable shortcut", shortcut_in_words(shortcut))));
    let changes = info.repair.summary();
    if changes.is_empty() {
        rows.push(("would repair", "nothing".to_owned()));
    }
    rows.extend(changes.into_iter().map(|line| ("would repair", line)));
    format!("{}\n{}", info.path.display(), facts(&rows))
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
fn facts_of(mesh: &MeshReport) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        ("vertices, edges, faces", format!("{}, {}, {}", mesh.n_vertices, mesh.n_edges, mesh.n_faces)),
        ("components", mesh.n_components.to_string()),
        ("boundary", format!("{} edges in {} loops", mesh.n_boundary_edges, mesh.n_boundary_loops)),
        ("Euler characteristic", mesh.euler_characteristic.to_string()),
    ];
    if let Some(genus) = mesh.genus {
        rows.push(("genus", genus.to_string()));
    }
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
    if !mesh.orientable {
        rows.push(("orientable", "no".to_owned()));
    }
    rows
}
