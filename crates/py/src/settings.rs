//! Keyword arguments as the options of the library.

use canonform::descriptors::SignatureKind;
use canonform::geodesics::Method;
use canonform::mesh::RepairOptions;
use canonform::nmds::NystromOptions;
use canonform::settings::{Named, NoEffect, OptionGroup, OptionSpec, SCHEMA};
use canonform::{
    Budget, CorrespondOptions, DescribeOptions, EmbedMethod, FormOptions, ShapeLimits, StressOptions,
};
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

/// An option: its keyword, its default in words, the names that it is chosen from, each with what it does, and the methods that
/// depend on it.
type Described = (&'static str, &'static str, Vec<(&'static str, &'static str)>, Vec<&'static str>);

/// The options that are further options of methods, and all others.
#[pyfunction]
pub(crate) fn options() -> (Vec<Described>, Vec<Described>) {
    let described = |option: &OptionSpec| {
        let methods = EmbedMethod::all().into_iter().filter(|method| option.applies_to(method));
        (option.keyword, option.default, option.names(), methods.map(|method| method.name()).collect())
    };
    let (of_methods, others): (Vec<_>, Vec<_>) =
        SCHEMA.iter().partition(|option| option.group == OptionGroup::Method && option.name != "method");
    let others =
        others.into_iter().map(described).chain(OTHERS.map(|name| (name, "", Vec::new(), Vec::new())));
    (of_methods.into_iter().map(described).collect(), others.collect())
}

/// Checks options of a method, or of distances.
#[pyfunction]
pub(crate) fn check_options(settings: &str) -> PyResult<()> {
    Settings::parse(settings)?.form(RepairOptions::default()).map(drop)
}

impl Settings {
    /// Reads the JSON object that the Python layer passes.
    pub(crate) fn parse(text: &str) -> PyResult<Self> {
        let given: Map<String, Value> =
            serde_json::from_str(text).map_err(|fault| Exception::Option.with(&fault.to_string()))?;
        let (mut options, mut others) = (canonform::settings::Settings::default(), Map::new());
        for (name, value) in given {
            let option = SCHEMA.iter().find(|option| option.keyword == name);
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

    /// How distances are measured.
    pub(crate) fn distances(&self) -> PyResult<Method> {
        Ok(self.form(RepairOptions::default())?.geodesic)
    }

    /// How a form is made of a surface that was repaired in this way.
    pub(crate) fn form(&self, repair: RepairOptions) -> PyResult<FormOptions> {
        Ok(self.describe(repair)?.form)
    }

    /// How NMDS inverts the matrix of the samples.
    pub(crate) fn nystrom(&self) -> PyResult<NystromOptions> {
        let FormOptions { method, dim, .. } = self.form(RepairOptions::default())?;
        Ok(NystromOptions { regularization: method.regularization().unwrap_or_default(), dim })
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
            options.maps.eigenfunctions = count;
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

fn refused(name: &str, value: &Value, what: &str) -> PyErr {
    Exception::Option.with(&format!("{name}={value} is not possible: {what}"))
}

/// The error that a setting would change nothing, as keyword arguments.
fn without_effect(fault: &NoEffect) -> PyErr {
    let spell = |name: &str, values: &[&str]| {
        let values: Vec<_> = values.iter().map(|value| format!("{value:?}")).collect();
        let keyword = OptionSpec::named(name).map_or(name, |option| option.keyword);
        format!("{keyword}={}", values.join(" or "))
    };
    Exception::Option.with(&fault.in_words(spell))
}

/// The names of the kinds of signatures.
#[pyfunction]
pub(crate) fn signature_kinds() -> Vec<&'static str> {
    SignatureKind::ALL.map(SignatureKind::name).to_vec()
}

/// The extensions of the mesh formats that are written.
#[pyfunction]
pub(crate) fn mesh_formats() -> Vec<&'static str> {
    canonform::mesh::io::writable(canonform::mesh::io::Content::Mesh).collect()
}
