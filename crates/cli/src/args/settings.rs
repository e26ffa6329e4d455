//! Options of the library as flags.

use anyhow::{Result, anyhow};
use canonform::embed::FormOptions;
use canonform::geodesics::Method;
use canonform::mesh::RepairOptions;
use canonform::settings::{
    FormSettings, Geodesic, MarchingSettings, MethodSettings, NoEffect, RepairSettings,
};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Command};

use super::shared::{Common, read};

/// A setting with the values that it may have, as on the command line.
pub(crate) fn spelled(name: &str, values: &[&str]) -> String {
    let command = MethodSettings::augment_args(Command::new(""));
    let arg = command.get_arguments().find(|arg| arg.get_id() == name);
    let flag = arg.and_then(|arg| arg.get_long()).unwrap_or(name);
    format!("--{flag} {}", values.join(" or ")).trim_end().to_owned()
}

/// How distances are measured, where the flag for it is `--method`.
///
/// # Errors
/// Options that do not apply to it.
pub(crate) fn geodesic_method(marching: &MarchingSettings, method: Geodesic) -> Result<Method> {
    let spell =
        |name: &str, values: &[&str]| spelled(if name == "geodesic" { "method" } else { name }, values);
    marching.method(method).map_err(|fault: NoEffect| anyhow!(fault.in_words(spell)))
}

/// Reads values by their names, each with a line of help.
pub(crate) fn one_of<T: Clone + Send + Sync + 'static>(
    values: Vec<(&'static str, &'static str, T)>,
) -> impl TypedValueParser<Value = T> {
    let names = values.iter().map(|(name, help, _)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(names).try_map(move |chosen| {
        let found = values.iter().find(|(name, ..)| *name == chosen);
        found.map(|(.., value)| value.clone()).ok_or_else(|| format!("`{chosen}` is unknown"))
    })
}

/// How meshes are repaired before anything is measured.
#[derive(Debug, Clone, Args)]
pub(crate) struct RepairArgs {
    #[command(flatten)]
    settings: RepairSettings,
    /// Exit with code 1 if more than this share of the surface is dropped; results are still written
    #[arg(long, help_heading = "Repair", value_parser = share, default_value_t = MAX_DROPPED, value_name = "SHARE")]
    pub(crate) max_dropped: f64,
}

/// The share of a surface that a repair may drop by default.
pub(crate) const MAX_DROPPED: f64 = 0.01;

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    read(text, share, "a share of the surface; give a number from 0 to 1")
}

impl RepairArgs {
    pub(crate) fn options(&self) -> RepairOptions {
        self.settings.options()
    }
}

/// Everything that decides the form of a mesh, except the method.
#[derive(Debug, Clone, Args)]
pub(crate) struct FormArgs {
    #[command(flatten)]
    pub(crate) form: FormSettings,
    #[command(flatten)]
    pub(crate) marching: MarchingSettings,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
}

impl FormArgs {
    /// # Errors
    /// Options that do not apply together.
    pub(crate) fn options(&self, method: &MethodSettings, common: &Common) -> Result<FormOptions> {
        let options = self.form.options(method, &self.marching, &self.repair.settings);
        let options = options.map_err(|fault: NoEffect| anyhow!(fault.in_words(spelled)))?;
        Ok(FormOptions { seed: common.seed, ..options })
    }
}

#[cfg(test)]
mod tests {
    use canonform::DescribeOptions;
    use canonform::settings::DescriptionSettings;
    use clap::FromArgMatches;

    use super::*;

    #[derive(Debug, Args)]
    struct All {
        #[command(flatten)]
        method: MethodSettings,
        #[command(flatten)]
        form: FormArgs,
        #[command(flatten)]
        description: DescriptionSettings,
    }

    fn described(words: &str) -> DescribeOptions {
        let command = All::augment_args(Command::new("describe").no_binary_name(true));
        let all =
            All::from_arg_matches(&command.try_get_matches_from(words.split_whitespace()).unwrap()).unwrap();
        let FormArgs { form, marching, repair } = &all.form;
        all.description.options(form.options(&all.method, marching, &repair.settings).unwrap())
    }

    /// Every option of a description with a value that is not the default, and what has to be beside it.
    const OTHERS: [(&str, &str); 20] = [
        ("--method spectral", ""),
        ("--samples 50", ""),
        ("--dim 2", ""),
        ("--geodesic exact", ""),
        ("--update planar", ""),
        ("--obtuse ignore", ""),
        ("--components bridge", ""),
        ("--weld 0.5", ""),
        ("--rank 30", ""),
        ("--sampling random", ""),
        ("--first-sample 7", ""),
        ("--regularization cur", ""),
        ("--alpha paper", "--regularization rpi"),
        ("--sigma median", "--method kpca"),
        ("--eigenvectors 60", "--method spectral"),
        ("--mu inf", "--method spectral"),
        ("--iterations 5", "--method smacof"),
        ("--tolerance 0.1", "--method smacof"),
        ("--points 500", ""),
        ("--size", ""),
    ];

    #[test]
    fn every_option_of_a_description_is_stored_and_its_default_is_stated() {
        let command = All::augment_args(Command::new("describe"));
        let options = command.get_arguments().filter(|arg| arg.get_long() != Some("max-dropped"));
        for option in options {
            let flag = format!("--{}", option.get_long().unwrap());
            let is_of = |(other, _): &(&str, &str)| other.split(' ').next() == Some(&flag);
            let (other, beside) = OTHERS.into_iter().find(is_of).unwrap_or_else(|| panic!("{flag}"));
            let usual = described(beside);
            let changed = described(&format!("{beside} {other}"));
            assert_ne!(changed.text(), usual.text(), "{flag}");
            assert_eq!(DescribeOptions::from_text(&changed.text()), Some(changed), "{flag}");
            let help = option.get_help().unwrap().to_string();
            let stated = help.split_once("[default: ").map(|(_, default)| default.trim_end_matches(']'));
            match stated {
                Some(default) if !default.contains(' ') => {
                    assert_eq!(
                        described(&format!("{beside} {flag} {default}")),
                        usual,
                        "the default of {flag}"
                    );
                }
                Some(_) => assert!(["--rank", "--first-sample"].contains(&flag.as_str()), "{flag}"),
                None => assert!(["--weld", "--size"].contains(&flag.as_str()), "{flag} states no default"),
            }
        }
    }
}
