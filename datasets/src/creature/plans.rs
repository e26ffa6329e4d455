//! Body plans: what a creature is made of, from `bodies/creatures.toml`, which explains their words.

use std::collections::HashMap;
use std::mem;
use std::sync::LazyLock;

use nalgebra::Vector3;
use serde::Deserialize;

use super::draft::{Draft, Limb, Ring};
use super::proportions::Proportions;
use crate::implicit::{Blob, BodyPart};
use crate::trig::{rotation, sin_cos};

/// All plans, in the order of the families.
pub(crate) static PLANS: LazyLock<Vec<Plan>> =
    LazyLock::new(|| read(include_str!("../../bodies/creatures.toml")));

/// The plans in a text.
///
/// # Panics
/// If the text is no list of plans: it is ours, which tests read.
fn read(text: &str) -> Vec<Plan> {
    let mut file: HashMap<String, Vec<Plan>> =
        toml::from_str(text).unwrap_or_else(|fault| panic!("body plans: {fault}"));
    file.remove("plans").unwrap_or_default()
}

/// A body plan.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Plan {
    pub(crate) name: String,
    like: Option<String>,
    handles: usize,
    count: Option<(String, usize, usize)>,
    numbers: Vec<NamedNumber>,
    trunk: LimbPlan,
    skins: Vec<SkinPlan>,
    limbs: Vec<LimbPlan>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct LimbPlan {
    sides: Sides,
    repeat: Option<Number>,
    numbers: Vec<NamedNumber>,
    node: Number,
    at: [Number; 3],
    to: Vec<Number>,
    length: Number,
    radii: [Number; 2],
    bones: Option<Number>,
    bend: f64,
    curl: [Number; 3],
    flat: Option<([f64; 3], f64)>,
    buried: Option<Number>,
    knob: Option<Number>,
    bare: bool,
    ring: Option<RingPlan>,
    limbs: Vec<LimbPlan>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RingPlan {
    normal: [f64; 3],
    hole: Number,
    tube: Number,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct SkinPlan {
    n: Number,
    turn: [f64; 2],
    numbers: Vec<NamedNumber>,
    from: Option<[Number; 4]>,
    at: [Number; 4],
    join: f64,
    blend: Number,
    carved: bool,
    finest: Number,
}

/// The sides of the plane `x = 0` with this limb, relative to that of the limb on which it grows.
#[derive(Debug, Default, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Sides {
    #[default]
    Left,
    Right,
    Both,
}

impl Sides {
    /// For every side whether it is mirrored.
    fn mirrored(self) -> &'static [bool] {
        match self {
            Self::Left => &[false],
            Self::Right => &[true],
            Self::Both => &[false, true],
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Number {
    Literal(f64),
    Sum(String),
}

impl Default for Number {
    fn default() -> Self {
        Self::Literal(0.0)
    }
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum NamedNumber {
    Drawn(String, f64, f64),
    Computed(String, Number),
}

/// The values of names.
#[derive(Debug, Clone, Default)]
struct Names<'a>(HashMap<&'a str, f64>);

impl<'a> Names<'a> {
    /// These names and the others, of which none is drawn.
    fn with(&self, values: &[(&'a str, f64)], computed: &'a [NamedNumber]) -> Self {
        let mut names = self.clone();
        names.0.extend(values.iter().copied());
        for number in computed {
            names.define(number, |_, _| panic!("numbers are drawn for the whole body, not for a limb"));
        }
        names
    }

    fn define(&mut self, number: &'a NamedNumber, draw: impl FnOnce(f64, f64) -> f64) {
        let (name, value) = match number {
            NamedNumber::Drawn(name, lo, hi) => (name, draw(*lo, *hi)),
            NamedNumber::Computed(name, number) => (name, self.value(number)),
        };
        self.0.insert(name, value);
    }

    fn value(&self, number: &Number) -> f64 {
        let text = match number {
            Number::Literal(value) => return *value,
            Number::Sum(text) => text,
        };
        let (mut sum, mut product, mut divides) = (0.0, 1.0, false);
        for word in text.split_whitespace() {
            match word {
                "+" => sum += mem::replace(&mut product, 1.0),
                "-" => sum += mem::replace(&mut product, -1.0),
                "/" => divides = true,
                _ => {
                    let named = || self.0.get(word).unwrap_or_else(|| panic!("no number is called {word:?}"));
                    let factor = word.parse().unwrap_or_else(|_| *named());
                    product = if mem::take(&mut divides) { product / factor } else { product * factor };
                }
            }
        }
        sum + product
    }

    fn values<const N: usize>(&self, numbers: &[Number; N]) -> [f64; N] {
        numbers.each_ref().map(|number| self.value(number))
    }

    /// A direction of three coordinates, or of an angle (degrees) from the x axis in the ground plane and a slope.
    fn direction(&self, numbers: &[Number]) -> Vector3<f64> {
        match *numbers.iter().map(|number| self.value(number)).collect::<Vec<_>>() {
            [x, y, z] => Vector3::new(x, y, z).normalize(),
            [degrees, slope] => {
                let (sin, cos) = sin_cos(degrees.to_radians());
                Vector3::new(cos, sin, slope).normalize()
            }
            ref other => panic!("{} numbers are no direction", other.len()),
        }
    }
}

impl Plan {
    /// The body with these proportions.
    pub(crate) fn draft(&self, proportions: &mut Proportions) -> Draft {
        let mut names = Names::default();
        if let Some((name, lo, hi)) = &self.count {
            names.0.insert(name, proportions.count(*lo, *hi) as f64);
        }
        for number in &self.numbers {
            names.define(number, |lo, hi| proportions.between(lo, hi));
        }
        let same = |name: &String| PLANS.iter().find(|plan| plan.name == *name);
        let shape = self.like.as_ref().and_then(same).unwrap_or(self);
        let mut draft = Draft { genus: shape.handles, ..Draft::default() };
        draft.limb(None, &shape.trunk.limb(&names));
        for skin in &shape.skins {
            draft.skin(skin.part(&names), names.value(&skin.finest));
        }
        for limb in &shape.limbs {
            limb.grow(&mut draft, (0, false), &names);
        }
        draft
    }
}

impl LimbPlan {
    /// Adds the limb, its copies and what grows on them to a chain, which may be on the right.
    fn grow(&self, draft: &mut Draft, (parent, is_right): (usize, bool), names: &Names<'_>) {
        let n = self.repeat.as_ref().map_or(1, |n| names.value(n) as usize);
        for i in 0..n {
            let names = names.with(&[("i", i as f64)], &self.numbers);
            let (node, limb) = (names.value(&self.node) as usize, self.limb(&names));
            let mut grow = |mirrored: &bool| {
                let is_right = is_right != *mirrored;
                let limb = if is_right { &limb.mirrored() } else { &limb };
                (draft.limb(Some((parent, node)), limb), is_right)
            };
            let chains: Vec<(usize, bool)> = self.sides.mirrored().iter().map(&mut grow).collect();
            for (chain, limb) in
                chains.into_iter().flat_map(|chain| self.limbs.iter().map(move |limb| (chain, limb)))
            {
                limb.grow(draft, chain, &names);
            }
        }
    }

    fn limb(&self, names: &Names<'_>) -> Limb {
        let [x, y, z] = names.values(&self.curl);
        let value = |number: &Option<Number>| number.as_ref().map(|number| names.value(number));
        let ring = |RingPlan { normal, hole, tube }: &RingPlan| Ring {
            normal: Vector3::from(*normal),
            hole: names.value(hole),
            tube: names.value(tube),
        };
        Limb {
            direction: names.direction(&self.to),
            offset: names.values(&self.at).into(),
            length: names.value(&self.length),
            radii: names.values(&self.radii),
            n_bones: value(&self.bones).map_or(1, |n| n as usize),
            curl: rotation(x, y, z),
            bend: self.bend,
            flattening: self.flat,
            buried: value(&self.buried),
            knob: value(&self.knob),
            is_bare: self.bare,
            ring: self.ring.as_ref().map(ring),
        }
    }
}

impl SkinPlan {
    fn part(&self, names: &Names<'_>) -> BodyPart {
        let n = names.value(&self.n);
        let point = |i: usize, at: &[Number; 4]| {
            let [first, last] = self.turn;
            let (sin, cos) = sin_cos(first.to_radians() + (last - first).to_radians() * i as f64 / n);
            let names = names.with(&[("i", i as f64), ("sin", sin), ("cos", cos)], &self.numbers);
            names.values(at)
        };
        let cone = |i: usize| {
            let balls = match &self.from {
                Some(from) => [point(i, from), point(i, &self.at)],
                None => [point(i, &self.at), point(i + 1, &self.at)],
            };
            Blob::new(balls, None, self.join)
        };
        let cones = (0..n as usize).map(cone).collect();
        BodyPart::new(self.carved, cones, names.value(&self.blend))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_a_sum_of_products() {
        let names = Names(HashMap::from([("a", 3.0), ("b", 0.5)]));
        let value = |text: &str| names.value(&Number::Sum(text.to_owned()));
        assert_eq!(value("2 a"), 6.0);
        assert_eq!(value("a - 2 b / 4 + -1 a a"), 3.0 - 0.25 - 9.0);
    }

    #[test]
    #[should_panic(expected = "unknown field `feathers`")]
    fn unknown_keys_are_errors() {
        read("[[plans]]\nname = 'bird'\nfeathers = 2");
    }
}
