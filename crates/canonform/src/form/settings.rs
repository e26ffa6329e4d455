//! Settings of a form as users give them, one by one.

use geodesics::{FirstSample, Sampling};
use nmds::{Bandwidth, Regularization, RpiAlpha};
use surface::VertexId;

use super::distances::Samples;
use super::method::EmbedMethod;
use super::options::FormOptions;

/// Settings of an embedding as users give them: flags of a program or keyword arguments. `None` stands for a setting that
/// was not given.
///
/// ```
/// use canonform::{EmbedMethod, EmbedSettings, FormOptions};
///
/// let settings = EmbedSettings { rank: Some(30), ..EmbedSettings::default() };
/// assert_eq!(settings.applied_to(FormOptions::default())?.method, EmbedMethod::low_rank(30));
///
/// let landmark = EmbedSettings { method: EmbedMethod::Landmark, ..settings };
/// let fault = landmark.applied_to(FormOptions::default()).unwrap_err();
/// assert_eq!(fault.to_string(), "rank has no effect with method landmark; leave it out, or use method nmds or kpca or smacof");
/// # Ok::<(), canonform::NoEffect>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EmbedSettings {
    /// The method, with default options; the other settings change them.
    pub method: EmbedMethod,
    /// How the inverse of the sample matrix is regularised, with default options.
    pub regularization: Option<Regularization>,
    /// Number of eigenpairs of the sample matrix to keep (of columns for CUR).
    pub rank: Option<usize>,
    /// How strongly [`Regularization::Rpi`] damps small eigenvalues.
    pub alpha: Option<RpiAlpha>,
    /// How samples are taken.
    pub sampling: Option<Sampling>,
    /// The normalised stress up to which samples are taken; needs [`Samples::Auto`].
    pub target_stress: Option<f64>,
    /// The first sample, a vertex of the input.
    pub first_sample: Option<u32>,
    /// Width of the kernel of [`EmbedMethod::KernelPca`].
    pub sigma: Option<Bandwidth>,
    /// Number of eigenfunctions of [`EmbedMethod::Spectral`].
    pub eigenvectors: Option<usize>,
    /// Weight of the distances of [`EmbedMethod::Spectral`].
    pub mu: Option<f64>,
    /// Most steps of [`EmbedMethod::Smacof`].
    pub iterations: Option<usize>,
    /// The share of the stress below which a step of [`EmbedMethod::Smacof`] is the last.
    pub tolerance: Option<f64>,
}

/// A setting that would change nothing beside another one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NoEffect {
    /// Name of the setting: of the field of [`EmbedSettings`].
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

impl EmbedSettings {
    /// The options with these settings.
    ///
    /// # Errors
    /// [`NoEffect`] if a setting was given that would change nothing.
    pub fn applied_to(&self, options: FormOptions) -> Result<FormOptions, NoEffect> {
        self.check()?;
        let samples = self.samples(options.samples)?;
        let mut method = self.method.clone();
        match &mut method {
            EmbedMethod::Nystrom { regularization } => *regularization = self.regularization(),
            EmbedMethod::Spectral { eigenvectors, mu } => {
                set(eigenvectors, self.eigenvectors);
                set(mu, self.mu);
            }
            EmbedMethod::KernelPca { rank, bandwidth } => {
                *rank = self.rank;
                set(bandwidth, self.sigma);
            }
            EmbedMethod::Smacof { regularization, descent } => {
                *regularization = self.regularization();
                set(&mut descent.max_iterations, self.iterations);
                set(&mut descent.tolerance, self.tolerance);
            }
            EmbedMethod::Classical | EmbedMethod::Landmark | EmbedMethod::Fmds => {}
        }
        let first_sample =
            self.first_sample.map_or(FirstSample::Farthest, |v| FirstSample::Vertex(VertexId(v)));
        let sampling = self.sampling.unwrap_or_default();
        Ok(FormOptions { method, samples, sampling, first_sample, ..options })
    }

    /// The number of samples with the target, if there is one.
    fn samples(&self, samples: Samples) -> Result<Samples, NoEffect> {
        match (self.target_stress, samples) {
            (None, samples) => Ok(samples),
            (target_stress, Samples::Auto { .. }) => Ok(Samples::Auto { target_stress }),
            (Some(_), Samples::Count(_)) => Err(NoEffect {
                setting: "target_stress",
                beside: "samples",
                value: "N",
                instead: vec!["auto"],
            }),
        }
    }

    fn regularization(&self) -> Regularization {
        let mut chosen = self.regularization.unwrap_or_default();
        match &mut chosen {
            Regularization::LowRank { rank } | Regularization::Cur { rank } => *rank = self.rank,
            Regularization::Rpi { alpha } => set(alpha, self.alpha),
            Regularization::None => {}
        }
        chosen
    }

    /// Refuses settings that would change nothing.
    fn check(&self) -> Result<(), NoEffect> {
        type AppliesTo = fn(&EmbedMethod) -> bool;
        let is_regularized: AppliesTo = |m| m.regularization().is_some();
        let of_method: [(&str, bool, AppliesTo); 11] = [
            ("rank", self.rank.is_some(), |m| {
                m.regularization().is_some() || matches!(m, EmbedMethod::KernelPca { .. })
            }),
            ("sampling", self.sampling.is_some(), EmbedMethod::is_sampled),
            ("first_sample", self.first_sample.is_some(), EmbedMethod::is_sampled),
            ("target_stress", self.target_stress.is_some(), |m| {
                m.is_sampled() && m.has_unit() && !matches!(m, EmbedMethod::Smacof { .. })
            }),
            ("regularization", self.regularization.is_some(), is_regularized),
            ("alpha", self.alpha.is_some(), is_regularized),
            ("eigenvectors", self.eigenvectors.is_some(), |m| matches!(m, EmbedMethod::Spectral { .. })),
            ("mu", self.mu.is_some(), |m| matches!(m, EmbedMethod::Spectral { .. })),
            ("sigma", self.sigma.is_some(), |m| matches!(m, EmbedMethod::KernelPca { .. })),
            ("iterations", self.iterations.is_some(), |m| matches!(m, EmbedMethod::Smacof { .. })),
            ("tolerance", self.tolerance.is_some(), |m| matches!(m, EmbedMethod::Smacof { .. })),
        ];
        let methods = EmbedMethod::all();
        for (setting, is_given, applies) in of_method {
            if is_given && !applies(&self.method) {
                let instead = methods.iter().filter(|m| applies(m)).map(EmbedMethod::name).collect();
                return Err(NoEffect { setting, beside: "method", value: self.method.name(), instead });
            }
        }
        if is_regularized(&self.method) {
            let chosen = self.regularization.unwrap_or_default();
            type Takes = fn(&Regularization) -> bool;
            let of_regularization: [(&str, bool, Takes); 2] = [
                ("rank", self.rank.is_some(), |r| {
                    matches!(r, Regularization::LowRank { .. } | Regularization::Cur { .. })
                }),
                ("alpha", self.alpha.is_some(), |r| matches!(r, Regularization::Rpi { .. })),
            ];
            for (setting, is_given, takes) in of_regularization {
                if is_given && !takes(&chosen) {
                    let all = Regularization::all().into_iter().filter(takes);
                    let instead = all.map(Regularization::name).collect();
                    return Err(NoEffect {
                        setting,
                        beside: "regularization",
                        value: chosen.name(),
                        instead,
                    });
                }
            }
        }
        Ok(())
    }
}

/// Replaces an option by the value given, if any.
fn set<T: Copy>(option: &mut T, given: Option<T>) {
    *option = given.unwrap_or(*option);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_reach_the_options_that_they_belong_to() {
        let of = |settings: EmbedSettings| settings.applied_to(FormOptions::default()).unwrap();
        assert_eq!(of(EmbedSettings::default()), FormOptions::default());
        let rpi = EmbedSettings {
            regularization: Some(Regularization::Rpi { alpha: RpiAlpha::default() }),
            alpha: Some(RpiAlpha::Paper),
            ..EmbedSettings::default()
        };
        let expected =
            EmbedMethod::Nystrom { regularization: Regularization::Rpi { alpha: RpiAlpha::Paper } };
        assert_eq!(of(rpi).method, expected);
        let target = EmbedSettings { target_stress: Some(0.1), ..EmbedSettings::default() };
        let auto = FormOptions { samples: Samples::AUTO, ..FormOptions::default() };
        let reached = target.applied_to(auto.clone()).unwrap();
        assert_eq!(reached.samples, Samples::Auto { target_stress: Some(0.1) });
        assert_eq!(of(EmbedSettings::default()).samples, Samples::default());
        let fault = target.applied_to(FormOptions::default()).unwrap_err();
        assert_eq!(
            (fault.setting, fault.beside, &fault.instead[..]),
            ("target_stress", "samples", &["auto"][..])
        );
        let of_all = EmbedSettings { method: EmbedMethod::Classical, ..target };
        assert_eq!(of_all.applied_to(auto).unwrap_err().beside, "method");
        let first = EmbedSettings { first_sample: Some(7), ..EmbedSettings::default() };
        assert_eq!(of(first).first_sample, FirstSample::Vertex(VertexId(7)));
    }

    #[test]
    fn settings_without_effect_are_refused_with_what_would_use_them() {
        let all = Regularization::all();
        for (settings, setting, beside, instead) in [
            (EmbedSettings { mu: Some(5.0), ..EmbedSettings::default() }, "mu", "method", "spectral"),
            (
                EmbedSettings { alpha: Some(RpiAlpha::Paper), ..EmbedSettings::default() },
                "alpha",
                "regularization",
                "rpi",
            ),
            (
                EmbedSettings { rank: Some(5), regularization: Some(all[2]), ..EmbedSettings::default() },
                "rank",
                "regularization",
                "low-rank",
            ),
            (
                EmbedSettings {
                    first_sample: Some(1),
                    method: EmbedMethod::Classical,
                    ..EmbedSettings::default()
                },
                "first_sample",
                "method",
                "nmds",
            ),
        ] {
            let fault = settings.applied_to(FormOptions::default()).unwrap_err();
            assert_eq!((fault.setting, fault.beside, fault.instead[0]), (setting, beside, instead));
            let words = fault.in_words(|name, values| format!("<{name}={}>", values.join("|")));
            assert!(words.starts_with(&format!("<{setting}=>")), "{words}");
            assert!(words.contains(&format!("or use <{beside}={instead}")), "{words}");
        }
    }
}
