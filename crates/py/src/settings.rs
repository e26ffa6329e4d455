//! Keyword arguments as the options of the library.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::time::Duration;

use canonform::DescribeOptions;
use canonform::embed::{FormOptions, StressOptions};
use canonform::geodesics::Method;
use canonform::library::{Measure, ShapeLimits};
use canonform::maps::CorrespondOptions;
use canonform::mesh::RepairOptions;
use canonform::nmds::Regularization;
use canonform::settings::{
    DescriptionSettings, FormSettings, MapSettings, MarchingSettings, MethodSettings, NoEffect,
    RepairSettings, StressSettings,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::de::value::{Error, StrDeserializer};
use serde::de::{DeserializeOwned, IgnoredAny, IntoDeserializer};
use serde::{Deserialize, Serialize};
use serde_json::{Map, json};
use strum::{EnumMessage, VariantArray};

use crate::error::{Exception, spelled};

/// Keyword arguments that were given.
#[derive(Default, Deserialize)]
pub(crate) struct Settings {
    #[serde(flatten)]
    form: FormSettings,
    #[serde(flatten)]
    method: MethodSettings,
    #[serde(flatten)]
    marching: MarchingSettings,
    #[serde(flatten)]
    repair: RepairSettings,
    #[serde(flatten)]
    stress: StressSettings,
    #[serde(flatten)]
    description: DescriptionSettings,
    #[serde(flatten)]
    maps: MapSettings,
    seed: Option<u64>,
    timeout: Option<f64>,
    memory: Option<usize>,
    max_vertices: Option<u64>,
    #[serde(flatten)]
    unknown: BTreeMap<String, IgnoredAny>,
}

/// The value of a keyword argument.
#[derive(Clone, FromPyObject, Serialize)]
#[serde(untagged)]
enum Value {
    Switch(bool),
    Count(u64),
    Whole(i64),
    Number(f64),
    Text(String),
}

/// Checks options of a method, or of distances. Returns all options of a description by them, as JSON.
#[pyfunction]
pub(crate) fn check_options(settings: Settings) -> PyResult<String> {
    Ok(settings.describe(RepairOptions::default())?.text())
}

impl<'py> FromPyObject<'_, 'py> for Settings {
    type Error = PyErr;

    /// Reads keyword arguments; those that are `None` were not given.
    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let mut values = Map::new();
        for (name, value) in given.cast::<PyDict>()?.iter().filter(|(_, value)| !value.is_none()) {
            let name: String = name.extract()?;
            let Ok(given) = value.extract::<Value>() else {
                return Err(refused(&name, value.repr()?, "give a number, text or a truth value"));
            };
            let given = match given {
                // JSON has no such numbers.
                Value::Number(number) if !number.is_finite() => json!(number.to_string()),
                given => json!(given),
            };
            // The error of all of them would not say which one is wrong.
            let alone = Map::from_iter([(name.clone(), given.clone())]);
            Self::deserialize(alone).map_err(|fault| refused(&name, &given, &in_words(&fault)))?;
            values.insert(name, given);
        }
        let settings = Self::deserialize(values).map_err(|fault| Exception::OptionError.with(fault))?;
        match settings.unknown.keys().next() {
            Some(name) => Err(Exception::OptionError.with(format!("there is no option {name}"))),
            None => Ok(settings),
        }
    }
}

/// A value that is chosen by name.
pub(crate) fn chosen<T: DeserializeOwned>(name: &str, text: &str) -> PyResult<T> {
    let value: StrDeserializer<'_, Error> = text.into_deserializer();
    T::deserialize(value).map_err(|fault| refused(name, format!("{text:?}"), &in_words(&fault)))
}

/// What distances are measured between.
pub(crate) fn measure(name: &str, text: &str) -> PyResult<Measure> {
    text.parse().map_err(|known: String| refused(name, format!("{text:?}"), &known.replace('`', "\"")))
}

/// What is possible instead.
fn in_words(fault: &impl Display) -> String {
    let text = fault.to_string().replace('`', "\"");
    let Some((_, possible)) = text.split_once(", expected ") else { return text };
    let possible = match possible.trim_start_matches("one of ") {
        "usize" | "u64" | "u32" => "a whole number, 0 or more",
        "f64" => "a number",
        "string or map" => "text",
        names => names,
    };
    format!("use {possible}")
}

fn refused(name: &str, value: impl Display, what: &str) -> PyErr {
    Exception::OptionError.with(format!("{name}={value} is not possible: {what}"))
}

impl Settings {
    /// How a mesh is repaired.
    pub(crate) fn repair(&self) -> RepairOptions {
        self.repair.options()
    }

    /// How distances are measured.
    pub(crate) fn distances(&self) -> PyResult<Method> {
        Ok(self.form(RepairOptions::default())?.geodesic)
    }

    /// How a form is made of a surface that was repaired in this way.
    pub(crate) fn form(&self, repair: RepairOptions) -> PyResult<FormOptions> {
        let checked = self.form.options(&self.method, &self.marching, &self.repair);
        let options =
            checked.map_err(|fault: NoEffect| Exception::OptionError.with(fault.in_words(spelled)))?;
        Ok(FormOptions { repair, seed: self.seed.unwrap_or_default(), ..options })
    }

    /// How NMDS inverts the matrix of the samples, and in how many dimensions it embeds.
    pub(crate) fn nystrom(&self) -> PyResult<(Regularization, usize)> {
        let FormOptions { method, dim, .. } = self.form(RepairOptions::default())?;
        Ok((method.regularization().unwrap_or_default(), dim))
    }

    /// How shapes are described.
    pub(crate) fn describe(&self, repair: RepairOptions) -> PyResult<DescribeOptions> {
        Ok(self.description.options(self.form(repair)?))
    }

    /// How surfaces are mapped to each other.
    pub(crate) fn correspond(&self, repair: RepairOptions) -> PyResult<CorrespondOptions> {
        Ok(self.maps.options(self.form(repair)?))
    }

    /// How the stress of a form is measured.
    pub(crate) fn stress(&self) -> StressOptions {
        let choice = self.stress.stress.unwrap_or_default();
        StressOptions { choice, against: None, seed: self.seed.unwrap_or_default() }
    }

    /// The limits of each of several shapes.
    pub(crate) fn limits(&self) -> PyResult<ShapeLimits> {
        let time = time_limit(self.timeout)?;
        Ok(ShapeLimits { max_vertices: self.max_vertices, time, memory: self.memory })
    }
}

/// The time that the keyword `timeout` gives.
pub(crate) fn time_limit(seconds: Option<f64>) -> PyResult<Option<Duration>> {
    let limit = |seconds: f64| {
        let limit = Duration::try_from_secs_f64(seconds).ok().filter(|limit| !limit.is_zero());
        limit.ok_or_else(|| refused("timeout", seconds, "give a positive number of seconds"))
    };
    seconds.map(limit).transpose()
}

/// The names of values, and what each of them does.
pub(crate) fn named<T: Copy + VariantArray + EnumMessage + Into<&'static str>>()
-> Vec<(&'static str, &'static str)> {
    T::VARIANTS.iter().map(|value| ((*value).into(), value.get_documentation().unwrap_or_default())).collect()
}
