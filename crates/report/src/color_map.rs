//! Color maps for numbers.

use std::str::FromStr;

use strum::VariantArray;

use crate::color::{Rgb, mix, perceptual};

/// A color map for numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, strum::IntoStaticStr, VariantArray)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[strum(serialize_all = "kebab-case")]
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
    /// Blue, pale gray, red; diverging, for values around the middle of the range
    Coolwarm,
    /// Black to white; for print without color
    Gray,
}

/// Colors of a map at equal steps; between them it is linear.
const STOPS: usize = 33;

#[rustfmt::skip]
const MAGMA: [u32; STOPS] = [
    0x000004, 0x030312, 0x0a0822, 0x130d34, 0x1d1147, 0x29115a, 0x36106b, 0x440f76, 0x51127c,
    0x5d177f, 0x6a1c81, 0x762181, 0x832681, 0x902a81, 0x9c2e7f, 0xaa337d, 0xb73779, 0xc43c75,
    0xd0416f, 0xdc4869, 0xe75263, 0xef5d5e, 0xf56b5c, 0xf9795d, 0xfc8961, 0xfd9869, 0xfea772,
    0xfeb67c, 0xfec488, 0xfed395, 0xfde2a3, 0xfcf0b2, 0xfcfdbf,
];

#[rustfmt::skip]
const INFERNO: [u32; STOPS] = [
    0x000004, 0x040312, 0x0b0724, 0x150b37, 0x210c4a, 0x2f0a5b, 0x3d0965, 0x4a0c6b, 0x57106e,
    0x64156e, 0x71196e, 0x7d1e6d, 0x8a226a, 0x972766, 0xa32c61, 0xb0315b, 0xbc3754, 0xc73e4c,
    0xd24644, 0xdb503b, 0xe45a31, 0xeb6628, 0xf1731d, 0xf68013, 0xf98e09, 0xfb9d07, 0xfcac11,
    0xfbbc21, 0xf9cb35, 0xf5db4c, 0xf2ea69, 0xf3f68a, 0xfcffa4,
];

#[rustfmt::skip]
const CIVIDIS: [u32; STOPS] = [
    0x00224e, 0x00285b, 0x002e6a, 0x053371, 0x1a386f, 0x273e6e, 0x32436d, 0x3b496c, 0x434e6c,
    0x4b546c, 0x535a6d, 0x5a5f6e, 0x61656f, 0x686a71, 0x6f7073, 0x767676, 0x7d7c78, 0x848279,
    0x8c8878, 0x938e78, 0x9b9476, 0xa39a74, 0xaba072, 0xb4a76f, 0xbcae6c, 0xc4b468, 0xcdbb63,
    0xd5c25e, 0xdec958, 0xe7d150, 0xf0d846, 0xf9e03a, 0xfee838,
];

#[rustfmt::skip]
const TURBO: [u32; STOPS] = [
    0x30123b, 0x392a73, 0x4040a2, 0x4456c7, 0x466be3, 0x4680f6, 0x4294ff, 0x37a8fa, 0x28bceb,
    0x1ccdd8, 0x18ddc2, 0x1fe9af, 0x32f298, 0x4ef97d, 0x6dfe62, 0x8bff4b, 0xa4fc3c, 0xb9f635,
    0xcdec34, 0xdfdf37, 0xeecf3a, 0xf8be39, 0xfdac34, 0xfe962b, 0xfb7e21, 0xf46617, 0xeb500e,
    0xdf3f08, 0xd02f05, 0xbe2102, 0xa91601, 0x920b01, 0x7a0403,
];

#[rustfmt::skip]
const COOLWARM: [u32; STOPS] = [
    0x3b4cc0, 0x445acc, 0x4e68d8, 0x5875e1, 0x6282ea, 0x6c8ff1, 0x779af7, 0x82a6fb, 0x8db0fe,
    0x98b9ff, 0xa3c2fe, 0xaec9fc, 0xb9d0f9, 0xc3d5f4, 0xccd9ed, 0xd5dbe5, 0xdddcdc, 0xe5d8d1,
    0xecd3c5, 0xf1ccb8, 0xf5c4ac, 0xf7ba9f, 0xf7b093, 0xf6a586, 0xf4987a, 0xf08b6e, 0xeb7d62,
    0xe46e56, 0xdd5f4b, 0xd44e41, 0xca3b37, 0xbe242e, 0xb40426,
];

impl ColorMap {
    /// The color of a share of the range. Values outside 0..=1 are clamped; NaN is gray.
    pub fn color(self, share: f64) -> Rgb {
        let stops = match self {
            _ if share.is_nan() => return perceptual(share),
            Self::Viridis => return perceptual(share),
            Self::Gray => return [(share.clamp(0.0, 1.0) * 255.0).round() as u8; 3],
            Self::Magma => &MAGMA,
            Self::Inferno => &INFERNO,
            Self::Cividis => &CIVIDIS,
            Self::Turbo => &TURBO,
            Self::Coolwarm => &COOLWARM,
        };
        let at = share.clamp(0.0, 1.0) * (STOPS - 1) as f64;
        let below = (at as usize).min(STOPS - 2);
        let stop = |i: usize| {
            let [_, r, g, b] = stops[i].to_be_bytes();
            [r, g, b]
        };
        mix(stop(below), stop(below + 1), at - below as f64)
    }
}

impl FromStr for ColorMap {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let names: Vec<&str> = Self::VARIANTS.iter().map(|map| map.into()).collect();
        let found = names.iter().position(|known| *known == name).map(|place| Self::VARIANTS[place]);
        found.ok_or_else(|| format!("there is no color map `{name}`; choose from {}", names.join(", ")))
    }
}
