//! Keyword arguments as the options of the library.

use canonform::descriptors::{FormDistance, Normalization, SignatureKind};
use canonform::geodesics::{FastMarchingOptions, Method, Sampling};
use canonform::nmds::{Bandwidth, NystromOptions, Regularization, RpiAlpha, SampleGoal};
use canonform::{
    Budget, CorrespondOptions, DescribeOptions, EmbedMethod, EmbedSettings, FormOptions, NoEffect, Samples,
    ShapeLimits, StressChoice, StressOptions,
};
use mesh::{RepairOptions, Weld};
use pyo3::prelude::*;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

use crate::error::Exception;

/// Keyword arguments that were given, as a JSON object. Every value is taken by name; the rest is none of ours.
pub(crate) struct Settings(Map<String, Value>);

impl Settings {
    /// Reads the JSON object that the Python layer passes.
    pub(crate) fn parse(text: &str) -> PyResult<Self> {
        serde_json::from_str(text).map(Self).map_err(|fault| Exception::Option.with(&fault.to_string()))
    }

    /// The value of a setting, as the library stores it.
    fn value<T: DeserializeOwned>(&self, name: &str) -> PyResult<Option<T>> {
        let Some(value) = self.0.get(name) else { return Ok(None) };
        serde_json::from_value(value.clone())
            .map(Some)
            .map_err(|fault| refused(name, value, &fault.to_string()))
    }

    /// One of several values that have names.
    fn choice<T>(&self, name: &str, all: impl IntoIterator<Item = (&'static str, T)>) -> PyResult<Option<T>> {
        self.0.get(name).map(|value| chosen(name, value, all)).transpose()
    }

    /// How a mesh is repaired.
    pub(crate) fn repair(&self) -> PyResult<RepairOptions> {
        let usual = RepairOptions::default();
        let weld = match self.0.get("weld") {
            Some(Value::Number(_)) => {
                let tolerance: f64 = self.value("weld")?.unwrap_or_default();
                if !(tolerance >= 0.0 && tolerance.is_finite()) {
                    let what = "a tolerance is a distance in mesh units, 0 or more";
                    return Err(refused("weld", &json!(tolerance), what));
                }
                Some(Weld::Within(tolerance))
            }
            _ => self.choice("weld", [("seams", Weld::Seams), ("all", Weld::All), ("none", Weld::None)])?,
        };
        Ok(RepairOptions {
            components: self.value("components")?.unwrap_or(usual.components),
            weld: weld.unwrap_or(usual.weld),
            orient: usual.orient,
        })
    }

    /// How distances are measured for a form.
    fn geodesic(&self) -> PyResult<Method> {
        let named = self.0.get("geodesic").map(|value| geodesic("geodesic", value)).transpose()?;
        let marching = FastMarchingOptions {
            update: self.value("update")?.unwrap_or_default(),
            obtuse: self.value("obtuse")?.unwrap_or_default(),
        };
        with_marching(
            named.unwrap_or_default(),
            marching,
            ["update", "obtuse"].map(|name| self.0.contains_key(name)),
        )
    }

    /// How a form is made. The repair is that of the surface, unless these settings have one.
    pub(crate) fn form(&self, repair: RepairOptions) -> PyResult<FormOptions> {
        let samples = match self.0.get("n") {
            None => Samples::default(),
            Some(value) => {
                let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                text.parse().map_err(|fault: String| refused("n", value, &fault))?
            }
        };
        let options = FormOptions {
            repair,
            geodesic: self.geodesic()?,
            samples,
            dim: self.value("dim")?.unwrap_or(3),
            seed: self.value("seed")?.unwrap_or(0),
            ..FormOptions::default()
        };
        let method = self.choice("method", EmbedMethod::all().map(|method| (method.name(), method)))?;
        let sampling = self.choice("sampling", Sampling::ALL.map(|sampling| (sampling.name(), sampling)))?;
        let regularization = Regularization::all().map(|kind| (kind.name(), kind));
        let settings = EmbedSettings {
            method: method.unwrap_or_default(),
            regularization: self.choice("regularization", regularization)?,
            rank: self.value("rank")?,
            alpha: self.number_or("alpha", [("paper", RpiAlpha::Paper)], RpiAlpha::Relative)?,
            sampling,
            target_stress: self.target_stress()?,
            first_sample: self.value("first_sample")?,
            sigma: self.number_or(
                "sigma",
                [("mean", Bandwidth::Mean), ("median", Bandwidth::Median), ("max", Bandwidth::Max)],
                Bandwidth::Value,
            )?,
            eigenvectors: self.value("eigenvectors")?,
            // JSON has no infinity.
            mu: self.number_or("mu", [("inf", f64::INFINITY)], |mu| mu)?,
            iterations: self.value("iterations")?,
            tolerance: self.value("tolerance")?,
        };
        settings.applied_to(options).map_err(|fault| without_effect(&fault))
    }

    /// The normalised stress up to which samples are taken.
    fn target_stress(&self) -> PyResult<Option<f64>> {
        let target: Option<f64> = self.value("target_stress")?;
        match target {
            Some(target) if !(target > 0.0 && target.is_finite()) => {
                Err(refused("target_stress", &json!(target), "give a positive number"))
            }
            target => Ok(target),
        }
    }

    /// How NMDS inverts the matrix of the samples.
    pub(crate) fn nystrom(&self) -> PyResult<NystromOptions> {
        Ok(self.searched_nystrom()?.0)
    }

    /// How NMDS inverts the matrix of the samples, and when there are enough of them.
    pub(crate) fn searched_nystrom(&self) -> PyResult<(NystromOptions, SampleGoal)> {
        let FormOptions { method, dim, samples, .. } = self.form(RepairOptions::default())?;
        let options = NystromOptions { regularization: method.regularization().unwrap_or_default(), dim };
        Ok((options, samples.goal().unwrap_or_default()))
    }

    /// A number, or one of several values that have names.
    fn number_or<T, const N: usize>(
        &self,
        name: &str,
        all: [(&'static str, T); N],
        number: impl Fn(f64) -> T,
    ) -> PyResult<Option<T>> {
        match self.0.get(name) {
            Some(Value::Number(_)) => Ok(self.value(name)?.map(number)),
            _ => self.choice(name, all),
        }
    }

    /// How shapes are described.
    pub(crate) fn describe(&self, repair: RepairOptions) -> PyResult<DescribeOptions> {
        let usual = DescribeOptions::default();
        let size = if self.value("size")?.unwrap_or(false) { Normalization::Raw } else { usual.size };
        Ok(DescribeOptions {
            form: self.form(repair)?,
            points: self.value("points")?.unwrap_or(usual.points),
            size,
        })
    }

    /// How surfaces are mapped to each other.
    pub(crate) fn correspond(&self, repair: RepairOptions) -> PyResult<CorrespondOptions> {
        let mut options = CorrespondOptions { form: self.form(repair)?, ..CorrespondOptions::default() };
        if let Some(count) = self.value("eigenfunctions")? {
            options.matching.eigenfunctions = count;
        }
        Ok(options)
    }

    /// How the stress of a form is measured.
    pub(crate) fn stress(&self) -> PyResult<StressOptions> {
        let choices = [
            ("auto", StressChoice::Auto),
            ("exact", StressChoice::Exact),
            ("estimate", StressChoice::Estimate),
            ("skip", StressChoice::Skip),
        ];
        Ok(StressOptions {
            choice: self.choice("stress", choices)?.unwrap_or_default(),
            against: None,
            seed: self.value("seed")?.unwrap_or(0),
        })
    }

    /// What distance of aligned forms is stated.
    pub(crate) fn distance(&self) -> PyResult<FormDistance> {
        let all = [("nn-rms", FormDistance::NearestNeighborRms), ("hausdorff95", FormDistance::Hausdorff95)];
        Ok(self.choice("distance", all)?.unwrap_or(FormDistance::NearestNeighborRms))
    }

    /// The limits of the work, from now on.
    pub(crate) fn budget(&self) -> PyResult<Budget> {
        let ShapeLimits { time, memory, .. } = self.limits()?;
        let budget = time.map_or_else(Budget::unlimited, |limit| Budget::unlimited().with_time(limit));
        Ok(memory.map_or(budget.clone(), |bytes| budget.with_memory(bytes)))
    }

    /// The limits of each of several shapes.
    pub(crate) fn limits(&self) -> PyResult<ShapeLimits> {
        let seconds: Option<f64> = self.value("timeout")?;
        let limit = |seconds: f64| {
            let limit = std::time::Duration::try_from_secs_f64(seconds).ok().filter(|limit| !limit.is_zero());
            limit.ok_or_else(|| refused("timeout", &json!(seconds), "give a positive number of seconds"))
        };
        let (max_vertices, memory) = (self.value("max_vertices")?, self.value("memory")?);
        Ok(ShapeLimits { max_vertices, time: seconds.map(limit).transpose()?, memory })
    }
}

/// A distance method by name, with options of fast marching.
pub(crate) fn distance_method(name: &str, update: Option<&str>, obtuse: Option<&str>) -> PyResult<Method> {
    let parsed = |name, value: Option<&str>| value.map(|value| parse(name, value)).transpose();
    let marching = FastMarchingOptions {
        update: update.map(|value| parse("update", value)).transpose()?.unwrap_or_default(),
        obtuse: parsed("obtuse", obtuse)?.unwrap_or_default(),
    };
    with_marching(geodesic("method", &name.into())?, marching, [update.is_some(), obtuse.is_some()])
}

fn parse<T: DeserializeOwned>(name: &str, value: &str) -> PyResult<T> {
    serde_json::from_value(value.into()).map_err(|fault| refused(name, &value.into(), &fault.to_string()))
}

fn geodesic(name: &str, value: &Value) -> PyResult<Method> {
    chosen(name, value, Method::all().map(|method| (method.name(), method)))
}

/// The method with these options, which must not be given for any other than fast marching.
fn with_marching(method: Method, options: FastMarchingOptions, given: [bool; 2]) -> PyResult<Method> {
    match (method, given) {
        (Method::FastMarching(_), _) => Ok(Method::FastMarching(options)),
        (other, [false, false]) => Ok(other),
        (other, [update, _]) => {
            let setting = if update { "update" } else { "obtuse" };
            let instead = vec![Method::default().name()];
            Err(without_effect(&NoEffect { setting, beside: "method", value: other.name(), instead }))
        }
    }
}

fn chosen<T>(name: &str, value: &Value, all: impl IntoIterator<Item = (&'static str, T)>) -> PyResult<T> {
    let mut names = Vec::new();
    for (known, found) in all {
        if value.as_str() == Some(known) {
            return Ok(found);
        }
        names.push(format!("{known:?}"));
    }
    Err(refused(name, value, &format!("use {}", names.join(", "))))
}

fn refused(name: &str, value: &Value, what: &str) -> PyErr {
    Exception::Option.with(&format!("{name}={value} is not possible: {what}"))
}

/// The error that a setting would change nothing, as keyword arguments.
fn without_effect(fault: &NoEffect) -> PyErr {
    let spell = |name: &str, values: &[&str]| {
        let values: Vec<_> = values.iter().map(|value| format!("{value:?}")).collect();
        // The library calls the argument n by what it is.
        let name = if name == "samples" { "n" } else { name };
        format!("{name}={}", values.join(" or "))
    };
    Exception::Option.with(&fault.in_words(spell))
}

/// The names of all methods, each with what it computes: of distances and of embeddings.
#[pyfunction]
pub(crate) fn methods() -> [Vec<(&'static str, &'static str)>; 2] {
    [
        Method::all().map(|method| (method.name(), method.summary())).to_vec(),
        EmbedMethod::all().iter().map(|method| (method.name(), method.summary())).collect(),
    ]
}

/// The names of the kinds of signatures.
#[pyfunction]
pub(crate) fn signature_kinds() -> Vec<&'static str> {
    SignatureKind::ALL.map(SignatureKind::name).to_vec()
}
