//! Options of the library as flags, made of its schema.

use std::marker::PhantomData;

use anyhow::{Result, anyhow};
use canonform::geodesics::Method;
use canonform::mesh::RepairOptions;
use canonform::settings::{Named, NoEffect, OptionGroup, OptionSpec, SCHEMA, Settings};
use canonform::{DescribeOptions, FormOptions};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};

use super::shared::Common;

/// The groups of options that a command has.
pub(crate) trait Groups: Clone + std::fmt::Debug {
    const GROUPS: &'static [OptionGroup];
}

/// Declares sets of groups.
macro_rules! groups {
    ($($name:ident: $($group:ident)+;)+) => {$(
        #[derive(Debug, Clone)]
        pub(crate) struct $name;

        impl Groups for $name {
            const GROUPS: &'static [OptionGroup] = &[$(OptionGroup::$group),+];
        }
    )+};
}

groups! {
    OfRepair: Repair;
    OfDistances: Marching;
    OfForm: Form Marching;
    OfMaps: Form Marching Maps;
    OfEmbedding: Method Form Marching Stress;
    OfComparison: Method Form Marching;
    OfDescription: Method Form Marching Description;
}

/// The flags of some groups of options.
#[derive(Debug, Clone)]
pub(crate) struct SettingArgs<G> {
    /// The options that were given.
    pub(crate) given: Settings,
    groups: PhantomData<G>,
}

fn options_of<G: Groups>() -> impl Iterator<Item = &'static OptionSpec> {
    SCHEMA.iter().filter(|option| G::GROUPS.contains(&option.group))
}

/// The name of an option as a flag.
fn flag(name: &str) -> String {
    format!("--{}", name.replace('_', "-"))
}

/// A setting with the values that it may have, as on the command line.
fn spelled(name: &str, values: &[&str]) -> String {
    format!("{} {}", flag(name), values.join(" or ")).trim_end().to_owned()
}

fn heading(group: OptionGroup) -> Option<&'static str> {
    match group {
        OptionGroup::Method | OptionGroup::Form => Some("Embedding"),
        OptionGroup::Marching => Some("Fast marching"),
        OptionGroup::Repair => Some("Repair"),
        _ => None,
    }
}

fn arg(option: &'static OptionSpec) -> Arg {
    let help = option.help(flag);
    let arg = Arg::new(option.name)
        .long(option.name.replace('_', "-"))
        .help_heading(heading(option.group))
        .hide_short_help(option.is_advanced);
    let arg = match help.split_once("\n\n") {
        Some((first, _)) => arg.help(first.to_owned()).long_help(help),
        None => arg.help(help),
    };
    let arg = if option.name == "samples" { arg.short('n') } else { arg };
    if option.is_switch() {
        return arg.action(ArgAction::SetTrue);
    }
    let names = option.names();
    let arg = match option.placeholder {
        "" => arg.value_name(option.name.to_uppercase()),
        placeholder => arg.value_name(placeholder),
    };
    if names.is_empty() {
        return arg.value_parser(|text: &str| option.check(text).map(|()| text.to_owned()));
    }
    arg.value_parser(possible(names))
}

fn possible(names: impl IntoIterator<Item = (&'static str, &'static str)>) -> PossibleValuesParser {
    PossibleValuesParser::new(names.into_iter().map(|(name, help)| PossibleValue::new(name).help(help)))
}

/// Reads values by their names, each with a line of help.
pub(crate) fn one_of<T: Clone + Send + Sync + 'static>(
    values: Vec<(&'static str, &'static str, T)>,
) -> impl TypedValueParser<Value = T> {
    possible(values.iter().map(|(name, help, _)| (*name, *help))).try_map(move |chosen| {
        let found = values.iter().find(|(name, ..)| *name == chosen);
        found.map(|(.., value)| value.clone()).ok_or_else(|| format!("`{chosen}` is unknown"))
    })
}

/// Reads a distance method by its name.
pub(crate) fn distance_method() -> impl TypedValueParser<Value = Method> {
    one_of(Method::table())
}

impl<G: Groups> Args for SettingArgs<G> {
    fn augment_args(command: Command) -> Command {
        command.args(options_of::<G>().map(arg))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<G: Groups> FromArgMatches for SettingArgs<G> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut args = Self { given: Settings::default(), groups: PhantomData };
        args.update_from_arg_matches(matches)?;
        Ok(args)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        for option in options_of::<G>() {
            let text = match option.is_switch() {
                true => matches.get_flag(option.name).then_some("true"),
                false => matches.get_one(option.name).map(String::as_str),
            };
            if let Some(text) = text {
                let wrong = |fault| clap::Error::raw(clap::error::ErrorKind::InvalidValue, fault);
                self.given.set(option.name, text).map_err(wrong)?;
            }
        }
        Ok(())
    }
}

impl<G> SettingArgs<G> {
    /// A method, with the options of fast marching if it is that.
    pub(crate) fn distances(&self, method: Method) -> Method {
        self.given.distances(method)
    }
}

/// How meshes are repaired before anything is measured.
#[derive(Debug, Clone, Args)]
pub(crate) struct RepairArgs {
    #[command(flatten)]
    settings: SettingArgs<OfRepair>,
    /// Exit with code 1 if more than this share of the surface is dropped; results are still written
    #[arg(long, help_heading = "Repair", value_parser = share, default_value_t = MAX_DROPPED, value_name = "SHARE")]
    pub(crate) max_dropped: f64,
}

/// The share of a surface that a repair may drop by default.
pub(crate) const MAX_DROPPED: f64 = 0.01;

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| format!("`{text}` is not a share of the surface; give a number from 0 to 1"))
}

impl RepairArgs {
    pub(crate) fn options(&self) -> RepairOptions {
        self.settings.given.repair()
    }
}

/// Everything that decides the form of a mesh.
#[derive(Debug, Clone, Args)]
pub(crate) struct FormArgs<G: Groups> {
    #[command(flatten)]
    pub(crate) settings: SettingArgs<G>,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
}

impl<G: Groups> FormArgs<G> {
    /// # Errors
    /// Options that do not apply together.
    pub(crate) fn options(&self, common: &Common) -> Result<FormOptions> {
        Ok(self.describe_options(common)?.form)
    }

    /// # Errors
    /// As [`options`](Self::options).
    pub(crate) fn describe_options(&self, common: &Common) -> Result<DescribeOptions> {
        let settings = self.settings.given.and(&self.repair.settings.given);
        let mut options = settings.describe().map_err(|fault: NoEffect| anyhow!(fault.in_words(spelled)))?;
        options.form.seed = common.seed;
        Ok(options)
    }

    /// The value chosen for an option, or its default.
    pub(crate) fn chosen<T: Named + Default>(&self, name: &str) -> T {
        self.settings.given.chosen(name).unwrap_or_default()
    }
}
