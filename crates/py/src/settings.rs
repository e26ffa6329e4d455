//! Keyword arguments as the options of the library.

use canonform::descriptors::SignatureKind;
use canonform::geodesics::Method;
use canonform::mesh::RepairOptions;
use canonform::nmds::{NystromOptions, SampleGoal};
use canonform::settings::{Named, NoEffect, OptionGroup, OptionSpec, SCHEMA};
use canonform::{Budget, CorrespondOptions, DescribeOptions, FormOptions, ShapeLimits, StressOptions};
use pyo3::prelude::*;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

use crate::error::Exception;

/// Keyword arguments that were given.
pub(crate) struct Settings {
    /// Those of the schema of options.
    options: canonform::settings::Settings,
    /// Seed and limits.
    others: Map<String, Value>,
}

/// Keywords of calls besides the schema of options.
const OTHERS: [&str; 4] = ["seed", "timeout", "memory", "max_vertices"];

/// The keyword of an option.
fn keyword(option: &str) -> &str {
    if option == "samples" { "n" } else { option }
}

/// The keywords that are options, and those of them that are further options of forms.
#[pyfunction]
pub(crate) fn option_names() -> (Vec<&'static str>, Vec<&'static str>) {
    let all = SCHEMA.iter().map(|option| keyword(option.name)).chain(OTHERS);
    let groups = [OptionGroup::Method, OptionGroup::Form, OptionGroup::Marching];
    let of_form = SCHEMA.iter().filter(|option| groups.contains(&option.group)).map(|option| option.name);
    // They have keywords of their own wherever forms are made.
    let further = of_form.filter(|name| !["samples", "method", "geodesic"].contains(name));
    (all.collect(), further.collect())
}

impl Settings {
    /// Reads the JSON object that the Python layer passes.
    pub(crate) fn parse(text: &str) -> PyResult<Self> {
        let given: Map<String, Value> =
            serde_json::from_str(text).map_err(|fault| Exception::Option.with(&fault.to_string()))?;
        let (mut options, mut others) = (canonform::settings::Settings::default(), Map::new());
        for (name, value) in given {
            let option = SCHEMA.iter().find(|option| keyword(option.name) == name);
            let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            match option.map(|option| options.set(option.name, &text)) {
                Some(set) => set.map_err(|fault| refused(&name, &value, &fault))?,
                None => drop(others.insert(name, value)),
            }
        }
        Ok(Self { options, others })
    }

    /// A seed or a limit.
    fn value<T: DeserializeOwned>(&self, name: &str) -> PyResult<Option<T>> {
        let Some(value) = self.others.get(name) else { return Ok(None) };
        serde_json::from_value(value.clone())
            .map(Some)
            .map_err(|fault| refused(name, value, &fault.to_string()))
    }

    fn seed(&self) -> PyResult<u64> {
        Ok(self.value("seed")?.unwrap_or(0))
    }

    /// How a mesh is repaired.
    pub(crate) fn repair(&self) -> RepairOptions {
        self.options.repair()
    }

    /// How a form is made of a surface that was repaired in this way.
    pub(crate) fn form(&self, repair: RepairOptions) -> PyResult<FormOptions> {
        Ok(self.describe(repair)?.form)
    }

    /// How NMDS inverts the matrix of the samples, and when there are enough of them.
    pub(crate) fn nystrom(&self) -> PyResult<(NystromOptions, SampleGoal)> {
        let FormOptions { method, dim, samples, .. } = self.form(RepairOptions::default())?;
        let options = NystromOptions { regularization: method.regularization().unwrap_or_default(), dim };
        Ok((options, samples.goal().unwrap_or_default()))
    }

    /// How shapes are described.
    pub(crate) fn describe(&self, repair: RepairOptions) -> PyResult<DescribeOptions> {
        let checked = || {
            let options = self.options.describe()?;
            self.options.check_distances("geodesic", options.form.geodesic)?;
            Ok(options)
        };
        let mut options = checked().map_err(|fault| without_effect(&fault))?;
        (options.form.repair, options.form.seed) = (repair, self.seed()?);
        Ok(options)
    }

    /// How surfaces are mapped to each other.
    pub(crate) fn correspond(&self, repair: RepairOptions) -> PyResult<CorrespondOptions> {
        let mut options = CorrespondOptions { form: self.form(repair)?, ..CorrespondOptions::default() };
        if let Some(count) = self.options.get("eigenfunctions") {
            options.mapping.eigenfunctions = count;
        }
        Ok(options)
    }

    /// How the stress of a form is measured.
    pub(crate) fn stress(&self) -> PyResult<StressOptions> {
        Ok(StressOptions { choice: self.chosen("stress"), against: None, seed: self.seed()? })
    }

    /// The value chosen for an option, or its default.
    pub(crate) fn chosen<T: Named + Default>(&self, name: &str) -> T {
        self.options.chosen(name).unwrap_or_default()
    }

    /// The limits of the work, from now on.
    pub(crate) fn budget(&self) -> PyResult<Budget> {
        Ok(self.limits()?.budget(Budget::unlimited()))
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
    let mut settings = canonform::settings::Settings::default();
    for (option, value) in [("update", update), ("obtuse", obtuse)] {
        let set = value.map_or(Ok(()), |value| settings.set(option, value));
        set.map_err(|fault| refused(option, &value.into(), &fault))?;
    }
    let checked = OptionSpec::named("geodesic").map_or(Ok(()), |option| option.check(name));
    checked.map_err(|fault| refused("method", &name.into(), &fault))?;
    let method = Method::named(name).unwrap_or_default();
    settings.check_distances("method", method).map_err(|fault| without_effect(&fault))?;
    Ok(settings.distances(method))
}

fn refused(name: &str, value: &Value, what: &str) -> PyErr {
    Exception::Option.with(&format!("{name}={value} is not possible: {what}"))
}

/// The error that a setting would change nothing, as keyword arguments.
fn without_effect(fault: &NoEffect) -> PyErr {
    let spell = |name: &str, values: &[&str]| {
        let values: Vec<_> = values.iter().map(|value| format!("{value:?}")).collect();
        format!("{}={}", keyword(name), values.join(" or "))
    };
    Exception::Option.with(&fault.in_words(spell))
}

/// The names of all methods, each with what it computes: of distances and of embeddings.
#[pyfunction]
pub(crate) fn methods() -> [Vec<(&'static str, &'static str)>; 2] {
    ["geodesic", "method"].map(|name| OptionSpec::named(name).map_or_else(Vec::new, OptionSpec::names))
}

/// The names of the kinds of signatures.
#[pyfunction]
pub(crate) fn signature_kinds() -> Vec<&'static str> {
    SignatureKind::ALL.map(SignatureKind::name).to_vec()
}
