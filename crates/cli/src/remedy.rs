//! Error messages with advice in terms of the command line. No other place words a remedy as options.

use std::io::{self, ErrorKind};

use canonform::Remedy;
use server::ServerError;

fn words(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::KeepLargestOrBridge => "pass --components largest or --components bridge",
        Remedy::BridgeComponents => "to keep all components, pass --components bridge",
        Remedy::BridgeOrWeld => {
            "pass --components bridge to keep all components, --weld TOL to close gaps up to TOL wide, or \
             --max-dropped SHARE to accept the loss"
        }
        Remedy::UseThreeDimensions => "leave out --dim",
        Remedy::UseFastMarching => "use fast-marching",
        Remedy::UseNystrom => "use --method nmds, which needs only a few columns",
        Remedy::GiveSamples => "give the number of samples, such as -n 100",
        Remedy::RaiseMemory => "raise --memory",
        Remedy::RaiseTimeLimit => "raise --timeout",
        Remedy::RaiseMaxDistance => "choose another target, or raise --max-distance",
        Remedy::GiveLabels => "give classes with --labels FILE.csv",
        Remedy::ReplaceShape => "rename the new shape, remove the old one, or pass --replace",
        Remedy::RestoreMesh => {
            "restore the file, move the index back to the place where it was built, or build the index again"
        }
        Remedy::BuildIndexAgain => {
            "restore the index from a copy, or build it again with `canonform index build`"
        }
        Remedy::BuildIndexAnew => "build the index with `canonform index build` in a new file",
        Remedy::BuildFieldAgain => "build it again with `canonform field build`",
        Remedy::ListShapes => "`canonform index list` names its shapes",
        Remedy::EvaluateShard => "evaluate one shard at a time",
        Remedy::NameMember => "name one of them, as ARCHIVE/NAME",
    }
}

/// What to do about a cause of an error, if that depends on the command line.
fn advice(cause: &(dyn std::error::Error + 'static)) -> Option<&'static str> {
    if let Some(ServerError::Listen { source, .. }) = cause.downcast_ref() {
        return Some(match source.kind() {
            ErrorKind::AddrInUse => {
                "another program uses it: stop that program, or pass --listen with another port (0 takes a free port)"
            }
            ErrorKind::PermissionDenied => "pass --listen with a port above 1023",
            _ => "pass --listen with an address of this machine",
        });
    }
    if let Some(fault) = cause.downcast_ref() {
        return Remedy::from_index(fault).map(words);
    }
    if let Some(fault) = cause.downcast_ref::<io::Error>() {
        return base::files::remedy(fault).strip_prefix("; ");
    }
    let fault = match cause.downcast_ref() {
        Some(ServerError::Index(fault)) => Some(fault),
        _ => cause.downcast_ref::<canonform::Error>(),
    };
    fault?.remedy().map(words)
}

/// A message with its remedy.
pub(crate) fn with_remedy(message: String, remedy: Option<Remedy>) -> String {
    with_advice(message, remedy.map(words))
}

/// The message of an error with its remedy.
pub(crate) fn message(error: &anyhow::Error) -> String {
    let message = base::terminal::message(error);
    let advice = error.chain().find_map(advice).filter(|advice| !message.contains(advice));
    with_advice(message, advice)
}

fn with_advice(message: String, advice: Option<&str>) -> String {
    [Some(message.as_str()), advice].into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// The same error with its remedy in front of its causes.
pub(crate) fn remedied(error: anyhow::Error) -> anyhow::Error {
    let message = message(&error);
    error.context(message)
}
