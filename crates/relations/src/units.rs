//! Changes of size that are changes of the unit of length.

use std::fmt;

use serde::{Serialize, Serializer};

/// Units that meshes are stored in, in millimetres, by length: of two changes by one factor, the one between longer units is
/// meant.
const UNITS: [(&str, f64); 6] = [
    ("metres", 1000.0),
    ("feet", 304.8),
    ("inches", 25.4),
    ("centimetres", 10.0),
    ("millimetres", 1.0),
    ("micrometres", 0.001),
];

/// A change of the unit of length, which explains a change of size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnitChange {
    /// The unit of the first mesh.
    pub from: &'static str,
    /// The unit of the second.
    pub to: &'static str,
}

impl UnitChange {
    /// Every change of unit, in both directions, and by how much numbers grow.
    pub(super) fn all() -> impl Iterator<Item = (Self, f64)> {
        let pairs = UNITS.into_iter().flat_map(|a| UNITS.map(|b| (a, b))).filter(|(a, b)| a != b);
        pairs.map(|((from, long), (to, short))| (Self { from, to }, long / short))
    }

    /// The change of unit that multiplies sizes by `scale`, up to a relative error.
    ///
    /// ```
    /// use canonform_relations::UnitChange;
    ///
    /// assert_eq!(UnitChange::from_scale(25.4, 1e-4).unwrap().to_string(), "inches to millimetres");
    /// assert_eq!(UnitChange::from_scale(0.001, 1e-4).unwrap().to_string(), "millimetres to metres");
    /// assert_eq!(UnitChange::from_scale(2.0, 1e-4), None);
    /// ```
    pub fn from_scale(scale: f64, tolerance: f64) -> Option<Self> {
        Self::all().find(|(_, factor)| (scale / factor).ln().abs() <= tolerance).map(|(change, _)| change)
    }
}

impl fmt::Display for UnitChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {}", self.from, self.to)
    }
}

impl Serialize for UnitChange {
    fn serialize<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        out.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_change_of_unit_is_named_in_both_directions() {
        let named =
            [("inches", "millimetres", 25.4), ("metres", "millimetres", 1000.0), ("feet", "inches", 12.0)];
        let more = [("metres", "feet", 1.0 / 0.3048), ("centimetres", "millimetres", 10.0)];
        for (from, to, factor) in named.into_iter().chain(more) {
            assert_eq!(UnitChange::from_scale(factor * 1.00001, 1e-4), Some(UnitChange { from, to }));
            assert_eq!(UnitChange::from_scale(1.0 / factor, 1e-4), Some(UnitChange { from: to, to: from }));
        }
        for scale in [1.0, 3.0, f64::NAN, 0.0] {
            assert_eq!(UnitChange::from_scale(scale, 0.01), None);
        }
    }
}
