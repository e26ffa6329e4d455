//! Settings as users give them, one by one: flags of a program or keyword arguments.

use std::collections::BTreeMap;
use std::str::FromStr;

use descriptors::Normalization;
use geodesics::{FastMarchingOptions, FirstSample, Method};
use mesh::{Orient, RepairOptions};
use nmds::Regularization;
use surface::VertexId;

use super::method::EmbedMethod;
use super::options::{DescribeOptions, FormOptions};

pub use super::schema::{Named, OptionGroup, OptionSpec, SCHEMA};

/// The settings that were given: values of options of the [`SCHEMA`].
///
/// ```
/// use canonform::EmbedMethod;
/// use canonform::settings::Settings;
///
/// let mut settings = Settings::default();
/// settings.set("rank", "30")?;
/// assert_eq!(settings.form()?.method, EmbedMethod::low_rank(30));
///
/// settings.set("method", "landmark")?;
/// let fault = settings.form().unwrap_err();
/// assert_eq!(fault.to_string(), "rank has no effect with method landmark; leave it out, or use method nmds or kpca or smacof");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Settings(BTreeMap<&'static str, String>);

/// A setting that would change nothing beside another one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NoEffect {
    /// Name of the setting.
    pub setting: &'static str,
    /// Name of the other setting.
    pub beside: &'static str,
    /// Value of the other setting.
    pub value: &'static str,
    /// Values of the other setting with which the setting has an effect.
    pub instead: Vec<&'static str>,
}

impl NoEffect {
    /// The message, with settings as `spell` writes them: a name, and the values that it may have, or none.
    pub fn in_words(&self, spell: impl Fn(&str, &[&str]) -> String) -> String {
        let (setting, with) = (spell(self.setting, &[]), spell(self.beside, &[self.value]));
        let instead = spell(self.beside, &self.instead);
        format!("{setting} has no effect with {with}; leave it out, or use {instead}")
    }
}

impl std::fmt::Display for NoEffect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let plain =
            |name: &str, values: &[&str]| format!("{name} {}", values.join(" or ")).trim_end().to_owned();
        f.write_str(&self.in_words(plain))
    }
}

impl std::error::Error for NoEffect {}

impl Settings {
    /// Gives an option a value.
    ///
    /// # Errors
    /// There is no such option, or the value is not possible; the message says what is.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
        let option = OptionSpec::named(name).ok_or_else(|| format!("there is no option {name}"))?;
        option.check(text)?;
        self.0.insert(option.name, text.to_owned());
        Ok(())
    }

    /// These settings and those of another group.
    #[must_use]
    pub fn and(&self, others: &Self) -> Self {
        Self(self.0.clone().into_iter().chain(others.0.clone()).collect())
    }

    /// Whether an option has been given a value.
    pub fn is_given(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    /// The number or text given for an option.
    pub fn get<T: FromStr>(&self, name: &str) -> Option<T> {
        self.0.get(name)?.parse().ok()
    }

    /// The value chosen by name for an option.
    pub fn chosen<T: Named>(&self, name: &str) -> Option<T> {
        T::named(self.0.get(name)?)
    }

    /// How meshes are repaired.
    pub fn repair(&self) -> RepairOptions {
        let usual = RepairOptions::default();
        RepairOptions {
            components: self.chosen("components").unwrap_or(usual.components),
            weld: self.get("weld").unwrap_or(usual.weld),
            orient: Orient::Keep,
        }
    }

    /// A method of distances, with the options of fast marching if it is that.
    pub fn distances(&self, method: Method) -> Method {
        match method {
            Method::FastMarching(_) => Method::FastMarching(FastMarchingOptions {
                update: self.chosen("update").unwrap_or_default(),
                obtuse: self.chosen("obtuse").unwrap_or_default(),
            }),
            other => other,
        }
    }

    /// Refuses options of fast marching beside another method, the value of the option `name`.
    ///
    /// # Errors
    /// [`NoEffect`].
    pub fn check_distances(&self, name: &'static str, method: Method) -> Result<(), NoEffect> {
        let given = ["update", "obtuse"].into_iter().find(|option| self.is_given(option));
        match (method, given) {
            (Method::FastMarching(_), _) | (_, None) => Ok(()),
            (other, Some(setting)) => {
                let instead = vec![Method::default().name()];
                Err(NoEffect { setting, beside: name, value: other.name(), instead })
            }
        }
    }

    /// How a form is made, with seed 0.
    ///
    /// # Errors
    /// [`NoEffect`] if a setting of the method was given that would change nothing.
    pub fn form(&self) -> Result<FormOptions, NoEffect> {
        let mut method: EmbedMethod = self.chosen("method").unwrap_or_default();
        self.check(&method)?;
        match &mut method {
            EmbedMethod::Nystrom { regularization } => *regularization = self.regularization(),
            EmbedMethod::Spectral { eigenvectors, mu } => {
                self.apply("eigenvectors", eigenvectors);
                self.apply("mu", mu);
            }
            EmbedMethod::KernelPca { rank, bandwidth } => {
                *rank = self.get("rank");
                self.apply("sigma", bandwidth);
            }
            EmbedMethod::Smacof { regularization, descent } => {
                *regularization = self.regularization();
                self.apply("iterations", &mut descent.max_iterations);
                self.apply("tolerance", &mut descent.tolerance);
            }
            EmbedMethod::Classical | EmbedMethod::Landmark => {}
        }
        let usual = FormOptions::default();
        let first_sample = self.get("first_sample").map(|v| FirstSample::Vertex(VertexId(v)));
        Ok(FormOptions {
            repair: self.repair(),
            geodesic: self.distances(self.chosen("geodesic").unwrap_or_default()),
            samples: self.get("samples").unwrap_or_default(),
            sampling: self.chosen("sampling").unwrap_or_default(),
            first_sample: first_sample.unwrap_or(FirstSample::Farthest),
            method,
            dim: self.get("dim").unwrap_or(usual.dim),
            seed: usual.seed,
        })
    }

    /// How shapes are described, with seed 0.
    ///
    /// # Errors
    /// As [`form`](Self::form).
    pub fn describe(&self) -> Result<DescribeOptions, NoEffect> {
        let usual = DescribeOptions::default();
        let counts = self.get("size").unwrap_or(false);
        Ok(DescribeOptions {
            form: self.form()?,
            points: self.get("points").unwrap_or(usual.points),
            size: if counts { Normalization::Raw } else { usual.size },
        })
    }

    /// Replaces a value by the one given, if any.
    fn apply<T: FromStr>(&self, name: &str, value: &mut T) {
        if let Some(given) = self.get(name) {
            *value = given;
        }
    }

    fn regularization(&self) -> Regularization {
        let mut chosen = self.chosen("regularization").unwrap_or_default();
        match &mut chosen {
            Regularization::LowRank { rank } | Regularization::Cur { rank } => *rank = self.get("rank"),
            Regularization::Rpi { alpha } => self.apply("alpha", alpha),
            Regularization::None => {}
        }
        chosen
    }

    /// Refuses settings that would change nothing.
    fn check(&self, method: &EmbedMethod) -> Result<(), NoEffect> {
        let given = || SCHEMA.iter().filter(|option| self.is_given(option.name));
        if let Some(option) = given().find(|option| !option.applies_to(method)) {
            let methods = EmbedMethod::all();
            let instead = methods.iter().filter(|m| option.applies_to(m)).map(EmbedMethod::name).collect();
            return Err(NoEffect { setting: option.name, beside: "method", value: method.name(), instead });
        }
        if method.regularization().is_none() {
            return Ok(());
        }
        let chosen: Regularization = self.chosen("regularization").unwrap_or_default();
        let has_rank =
            |r: &Regularization| matches!(r, Regularization::LowRank { .. } | Regularization::Cur { .. });
        let has_alpha = |r: &Regularization| matches!(r, Regularization::Rpi { .. });
        let of_regularization: [(_, fn(&_) -> bool); 2] = [("rank", has_rank), ("alpha", has_alpha)];
        let lost = of_regularization.into_iter().find(|(name, has)| self.is_given(name) && !has(&chosen));
        lost.map_or(Ok(()), |(setting, has)| {
            let instead = Regularization::all().into_iter().filter(has).map(Regularization::name).collect();
            Err(NoEffect { setting, beside: "regularization", value: chosen.name(), instead })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Samples;

    /// Names and values of settings.
    type Given<'a> = &'a [(&'a str, &'a str)];

    fn of(given: Given<'_>) -> Settings {
        let mut settings = Settings::default();
        given.iter().for_each(|(name, text)| settings.set(name, text).unwrap());
        settings
    }

    /// A method, further settings and a value that is not the default, for every option of a description.
    const OTHERS: [(&str, &str, Given<'static>); 19] = [
        ("method", "spectral", &[]),
        ("samples", "50", &[]),
        ("dim", "2", &[]),
        ("geodesic", "exact", &[]),
        ("update", "planar", &[]),
        ("obtuse", "ignore", &[]),
        ("components", "bridge", &[]),
        ("weld", "0.5", &[]),
        ("rank", "30", &[]),
        ("sampling", "random", &[]),
        ("first_sample", "7", &[]),
        ("regularization", "cur", &[]),
        ("alpha", "paper", &[("regularization", "rpi")]),
        ("sigma", "median", &[("method", "kpca")]),
        ("eigenvectors", "60", &[("method", "spectral")]),
        ("mu", "inf", &[("method", "spectral")]),
        ("iterations", "5", &[("method", "smacof")]),
        ("tolerance", "0.1", &[("method", "smacof")]),
        ("points", "500", &[]),
    ];

    #[test]
    fn every_option_of_a_description_is_stored_and_its_default_is_stated() {
        let stored = [OptionGroup::Method, OptionGroup::Form, OptionGroup::Marching, OptionGroup::Repair];
        for option in
            SCHEMA.iter().filter(|o| stored.contains(&o.group) || o.group == OptionGroup::Description)
        {
            if option.is_switch() {
                let text = |on: &str| of(&[(option.name, on)]).describe().unwrap().text();
                assert!(text("true") != text("false") && text("false") == DescribeOptions::default().text());
                continue;
            }
            let (name, other, beside) = OTHERS
                .into_iter()
                .find(|(name, ..)| *name == option.name)
                .unwrap_or_else(|| panic!("{}", option.name));
            let without = of(beside);
            let with = |value: &str| without.and(&of(&[(name, value)])).describe().unwrap();
            let usual = without.describe().unwrap();
            let changed = with(other);
            assert_ne!(changed.text(), usual.text(), "{name}");
            assert_eq!(DescribeOptions::from_text(&changed.text()), Some(changed), "{name}");
            if option.check(option.default).is_ok() {
                assert_eq!(with(option.default), usual, "the default of {name}");
            }
        }
    }

    #[test]
    fn settings_reach_the_options_that_they_belong_to() {
        assert_eq!(Settings::default().describe().unwrap(), DescribeOptions::default());
        assert_eq!(of(&[("samples", "auto")]).form().unwrap().samples, Samples::Auto);
        assert_eq!(of(&[("stress", "skip")]).chosen("stress"), Some(crate::StressChoice::Skip));
        let first = of(&[("first_sample", "7")]).form().unwrap();
        assert_eq!(first.first_sample, FirstSample::Vertex(VertexId(7)));
    }

    #[test]
    fn impossible_values_are_refused_with_what_is_possible() {
        for (name, text, words) in [
            ("method", "umap", "use \"nmds\""),
            ("weld", "-1", "distance in mesh units"),
            ("alpha", "ten", "neither a number nor `paper`"),
            ("sigma", "wide", "`mean`"),
            ("samples", "0", "`auto`"),
            ("rank", "1.5", "invalid digit"),
            ("colour", "3", "no option colour"),
        ] {
            let fault = Settings::default().set(name, text).unwrap_err();
            assert!(fault.contains(words), "{name} {text}: {fault}");
        }
    }

    #[test]
    fn settings_without_effect_are_refused_with_what_would_use_them() {
        let cases: [(Given<'_>, [&str; 3]); 4] = [
            (&[("mu", "5")], ["mu", "method", "spectral"]),
            (&[("alpha", "paper")], ["alpha", "regularization", "rpi"]),
            (&[("rank", "5"), ("regularization", "none")], ["rank", "regularization", "low-rank"]),
            (&[("first_sample", "1"), ("method", "mds")], ["first_sample", "method", "nmds"]),
        ];
        for (given, [setting, beside, instead]) in cases {
            let fault = of(given).form().unwrap_err();
            assert_eq!((fault.setting, fault.beside, fault.instead[0]), (setting, beside, instead));
            let words = fault.in_words(|name, values| format!("<{name}={}>", values.join("|")));
            assert!(words.starts_with(&format!("<{setting}=>")), "{words}");
            assert!(words.contains(&format!("or use <{beside}={instead}")), "{words}");
        }
        let heat = Method::named("heat").unwrap();
        let fault = of(&[("obtuse", "flip")]).check_distances("geodesic", heat).unwrap_err();
        assert_eq!((fault.setting, fault.beside, fault.value), ("obtuse", "geodesic", "heat"));
    }

    #[test]
    fn help_states_the_default_and_other_options() {
        let rank = OptionSpec::named("rank").unwrap().help(|name| format!("--{name}"));
        assert!(rank.ends_with("[default: half the samples, at least --dim + 4]"), "{rank}");
    }
}
