//! Color maps for numbers.

use crate::color::{Rgb, perceptual};

/// A color map for numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize, strum::VariantArray)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum ColorMap {
    /// Violet, green, yellow; equal steps look equal, also to color-blind readers
    #[default]
    Viridis,
    /// Black, violet, orange, pale yellow; equal steps look equal
    Magma,
    /// Black, red, orange, pale yellow; equal steps look equal
    Inferno,
    /// Blue, gray, yellow; looks the same to most color-blind readers
    Cividis,
    /// A smooth rainbow; shows detail, but its steps look unequal
    Turbo,
    /// Blue, white, red; diverging, for values around the middle of the range
    Coolwarm,
    /// Black to white; for print without color
    Gray,
}

impl ColorMap {
    /// The color of a share of the range. Values outside 0..=1 are clamped; NaN is gray.
    pub fn color(self, share: f64) -> Rgb {
        let at = share.clamp(0.0, 1.0);
        let gradient = match self {
            _ if share.is_nan() => return perceptual(share),
            Self::Viridis => return perceptual(share),
            Self::Gray => return [(at * 255.0).round() as u8; 3],
            Self::Magma => colorous::MAGMA,
            Self::Inferno => colorous::INFERNO,
            Self::Cividis => colorous::CIVIDIS,
            Self::Turbo => colorous::TURBO,
            Self::Coolwarm => return colorous::RED_BLUE.eval_continuous(1.0 - at).into_array(),
        };
        gradient.eval_continuous(at).into_array()
    }
}
