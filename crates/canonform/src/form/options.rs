//! The options tree: everything that decides what a mesh is turned into.

use descriptors::{DescriptorError, Normalization, ShapeMetric};
use geodesics::{FirstSample, Method, Sampling};
use mesh::RepairOptions;
use serde::{Deserialize, Serialize};

use super::as_text;
use super::distances::Samples;
use super::method::EmbedMethod;
use crate::error::{Error, Remedy};

/// Everything that decides the form of a mesh. It is stored with whatever is made of the form, as JSON without
/// the options that have their default value, so that forms made in different ways are never compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct FormOptions {
    /// How the mesh is repaired. Default: keep the largest component, close cracks.
    pub repair: RepairOptions,
    /// How distances are measured. Default: fast marching with virtual sources.
    #[serde(skip_serializing_if = "is_default")]
    pub geodesic: Method,
    /// Number of samples. Default: 100, as in the paper's Figure 4.
    #[serde(with = "as_text")]
    pub samples: Samples,
    /// How samples are taken. Default: farthest point sampling, as in the paper.
    #[serde(skip_serializing_if = "is_default")]
    pub sampling: Sampling,
    /// The first sample, a vertex of the input. By default, farthest point sampling takes the vertex farthest
    /// from vertex 0; the other samplings draw one.
    #[serde(skip_serializing_if = "is_default")]
    pub first_sample: FirstSample,
    /// How distances become coordinates. Default: NMDS.
    #[serde(skip_serializing_if = "is_default")]
    pub method: EmbedMethod,
    /// Dimensions of the embedding. Default: 3, the only one that makes a form.
    #[serde(skip_serializing_if = "is_three")]
    pub dim: usize,
    /// Seed of the samples, where they are drawn, and of the rows that tell how many are enough. Default: 0.
    #[serde(skip_serializing_if = "is_default")]
    pub seed: u64,
}

impl Default for FormOptions {
    fn default() -> Self {
        Self {
            repair: RepairOptions::default(),
            geodesic: Method::default(),
            samples: Samples::default(),
            sampling: Sampling::default(),
            first_sample: FirstSample::default(),
            method: EmbedMethod::default(),
            dim: 3,
            seed: 0,
        }
    }
}

impl FormOptions {
    /// The same options without a seed that decides nothing.
    #[must_use]
    pub fn normalized(mut self) -> Self {
        if self.sampling == Sampling::Farthest && matches!(self.samples, Samples::Count(_)) {
            self.seed = 0;
        }
        self
    }

    /// Refuses to search for the number of samples by a method whose coordinates are no lengths.
    pub(super) fn check_samples(&self) -> Result<(), Error> {
        if self.method.has_unit() || self.samples != Samples::Auto {
            return Ok(());
        }
        let what = format!(
            "how many samples {} needs cannot be measured, since its coordinates are no lengths",
            self.method.name()
        );
        Err(Error::Refused { what, remedy: Some(Remedy::GiveSamples) })
    }

    /// Refuses options that make embeddings but no forms.
    ///
    /// # Errors
    /// [`DescriptorError::NotThreeDimensional`].
    pub fn validate(&self) -> Result<(), Error> {
        match self.dim {
            3 => Ok(()),
            dim => Err(DescriptorError::NotThreeDimensional { dim }.into()),
        }
    }
}

/// Everything that decides the description of a mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct DescribeOptions {
    /// How the form is made, from at least 8 samples.
    #[serde(flatten)]
    pub form: FormOptions,
    /// Number of points of the form to keep, at least 4. Default: 1000.
    pub points: usize,
    /// Whether size counts. Default: [`Normalization::UnitArea`], it does not.
    pub size: Normalization,
}

impl Default for DescribeOptions {
    fn default() -> Self {
        Self { form: FormOptions::default(), points: 1000, size: Normalization::UnitArea }
    }
}

/// [`DescribeOptions`] as they are stored.
#[derive(Serialize, Deserialize)]
struct Provenance {
    description: u32,
    #[serde(flatten)]
    options: DescribeOptions,
}

impl DescribeOptions {
    /// # Errors
    /// [`DescriptorError::NotThreeDimensional`]; [`Error::Refused`] names an option that is too small.
    pub fn validate(&self) -> Result<(), Error> {
        self.form.validate()?;
        let samples = self.form.samples.count_or(usize::MAX);
        for (option, value, least) in [("samples", samples, 8), ("points", self.points, 4)] {
            if value < least {
                let what = format!("a description needs at least {least} {option}, got {value}");
                return Err(Error::refused(what));
            }
        }
        Ok(())
    }

    /// The options and the [version](ShapeMetric::VERSION) of the description as one line of JSON, equal for equal
    /// options. An index stores it.
    pub fn text(&self) -> String {
        let options = Self { form: self.form.clone().normalized(), ..*self };
        let provenance = Provenance { description: ShapeMetric::VERSION, options };
        serde_json::to_string(&provenance).unwrap_or_else(|fault| unreachable!("plain data: {fault}"))
    }

    /// Reads what [`text`](Self::text) wrote; `None` if this version does not know all of it.
    pub fn from_text(text: &str) -> Option<Self> {
        let Provenance { options, .. } = serde_json::from_str(text).ok()?;
        Some(options).filter(|options: &Self| options.text() == text)
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_three(dim: &usize) -> bool {
    *dim == 3
}

#[cfg(test)]
mod tests {
    use geodesics::HeatOptions;
    use nmds::Bandwidth;
    use serde_json::json;

    use super::*;

    #[test]
    fn default_options_have_a_fixed_text() {
        let text = r#"{"description":6,"repair":{"components":"largest","weld":"seams","orient":"keep"},"samples":100,"points":1000,"size":"unit-area"}"#;
        assert_eq!(DescribeOptions::default().text(), text);
        assert_eq!(DescribeOptions::from_text(text), Some(DescribeOptions::default()));
        for other in [
            text.replace("\"description\":6", "\"description\":5"),
            text.replace("\"points\"", "\"color\":3,\"points\""),
            text.replace("seams", "glue"),
            text.replace('}', ""),
            String::new(),
        ] {
            assert_eq!(DescribeOptions::from_text(&other), None, "{other}");
        }
    }

    #[test]
    fn options_are_stored_and_read_back() {
        let usual = FormOptions::default();
        let wide = Bandwidth::Value(0.7);
        let kernel = EmbedMethod::KernelPca { rank: Some(9), bandwidth: wide };
        let methods = EmbedMethod::all().into_iter().chain([kernel]);
        let heat = Method::Heat(HeatOptions { time: 0.3 });
        let others = [
            FormOptions { geodesic: heat, ..usual.clone() },
            FormOptions { samples: Samples::Auto, seed: 5, ..usual.clone() },
            FormOptions { sampling: Sampling::MinVariance, seed: 3, ..usual.clone() },
        ];
        let mut texts = Vec::new();
        for form in methods.map(|method| FormOptions { method, ..usual.clone() }).chain(others) {
            let options = DescribeOptions { form, ..DescribeOptions::default() };
            let text = options.text();
            let read = DescribeOptions::from_text(&text).unwrap();
            assert_eq!(read.text(), text);
            // Sampling from the farthest needs no seed.
            assert!(read == options || options.form.samples == Samples::Auto, "{text}");
            texts.push(text);
        }
        let n = texts.len();
        texts.sort();
        texts.dedup();
        assert_eq!(texts.len(), n);
    }

    #[test]
    fn samples_are_stored_as_numbers_or_words() {
        let read = |value| {
            serde_json::from_value(json!({ "samples": value })).ok().map(|form: FormOptions| form.samples)
        };
        for (samples, value) in [(Samples::Count(20), json!(20)), (Samples::Auto, json!("auto"))] {
            let options = FormOptions { samples, ..FormOptions::default() };
            assert_eq!(serde_json::to_value(&options).unwrap()["samples"], value);
            assert_eq!(read(value), Some(samples));
        }
        assert_eq!(read(json!("20")), Some(Samples::Count(20)), "a number as text");
        for value in
            [json!(0), json!(-3), json!("many"), json!({}), json!({"target-stress": 0.02}), json!(null)]
        {
            assert_eq!(read(value.clone()), None, "{value}");
        }
    }

    #[test]
    fn options_that_make_no_form_are_refused() {
        for (given, words) in [
            (json!({"dim": 2}), "has 3 dimensions, the embedding has 2"),
            (json!({"samples": 7}), "at least 8 samples, got 7"),
            (json!({"points": 3}), "at least 4 points, got 3"),
        ] {
            let options: DescribeOptions = serde_json::from_value(given).unwrap();
            let fault = options.validate().unwrap_err().to_string();
            assert!(fault.contains(words), "{fault}");
        }
    }
}
