//! Body plans: what a creature is made of. `z` is up, and animals face `-y`.

use nalgebra::{Point3, Vector3};

use super::draft::{Draft, Limb};
use super::proportions::Proportions;
use crate::implicit::{Blob, BodyPart};
use crate::trig::sin_cos;

/// A body plan.
pub(crate) type BodyPlan = fn(&mut Proportions, &mut Draft);

/// All plans, with their names.
pub(crate) const PLANS: [(&str, BodyPlan); 28] = [
    ("worm", worm),
    ("star", star),
    ("octopus", octopus),
    ("spider", spider),
    ("hand", hand),
    ("bird", bird),
    ("dog", dog),
    ("human", human),
    ("fish", fish),
    ("ring", ring),
    ("ant", ant),
    ("lizard", lizard),
    ("tree", tree),
    ("crab", crab),
    ("glasses", glasses),
    ("snake", snake),
    ("dinosaur", dinosaur),
    ("teddy", teddy),
    ("scissors", scissors),
    ("giraffe", giraffe),
    ("tadpole", tadpole),
    ("turtle", turtle),
    ("cup", cup),
    ("pliers", pliers),
    ("ape", ape),
    ("key", key),
    ("centipede", centipede),
    ("fork", fork),
];

const DOWN: [f64; 3] = [0.0, 0.0, -1.0];
const UP: [f64; 3] = [0.0, 0.0, 1.0];
const FRONT: [f64; 3] = [0.0, -1.0, 0.0];
const BACK: [f64; 3] = [0.0, 1.0, 0.0];
const LEFT: [f64; 3] = [1.0, 0.0, 0.0];

/// The unit vector at an angle (degrees) from the x axis in the ground plane, raised to a slope.
fn around(degrees: f64, slope: f64) -> [f64; 3] {
    let (sin, cos) = sin_cos(degrees.to_radians());
    [cos, sin, slope]
}

fn worm(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(8.0, 15.0);
    let tip = radius * p.between(0.5, 1.0);
    let length = p.between(120.0, 230.0);
    draft.trunk(&Limb::new(FRONT, length, [radius, tip]).bones(9, 30.0));
}

fn snake(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(4.5, 6.5);
    let head = radius * p.between(1.6, 2.4);
    let length = p.between(260.0, 400.0);
    draft.trunk(&Limb::new(FRONT, length, [0.5 * radius, radius]).bones(14, 32.0).knob(head));
}

fn star(p: &mut Proportions, draft: &mut Draft) {
    let n_arms = p.count(5, 7);
    let radius = p.between(11.0, 17.0);
    let centre = p.between(1.4, 1.8) * radius;
    let arm = Limb::new(UP, p.between(50.0, 95.0), [radius, 0.3 * radius]).bones(4, 26.0);
    draft.trunk(&Limb::new(UP, 2.0, [centre; 2]));
    for i in 0..n_arms {
        let direction = around(360.0 * i as f64 / n_arms as f64, 0.0);
        draft.limb((0, 0), &arm.towards(direction));
    }
}

fn octopus(p: &mut Proportions, draft: &mut Draft) {
    let n_arms = p.count(6, 9);
    let head = p.between(17.0, 26.0);
    let root = p.between(5.0, 7.0);
    let arm = Limb::new(UP, p.between(70.0, 130.0), [root, 2.6]).bones(6, 34.0);
    let mantle = p.between(10.0, 45.0);
    let slope = p.between(-0.6, 0.0);
    draft.trunk(&Limb::new(UP, mantle, [head, 0.9 * head]));
    for i in 0..n_arms {
        let direction = around(360.0 * i as f64 / n_arms as f64, slope);
        draft.limb((0, 0), &arm.towards(direction));
    }
}

/// Legs on both sides of a trunk at one node, fanned out over an angle around the sideways direction: they rise first
/// and then come down.
fn fan_of_legs(
    draft: &mut Draft,
    node: usize,
    n_pairs: usize,
    [width, rise]: [f64; 2],
    leg: &Limb,
    knee: f64,
) {
    for i in 0..n_pairs {
        let share = if n_pairs > 1 { i as f64 / (n_pairs - 1) as f64 - 0.5 } else { 0.0 };
        let direction = around(-width * share, rise);
        // Turns about the front direction lower a leg on the left.
        draft.limbs((0, node), &leg.towards(direction).curled([0.0, knee, 0.0]));
    }
}

fn spider(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(13.0, 17.0);
    let abdomen = p.between(17.0, 27.0);
    let leg = Limb::new(LEFT, p.between(75.0, 120.0), [3.4, 2.5]).bones(4, 26.0);
    let gap = p.between(0.9, 1.3) * (radius + abdomen);
    draft.trunk(&Limb::new(BACK, gap, [radius, 0.5 * radius]).knob(abdomen));
    fan_of_legs(draft, 0, 4, [120.0, 0.6], &leg, p.between(25.0, 40.0));
}

fn ant(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(8.0, 12.0);
    let (abdomen, head) = (p.between(15.0, 24.0), p.between(11.0, 15.0));
    let leg = Limb::new(LEFT, p.between(50.0, 85.0), [3.0, 2.3]).bones(3, 26.0);
    let waist = p.between(1.3, 2.0) * abdomen;
    draft.trunk(&Limb::new(BACK, waist, [radius, 4.0]).bones(2, 20.0).knob(abdomen));
    let neck = draft.limb((0, 0), &Limb::new(FRONT, head, [0.5 * radius; 2]).bones(1, 20.0).knob(head));
    let feeler = Limb::new([0.7, -1.0, 0.5], p.between(30.0, 55.0), [2.3, 2.3]).bones(3, 28.0);
    draft.limbs((neck, 2), &feeler.buried(0.6 * head).at([0.0, 0.0, 0.5 * head]));
    fan_of_legs(draft, 0, 3, [110.0, 0.4], &leg, p.between(20.0, 35.0));
}

fn crab(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(17.0, 23.0);
    let width = p.between(10.0, 28.0);
    let body = Limb::new(LEFT, width, [radius; 2]).flat(UP, 0.6);
    draft.trunk(&body.at([-0.5 * width, 0.0, 0.0]));
    let leg = Limb::new(LEFT, p.between(45.0, 70.0), [3.4, 2.5]).bones(3, 26.0);
    let knee = p.between(25.0, 40.0);
    for (node, side) in [(1, 1.0), (0, -1.0)] {
        for i in 0..3 {
            let [x, y, z] = around(20.0 + 28.0 * f64::from(i), 0.4);
            let leg = leg.towards([side * x, y, z]).curled([0.0, side * knee, 0.0]);
            draft.limb((0, node), &leg);
        }
    }
    let arm = Limb::new(LEFT, p.between(32.0, 50.0), [5.5, 5.0]).bones(2, 30.0);
    let claw = p.between(15.0, 28.0);
    for (node, side) in [(1, 1.0), (0, -1.0)] {
        let arm = draft.limb((0, node), &arm.towards([side * 0.7, -1.0, 0.1]));
        for spread in [-0.5, 0.5] {
            let finger = Limb::new([side * (0.7 + spread), -1.0 + spread, 0.1], claw, [4.2, 2.4]);
            draft.limb((arm, 3), &finger.bones(1, 20.0));
        }
    }
}

fn hand(p: &mut Proportions, draft: &mut Draft) {
    let palm = p.between(24.0, 34.0);
    let wrist = p.between(30.0, 75.0);
    let n_fingers = p.count(3, 4);
    draft.trunk(&Limb::new(UP, wrist, [12.0, 11.0]).bones(2, 30.0).at([0.0, 0.0, -wrist]));
    let top = [0.0, 0.0, palm];
    let half = 6.8 * (n_fingers as f64 - 1.0);
    let slab = |x: f64| Blob::cone([0.4 * x, 0.0, 2.0], 9.0, [x, 0.0, palm], 7.2).blend(4.0);
    let slabs = (0..2 * n_fingers - 1).map(|i| slab(6.8 * i as f64 - half)).collect();
    draft.skin(BodyPart::added(slabs).blend(5.0), 7.0);
    let length = p.between(42.0, 75.0);
    for i in 0..n_fingers {
        let x = 13.6 * i as f64 - half;
        let longer = 1.0 - 0.18 * (x / half).powi(2);
        let finger = Limb::new([0.008 * x, 0.0, 1.0], longer * length, [5.6, 4.4]).bones(3, 42.0);
        draft.limb((0, 2), &finger.at([x, top[1], top[2]]));
    }
    let thumb = Limb::new([1.0, 0.0, 0.75], p.between(30.0, 48.0), [6.2, 5.0]).bones(2, 32.0);
    draft.limb((0, 2), &thumb.at([0.4 * half + 5.0, 0.0, 4.0]));
}

fn fork(p: &mut Proportions, draft: &mut Draft) {
    let n_teeth = p.count(3, 6);
    let gap = p.between(13.0, 18.0);
    let half = 0.5 * gap * (n_teeth as f64 - 1.0);
    let bar = Limb::new(LEFT, 2.0 * half, [6.0; 2]).bones(n_teeth - 1, 14.0);
    draft.trunk(&bar.at([-half, 0.0, 0.0]));
    let tooth = Limb::new(UP, p.between(45.0, 85.0), [4.6, 3.2]).bones(3, 30.0);
    for i in 0..n_teeth {
        draft.limb((0, i), &tooth);
    }
    let handle = Limb::new(DOWN, p.between(70.0, 130.0), [6.5, 7.5]).bones(4, 24.0);
    draft.limb((0, n_teeth / 2), &handle);
}

fn bird(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(14.0, 20.0);
    let length = p.between(30.0, 50.0);
    draft.trunk(&Limb::new(FRONT, length, [0.7 * radius, radius]).bones(2, 10.0));
    let wing = Limb::new(LEFT, p.between(80.0, 135.0), [15.0, 9.0]).bones(4, 24.0).flat(UP, 0.36);
    draft.limbs((0, 1), &wing);
    let neck = Limb::new([0.0, -1.0, 0.5], p.between(12.0, 45.0), [6.5, 5.0]).bones(3, 22.0);
    let neck = draft.limb((0, 2), &neck.knob(9.5));
    let beak = Limb::new(FRONT, p.between(12.0, 28.0), [4.0, 2.2]);
    draft.limb((neck, 4), &beak.buried(8.0));
    let tail = Limb::new(BACK, p.between(26.0, 50.0), [8.0, 13.0]).bones(2, 24.0).flat(UP, 0.36);
    draft.limb((0, 0), &tail);
    let leg = Limb::new([0.2, 0.1, -1.0], p.between(22.0, 40.0), [3.4, 2.8]).bones(2, 26.0).knob(4.2);
    draft.limbs((0, 1), &leg.at([7.0, 0.0, -4.0]));
}

/// What distinguishes one animal on four legs from another.
struct Quadruped {
    trunk: [f64; 2],
    legs: [f64; 2],
    neck: [f64; 2],
    head: f64,
    tail: [f64; 2],
}

impl Quadruped {
    fn draw(&self, draft: &mut Draft) {
        let [length, radius] = self.trunk;
        draft.trunk(&Limb::new(FRONT, length, [radius, 1.1 * radius]).bones(4, 12.0));
        let neck =
            Limb::new([0.0, -0.6, 0.8], self.neck[0], [self.neck[1], 0.75 * self.neck[1]]).bones(3, 20.0);
        let neck = draft.limb((0, 4), &neck.knob(self.head));
        let snout = Limb::new([0.0, -1.0, -0.3], self.head, [0.65 * self.head, 0.45 * self.head]);
        draft.limb((neck, 4), &snout.buried(0.7 * self.head));
        let ear = Limb::new([0.5, 0.1, 1.0], 0.7 * self.head, [0.36 * self.head, 0.25 * self.head]);
        draft.limbs((neck, 4), &ear.buried(0.8 * self.head));
        let leg = Limb::new([0.06, 0.0, -1.0], self.legs[0], [self.legs[1], 0.65 * self.legs[1]])
            .bones(3, 28.0)
            .knob(0.9 * self.legs[1]);
        for node in [0, 4] {
            draft.limbs((0, node), &leg.at([0.62 * radius, 0.0, -0.2 * radius]));
        }
        let tail =
            Limb::new([0.0, 1.0, -0.2], self.tail[0], [self.tail[1], 0.6 * self.tail[1]]).bones(5, 30.0);
        draft.limb((0, 0), &tail);
    }
}

fn dog(p: &mut Proportions, draft: &mut Draft) {
    let animal = Quadruped {
        trunk: [p.between(55.0, 95.0), p.between(13.0, 18.0)],
        legs: [p.between(30.0, 65.0), p.between(5.0, 7.5)],
        neck: [p.between(14.0, 30.0), p.between(7.0, 10.0)],
        head: p.between(10.0, 14.0),
        tail: [p.between(20.0, 85.0), p.between(3.4, 5.0)],
    };
    animal.draw(draft);
}

fn giraffe(p: &mut Proportions, draft: &mut Draft) {
    let animal = Quadruped {
        trunk: [p.between(45.0, 65.0), p.between(13.0, 17.0)],
        legs: [p.between(75.0, 105.0), p.between(5.0, 6.5)],
        neck: [p.between(70.0, 125.0), p.between(8.0, 10.0)],
        head: p.between(8.0, 11.0),
        tail: [p.between(25.0, 45.0), p.between(2.8, 3.6)],
    };
    animal.draw(draft);
}

fn turtle(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(24.0, 30.0);
    let length = p.between(12.0, 34.0);
    draft.trunk(&Limb::new(FRONT, length, [radius; 2]).flat(UP, 0.5));
    let flipper = Limb::new(LEFT, 1.0, [9.0, 6.0]).flat(UP, 0.45);
    let lengths = [p.between(22.0, 34.0), p.between(34.0, 60.0)];
    for (node, length, y) in [(0, lengths[0], 0.8), (1, lengths[1], -0.7)] {
        draft.limbs((0, node), &flipper.towards([1.0, y, 0.0]).long(length).bones(2, 26.0));
    }
    let neck = Limb::new([0.0, -1.0, 0.2], p.between(12.0, 38.0), [6.0, 5.5]).bones(3, 24.0).knob(8.5);
    draft.limb((0, 1), &neck);
    draft.limb((0, 0), &Limb::new(BACK, p.between(8.0, 24.0), [4.5, 2.8]).bones(2, 24.0));
}

fn lizard(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(9.0, 13.0);
    let length = p.between(60.0, 90.0);
    draft.trunk(&Limb::new(FRONT, length, [radius, 0.9 * radius]).bones(4, 22.0));
    let head = Limb::new(FRONT, p.between(14.0, 30.0), [0.7 * radius, 0.8 * radius]).bones(1, 16.0);
    draft.limb((0, 4), &head);
    let tail = Limb::new(BACK, p.between(80.0, 150.0), [0.7 * radius, 2.6]).bones(7, 30.0);
    draft.limb((0, 0), &tail);
    let leg = Limb::new([1.0, 0.15, -0.1], p.between(30.0, 46.0), [4.6, 3.4]).bones(2, 30.0);
    let curl = p.between(-60.0, -30.0);
    for node in [0, 4] {
        let toes = draft.limbs((0, node), &leg.clone().curled([0.0, 0.0, curl]));
        for (leg, side) in toes.into_iter().zip([1.0, -1.0]) {
            for spread in [-0.9, 0.0, 0.9] {
                let toe =
                    Limb::new([side * (0.8 - 0.3 * spread), -1.0 - 0.5 * spread, -0.1], 11.0, [2.6, 2.4]);
                draft.limb((leg, 3), &toe);
            }
        }
    }
}

fn dinosaur(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(14.0, 19.0);
    let length = p.between(38.0, 60.0);
    draft.trunk(&Limb::new([0.0, -1.0, 0.6], length, [radius, 0.75 * radius]).bones(3, 14.0));
    let neck = Limb::new([0.0, -0.6, 1.0], p.between(14.0, 50.0), [8.0, 6.5]).bones(3, 22.0).knob(11.0);
    let neck = draft.limb((0, 3), &neck);
    draft.limb((neck, 4), &Limb::new([0.0, -1.0, -0.2], p.between(9.0, 20.0), [7.0, 4.5]).buried(6.0));
    let tail = Limb::new([0.0, 1.0, -0.1], p.between(75.0, 125.0), [0.7 * radius, 3.0]).bones(6, 24.0);
    draft.limb((0, 0), &tail);
    let leg = Limb::new([0.12, 0.0, -1.0], p.between(45.0, 75.0), [8.0, 4.6]).bones(3, 26.0).knob(6.0);
    draft.limbs((0, 0), &leg.at([0.6 * radius, 0.0, 0.0]));
    let arm = Limb::new([0.35, -0.7, -1.0], p.between(14.0, 30.0), [3.4, 2.6]).bones(2, 28.0);
    draft.limbs((0, 3), &arm.at([0.45 * radius, 0.0, 0.0]));
}

/// What distinguishes one animal on two legs from another.
struct Biped {
    trunk: [f64; 2],
    legs: [f64; 2],
    arms: [f64; 2],
    head: f64,
    ears: bool,
}

impl Biped {
    fn draw(&self, draft: &mut Draft) {
        let [length, radius] = self.trunk;
        draft.trunk(&Limb::new(UP, length, [radius, 1.1 * radius]).bones(3, 14.0).flat(FRONT, 0.8));
        let neck = Limb::new(UP, 0.8 * self.head, [0.55 * self.head; 2]).bones(1, 26.0).knob(self.head);
        let neck = draft.limb((0, 3), &neck);
        if self.ears {
            let ear = Limb::new([1.0, 0.0, 0.9], 0.3 * self.head, [0.36 * self.head; 2]).flat(FRONT, 0.7);
            draft.limbs((neck, 2), &ear.buried(0.85 * self.head));
        }
        let leg =
            Limb::new([0.14, 0.0, -1.0], self.legs[0], [self.legs[1], 0.6 * self.legs[1]]).bones(3, 30.0);
        for leg in draft.limbs((0, 0), &leg.at([0.55 * radius, 0.0, 0.0])) {
            let foot =
                Limb::new([0.0, -1.0, -0.1], 1.1 * self.legs[1], [0.6 * self.legs[1], 0.5 * self.legs[1]]);
            draft.limb((leg, 4), &foot);
        }
        let arm =
            Limb::new([1.0, 0.0, -0.35], self.arms[0], [self.arms[1], 0.7 * self.arms[1]]).bones(4, 30.0);
        draft.limbs((0, 3), &arm.knob(1.05 * self.arms[1]).at([0.5 * radius, 0.0, 0.0]));
    }
}

fn human(p: &mut Proportions, draft: &mut Draft) {
    let animal = Biped {
        trunk: [p.between(48.0, 60.0), p.between(13.0, 17.0)],
        legs: [p.between(70.0, 92.0), p.between(7.0, 9.0)],
        arms: [p.between(55.0, 70.0), p.between(4.2, 5.6)],
        head: p.between(10.0, 13.0),
        ears: false,
    };
    animal.draw(draft);
}

fn ape(p: &mut Proportions, draft: &mut Draft) {
    let animal = Biped {
        trunk: [p.between(45.0, 60.0), p.between(18.0, 23.0)],
        legs: [p.between(30.0, 48.0), p.between(8.0, 10.0)],
        arms: [p.between(82.0, 115.0), p.between(6.5, 8.5)],
        head: p.between(11.0, 15.0),
        ears: false,
    };
    animal.draw(draft);
}

fn teddy(p: &mut Proportions, draft: &mut Draft) {
    let animal = Biped {
        trunk: [p.between(22.0, 36.0), p.between(22.0, 28.0)],
        legs: [p.between(22.0, 34.0), p.between(11.0, 13.0)],
        arms: [p.between(24.0, 42.0), p.between(8.5, 11.0)],
        head: p.between(18.0, 26.0),
        ears: true,
    };
    animal.draw(draft);
}

fn fish(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(20.0, 29.0);
    let length = p.between(70.0, 130.0);
    let body = Limb::new(BACK, length, [radius, 0.3 * radius]).bones(5, 16.0).flat(LEFT, 0.6);
    draft.trunk(&body);
    let fluke = Limb::new(BACK, p.between(26.0, 44.0), [7.0, 8.0]).bones(2, 22.0).flat(LEFT, 0.4);
    for z in [0.9, -0.9] {
        draft.limb((0, 5), &fluke.towards([0.0, 1.0, z]));
    }
    let fin = Limb::new([0.0, 0.6, 1.0], p.between(14.0, 34.0), [10.0, 6.0]).flat(LEFT, 0.4);
    draft.limb((0, 1), &fin);
    let side = Limb::new([1.0, 0.8, -0.4], p.between(18.0, 40.0), [8.0, 6.0]).bones(2, 24.0).flat(UP, 0.45);
    draft.limbs((0, 1), &side.buried(0.45 * radius).at([0.0, 0.0, -0.2 * radius]));
}

fn tadpole(p: &mut Proportions, draft: &mut Draft) {
    let radius = p.between(22.0, 32.0);
    let body = Limb::new(FRONT, p.between(4.0, 30.0), [radius; 2]);
    draft.trunk(&body);
    let tail = Limb::new(BACK, p.between(80.0, 150.0), [p.between(7.0, 11.0), 3.0]).bones(7, 30.0);
    draft.limb((0, 0), &tail);
}

fn centipede(p: &mut Proportions, draft: &mut Draft) {
    let n_pairs = p.count(6, 9);
    let gap = p.between(17.0, 22.0);
    let radius = p.between(6.0, 8.5);
    let n_bones = n_pairs + 1;
    let body = Limb::new(FRONT, gap * n_bones as f64, [0.8 * radius, radius]).bones(n_bones, 20.0);
    draft.trunk(&body.knob(1.3 * radius));
    let leg = Limb::new([1.0, 0.0, -0.3], p.between(18.0, 34.0), [2.8, 2.4]).bones(2, 24.0);
    for node in 1..=n_pairs {
        draft.limbs((0, node), &leg);
    }
}

fn tree(p: &mut Proportions, draft: &mut Draft) {
    let n_branches = p.count(3, 5);
    draft.trunk(&Limb::new(UP, p.between(45.0, 85.0), [9.0, 7.5]).bones(3, 18.0));
    let branch = Limb::new(UP, p.between(36.0, 60.0), [5.6, 4.2]).bones(2, 26.0);
    let twig = Limb::new(UP, p.between(18.0, 40.0), [3.6, 2.5]).bones(2, 26.0);
    let slope = p.between(0.5, 1.0);
    for i in 0..n_branches {
        let angle = 360.0 * i as f64 / n_branches as f64;
        let branch = draft.limb((0, 3), &branch.towards(around(angle, slope)));
        for turn in [-38.0, 38.0] {
            draft.limb((branch, 3), &twig.towards(around(angle + turn, slope)));
        }
    }
}

fn ring(p: &mut Proportions, draft: &mut Draft) {
    let hole = p.between(40.0, 60.0);
    let tube = hole * p.between(0.16, 0.34);
    let bones = Limb::new(LEFT, 2.0 * hole, [hole; 2]).bones(4, 24.0);
    draft.bones(&bones.at([-hole, 0.0, 0.0]));
    draft.torus(Point3::origin(), Vector3::x(), Vector3::z(), [hole, tube]);
}

fn glasses(p: &mut Proportions, draft: &mut Draft) {
    let (hole, tube) = (p.between(22.0, 30.0), p.between(3.2, 4.4));
    let apart = hole + tube + p.between(4.0, 14.0);
    let reach = apart + hole;
    let bones = Limb::new(LEFT, 2.0 * reach, [hole; 2]).bones(4, 10.0);
    draft.bones(&bones.at([-reach, 0.0, 0.0]));
    for side in [-1.0, 1.0] {
        draft.torus(Point3::new(side * apart, 0.0, 0.0), Vector3::x(), Vector3::y(), [hole, tube]);
    }
    let bridge = apart - hole;
    let bar = vec![Blob::cone([-bridge, 0.0, 0.0], tube, [bridge, 0.0, 0.0], tube)];
    draft.skin(BodyPart::added(bar).blend(tube), tube);
    let temple = Limb::new(BACK, p.between(55.0, 105.0), [tube, 0.8 * tube]).bones(4, 24.0);
    for node in [0, 4] {
        draft.limb((0, node), &temple.clone().buried(1.5 * tube));
    }
}

/// A pivot that other limbs cross, lying on the ground.
fn pivot(radius: f64) -> Limb {
    Limb::new(UP, 1.0, [radius; 2])
}

fn scissors(p: &mut Proportions, draft: &mut Draft) {
    draft.trunk(&pivot(7.0));
    let blade = Limb::new(UP, p.between(60.0, 115.0), [5.5, 3.0]).bones(3, 18.0);
    let shank = Limb::new(UP, p.between(25.0, 50.0), [4.5, 4.5]).bones(2, 16.0);
    let angle = p.between(20.0, 34.0);
    let rings = [p.between(13.0, 19.0), p.between(3.6, 4.8)];
    for side in [-1.0, 1.0] {
        draft.limb((0, 0), &blade.towards(around(90.0 + side * angle, 0.0)));
        let direction = around(270.0 + side * 1.8 * angle, 0.0);
        let shank = draft.limb((0, 0), &shank.towards(direction));
        draft.ring((shank, 3), UP, rings, &Limb::new(direction, 1.0, [4.0; 2]).bones(1, 14.0));
    }
}

fn pliers(p: &mut Proportions, draft: &mut Draft) {
    draft.trunk(&pivot(p.between(9.0, 13.0)));
    let jaw = Limb::new(UP, p.between(24.0, 50.0), [7.0, 3.6]).bones(2, 18.0);
    let grip = Limb::new(UP, p.between(85.0, 140.0), [5.5, 6.5]).bones(4, 18.0);
    let angle = p.between(22.0, 36.0);
    for side in [-1.0, 1.0] {
        draft.limb((0, 0), &jaw.towards(around(90.0 + side * angle, 0.0)));
        draft.limb((0, 0), &grip.towards(around(270.0 + side * angle, 0.0)));
    }
}

fn key(p: &mut Proportions, draft: &mut Draft) {
    let length = p.between(75.0, 140.0);
    draft.trunk(&Limb::new(UP, length, [6.0, 5.0]).bones(5, 18.0));
    let bow = [p.between(19.0, 32.0), p.between(5.0, 6.5)];
    draft.ring((0, 5), FRONT, bow, &Limb::new(UP, 1.0, [5.0; 2]).bones(1, 14.0));
    let bit = Limb::new(LEFT, p.between(11.0, 24.0), [4.2, 4.2]);
    for node in 0..p.count(2, 3) {
        draft.limb((0, node), &bit);
    }
}

fn cup(p: &mut Proportions, draft: &mut Draft) {
    let (radius, height) = (p.between(26.0, 34.0), p.between(30.0, 62.0));
    let wall = 4.5;
    let bones = Limb::new(UP, height + radius, [radius; 2]).bones(4, 8.0);
    draft.bones(&bones.at([0.0, 0.0, -radius]));
    let outside = Blob::cone([0.0; 3], radius, [0.0, 0.0, height], radius);
    draft.skin(BodyPart::added(vec![outside]), wall);
    // The handle, half a ring outside the wall.
    let (reach, tube) = (p.between(0.3, 0.5) * height, p.between(3.6, 5.0));
    let at = |i: usize| {
        let (sin, cos) = sin_cos((-110.0 + 220.0 * i as f64 / 10.0_f64).to_radians());
        [radius + reach * (0.3 + cos), 0.0, 0.5 * height + reach * sin]
    };
    let handle = (0..10).map(|i| Blob::cone(at(i), tube, at(i + 1), tube)).collect();
    draft.skin(BodyPart::added(handle).blend(2.0), tube);
    let inside = Blob::cone([0.0; 3], radius - wall, [0.0, 0.0, height + radius], radius - wall);
    draft.skin(BodyPart::carved(vec![inside]).blend(2.0), wall);
    draft.genus = 1;
}
