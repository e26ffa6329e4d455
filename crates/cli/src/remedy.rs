//! What to do about an error, in terms of the command line.

use anyhow::Error;
use canonform::Remedy;

/// The options and commands that a remedy means.
pub(crate) fn words(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::KeepLargestOrBridge => "pass --components largest or --components bridge",
        Remedy::BridgeComponents => "to keep all components, pass --components bridge",
        Remedy::UseThreeDimensions => "leave out --dim",
        Remedy::UseFastMarching => "use fast-marching",
        Remedy::UseNystrom => "use --method nmds, which needs a few columns only",
        Remedy::RaiseMemory => "raise --memory",
        Remedy::RaiseMaxDistance => "choose another target, or raise --max-distance",
        Remedy::GiveLabels => "give classes with --labels FILE.csv",
        Remedy::ReplaceShape => "rename the new one, remove the old one, or pass --replace",
        Remedy::RestoreMesh => {
            "put the file back, start in the folder that the index was built in, or build the index again"
        }
        Remedy::BuildIndexAgain => "build the index again with `canonform index build`",
        Remedy::EvaluateShard => "evaluate one shard at a time",
        _ => "see `canonform --help`",
    }
}

/// A message with its remedy.
pub(crate) fn with_remedy(message: &str, remedy: Option<Remedy>) -> String {
    remedy.map_or_else(|| message.to_owned(), |remedy| format!("{message}; {}", words(remedy)))
}

/// The message of an error with its remedy, as people read it.
pub(crate) fn message(error: &Error) -> String {
    let remedy = error.chain().find_map(|cause| cause.downcast_ref::<canonform::Error>()?.remedy());
    with_remedy(&terminal::message(error), remedy)
}

/// The same error with its remedy in front of its causes.
pub(crate) fn remedied(error: Error) -> Error {
    let message = message(&error);
    error.context(message)
}
