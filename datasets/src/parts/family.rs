//! The families of parts, their parameters and the values that these take.

use strum::{IntoStaticStr, VariantArray};

/// A kind of mechanical part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum PartFamily {
    /// Two plates at a right angle with holes in a row through each.
    Bracket,
    /// A rectangle with rounded corners and holes along its long sides.
    Plate,
    /// A spur gear with straight flanks and a bore.
    Gear,
    /// A screw with a hexagonal head and a helical thread, right-handed or left-handed.
    HexScrew,
    /// A box without a lid, with holes in its floor.
    Enclosure,
    /// A pipe with a bend between two straight ends.
    BentPipe,
    /// Three cylinders in a row.
    Shaft,
    /// A block with six rectangular sides.
    Block,
}

/// A parameter: its name, its letter in the names of parts, and the values of [`mechanical_parts`](super::mechanical_parts).
pub(super) type Parameter = (&'static str, &'static str, &'static [f64]);

const SIZES: &[f64] = &[4.0, 5.0, 6.0];
const LENGTHS: &[f64] = &[40.0, 42.0];
const SHEETS: &[f64] = &[3.0, 3.5];

impl PartFamily {
    /// All families.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// Its name, such as `bent-pipe`.
    pub fn name(self) -> &'static str {
        self.into()
    }

    pub(super) fn parameters(self) -> &'static [Parameter] {
        match self {
            Self::Bracket => &[
                ("length", "l", LENGTHS),
                ("height", "h", &[30.0, 40.0]),
                ("width", "w", &[20.0, 21.0]),
                ("thickness", "t", SHEETS),
                ("hole diameter", "d", &[4.0, 5.0]),
                ("holes per leg", "n", &[1.0, 2.0]),
            ],
            Self::Plate => &[
                ("length", "l", LENGTHS),
                ("width", "w", &[25.0, 26.0]),
                ("thickness", "t", SHEETS),
                ("corner radius", "r", &[2.0, 3.0]),
                ("hole diameter", "d", &[4.0, 5.0]),
                ("holes", "n", &[4.0, 6.0]),
            ],
            Self::Gear => &[
                ("teeth", "z", &[18.0, 19.0, 20.0]),
                ("module", "m", &[1.0, 1.25]),
                ("thickness", "t", &[5.0, 5.5]),
                ("bore diameter", "d", &[4.0, 5.0]),
            ],
            Self::HexScrew => &[
                ("size", "m", SIZES),
                ("length", "l", &[16.0, 18.0, 20.0]),
                ("thread hand", "h", &[1.0, -1.0]),
            ],
            Self::Enclosure => &[
                ("length", "l", &[60.0, 62.0]),
                ("width", "w", LENGTHS),
                ("height", "h", &[20.0, 22.0]),
                ("wall", "t", &[1.5, 2.0]),
                ("floor holes", "n", &[2.0, 4.0]),
            ],
            Self::BentPipe => &[
                ("outer diameter", "d", &[20.0, 21.0]),
                ("wall", "t", &[1.5, 2.0]),
                ("bend radius", "r", &[30.0, 32.0]),
                ("bend angle in degrees", "a", &[45.0, 60.0, 90.0]),
                ("straight length", "l", &[15.0, 16.0]),
            ],
            Self::Shaft => &[
                ("first diameter", "a", &[8.0, 9.0]),
                ("middle diameter", "b", &[12.0, 13.0]),
                ("last diameter", "c", &[8.0, 10.0]),
                ("first length", "d", &[15.0, 16.0]),
                ("middle length", "e", &[30.0, 32.0]),
                ("last length", "f", &[15.0, 18.0]),
            ],
            Self::Block => &[
                ("length", "l", &[20.0, 21.0]),
                ("width", "w", &[19.0, 20.0]),
                ("height", "h", &[20.0, 20.5]),
            ],
        }
    }
}
