//! Error messages with advice in terms of the command line.

use std::io::{self, ErrorKind};

use canonform::Remedy;
use server::ServerError;

use crate::args::spelled;

fn words(remedy: Remedy) -> String {
    remedy.in_words(|name, values| match name.contains(' ') {
        true => format!("`canonform {name}`"),
        false => spelled(&name.replace('_', "-"), values),
    })
}

/// What to do about a cause of an error, if that depends on the command line.
fn advice(cause: &(dyn std::error::Error + 'static)) -> Option<String> {
    if let Some(ServerError::Listen { source, .. }) = cause.downcast_ref() {
        let advice = match source.kind() {
            ErrorKind::AddrInUse => {
                "another program uses it: stop that program, or pass --listen with another port (0 takes a free port)"
            }
            ErrorKind::PermissionDenied => "pass --listen with a port above 1023",
            _ => "pass --listen with an address of this machine",
        };
        return Some(advice.to_owned());
    }
    if let Some(fault) = cause.downcast_ref() {
        return Remedy::from_index(fault).map(words);
    }
    if let Some(fault) = cause.downcast_ref::<io::Error>() {
        return base::files::remedy(fault).strip_prefix("; ").map(str::to_owned);
    }
    let fault = match cause.downcast_ref() {
        Some(ServerError::Index(fault)) => Some(fault),
        _ => cause.downcast_ref::<canonform::Error>(),
    };
    fault?.remedy().map(words)
}

/// A message with its remedy.
pub(crate) fn with_remedy(message: String, remedy: Option<Remedy>) -> String {
    [Some(message), remedy.map(words)].into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// The message of an error with its remedy.
pub(crate) fn message(error: &anyhow::Error) -> String {
    let message = base::terminal::message(error);
    match error.chain().find_map(advice).filter(|advice| !message.contains(advice)) {
        Some(advice) => format!("{message}; {advice}"),
        None => message,
    }
}

/// The same error with its remedy in front of its causes.
pub(crate) fn remedied(error: anyhow::Error) -> anyhow::Error {
    let message = message(&error);
    error.context(message)
}
