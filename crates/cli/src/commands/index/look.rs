//! `canonform index verify | info | export`.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Result;
use index::{ExportError, Index, work_path};
use serde::Serialize;

use crate::args::{Common, ExportArgs, OneIndexArgs};
use crate::output::{check_folder, facts, print, print_json};

#[derive(Serialize)]
struct VerifyJson {
    index: PathBuf,
    sound: bool,
    n_shapes: usize,
    n_bytes: u64,
    faults: Vec<String>,
}

pub(super) fn verify(args: &OneIndexArgs, common: &Common) -> Result<ExitCode> {
    let found = index::verify(&args.index, || ())?;
    let sound = found.faults.is_empty();
    if common.json {
        let (n_shapes, n_bytes) = (found.n_shapes, found.n_bytes);
        print_json(&VerifyJson {
            index: args.index.clone(),
            sound,
            n_shapes,
            n_bytes,
            faults: found.faults.clone(),
        })?;
    } else if sound {
        print(&format!(
            "{}: sound, {} shapes, {} bytes",
            args.index.display(),
            found.n_shapes,
            found.n_bytes
        ))?;
    }
    for fault in &found.faults {
        eprintln!("error: {} is damaged: {fault}; restore it, or build it again", args.index.display());
    }
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::from(2) })
}

#[derive(Serialize)]
struct InfoJson {
    index: PathBuf,
    format: u32,
    n_shapes: usize,
    n_bytes: u64,
    options: serde_json::Value,
    classes: BTreeMap<String, usize>,
    /// Where unfinished work lies, if there is any.
    unfinished: Option<PathBuf>,
}

pub(super) fn info(args: &OneIndexArgs, common: &Common) -> Result<ExitCode> {
    let index = Index::open(&args.index)?;
    let mut classes = BTreeMap::new();
    for (_, entry) in index.entries()? {
        *classes.entry(entry.label).or_insert(0) += 1;
    }
    let unfinished = Some(work_path(&args.index)).filter(|work| work.exists());
    let options = serde_json::from_str(index.options()).unwrap_or_else(|_| index.options().into());
    let json = InfoJson {
        index: args.index.clone(),
        format: index::FORMAT_VERSION,
        n_shapes: index.len(),
        n_bytes: index.n_bytes(),
        options,
        classes,
        unfinished,
    };
    match common.json {
        true => print_json(&json)?,
        false => print(&table(&json))?,
    }
    Ok(ExitCode::SUCCESS)
}

fn table(json: &InfoJson) -> String {
    let classes: Vec<String> = json.classes.iter().map(|(class, n)| format!("{class} {n}")).collect();
    let mut rows = vec![
        ("shapes", json.n_shapes.to_string()),
        ("classes", format!("{}: {}", classes.len(), classes.join(", "))),
        ("bytes", json.n_bytes.to_string()),
        ("format", json.format.to_string()),
        ("described by", json.options.to_string()),
    ];
    if let Some(work) = &json.unfinished {
        rows.push(("unfinished", format!("{}: run the interrupted command again", work.display())));
    }
    facts(&rows)
}

pub(super) fn export(args: &ExportArgs, _: &Common) -> Result<ExitCode> {
    let index = Index::open(&args.index)?;
    match &args.output {
        None => {
            let mut out = std::io::BufWriter::with_capacity(1 << 16, std::io::stdout().lock());
            match index.export(&mut out).and_then(|()| Ok(out.flush()?)) {
                Err(ExportError::Write(fault)) => Err(fault)?,
                other => other?,
            }
        }
        Some(path) => {
            check_folder(path)?;
            let mut stopped = None;
            let written = files::write_atomically(path, |out| match index.export(out) {
                Ok(()) => Ok(()),
                Err(ExportError::Write(fault)) => Err(fault),
                Err(ExportError::Index(fault)) => {
                    stopped = Some(fault);
                    Err(std::io::Error::other("the index cannot be read"))
                }
            });
            match stopped {
                Some(fault) => Err(fault)?,
                None => written?,
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}
