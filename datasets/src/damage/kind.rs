//! Kinds of damage with strengths from 1 to 5.

use strum::{IntoStaticStr, VariantArray};

use super::{Damage, WeldPair};

/// A kind of damage, of which [`at`](Self::at) gives five strengths.
///
/// The kinds are those of the SHREC'10 benchmark on robustness, and welds drawn in two ways. The steps are chosen so that
/// strength 3 is damage that scans really have, and 5 is hard.
///
/// | kind | strength 1 | 2 | 3 | 4 | 5 |
/// |---|---|---|---|---|---|
/// | pairs of points welded, near or far in space, or joined by a handle | 1 | 2 | 3 | 4 | 5 |
/// | area of holes | 1 % | 2 % | 3 % | 5 % | 8 % |
/// | area cut off | 2 % | 4 % | 7 % | 11 % | 16 % |
/// | noise, relative to the diagonal | 0.1 % | 0.2 % | 0.3 % | 0.5 % | 0.8 % |
/// | vertices displaced by shot noise | 0.2 % | 0.5 % | 1 % | 2 % | 4 % |
/// | vertices left by decimation | 70 % | 50 % | 35 % | 20 % | 10 % |
/// | vertices after sampling anew | 100 % | 70 % | 50 % | 35 % | 20 % |
/// | scale | 1.25 | 2 | 4 | 10 | 25.4 |
/// | mirror image | the same at every strength | | | | |
///
/// ```
/// use canonform_datasets::DamageKind;
///
/// assert_eq!(DamageKind::Holes.at(3).to_string(), "holes 3 %");
/// assert_eq!(DamageKind::ALL.len(), 11);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "lowercase")]
pub enum DamageKind {
    /// Points that are near in space become one.
    #[strum(serialize = "weld, near points")]
    Weld,
    /// Random points become one.
    #[strum(serialize = "weld, random points")]
    FarWeld,
    /// Points that are near in space are joined by a handle.
    #[strum(serialize = "handle, near points")]
    Contact,
    /// Discs are cut out.
    Holes,
    /// The end of a limb is missing.
    #[strum(serialize = "cut off")]
    CutOff,
    /// All vertices are displaced.
    Noise,
    /// A few vertices are displaced far.
    #[strum(serialize = "shot noise")]
    ShotNoise,
    /// Edges are collapsed.
    Decimation,
    /// New, fewer vertices.
    Sampling,
    /// Another size.
    Scale,
    /// A mirror image.
    Mirror,
}

impl DamageKind {
    /// All kinds.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// Number of strengths.
    pub const STRENGTHS: usize = 5;

    /// Its name, such as `shot noise`.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The damage of a strength from 1 to 5; others count as the nearest of these.
    pub fn at(self, strength: usize) -> Damage {
        let strength = strength.clamp(1, Self::STRENGTHS);
        let of = |steps: [f64; 5]| steps[strength - 1];
        match self {
            Self::Weld => Damage::Weld(WeldPair::Near, strength as u32),
            Self::FarWeld => Damage::Weld(WeldPair::Random, strength as u32),
            Self::Contact => Damage::Contact(strength as u32),
            Self::Holes => Damage::Holes(of([0.01, 0.02, 0.03, 0.05, 0.08])),
            Self::CutOff => Damage::CutOff(of([0.02, 0.04, 0.07, 0.11, 0.16])),
            Self::Noise => Damage::Noise(of([0.001, 0.002, 0.003, 0.005, 0.008])),
            Self::ShotNoise => Damage::ShotNoise(of([0.002, 0.005, 0.01, 0.02, 0.04])),
            Self::Decimation => Damage::Decimate(of([0.7, 0.5, 0.35, 0.2, 0.1])),
            Self::Sampling => Damage::Sample(of([1.0, 0.7, 0.5, 0.35, 0.2])),
            Self::Scale => Damage::Resize(of([1.25, 2.0, 4.0, 10.0, 25.4])),
            Self::Mirror => Damage::Mirror,
        }
    }
}
