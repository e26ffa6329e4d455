//! The directions in which paths leave the source.

use surface::CornerId;

use super::prepared::FaceFrame;
use super::tangent_plane::{Sheet, TangentPlane, angle_of};
use crate::plane::{PlanePoint, cross, distance, sub};

/// What windows and labels carry besides distances: nothing, or the [`Direction`] at the source of the paths through them.
pub(super) trait Bearing: Copy + Default + std::fmt::Debug {
    /// What is known of the source.
    type Source: ?Sized + std::fmt::Debug;

    /// That of a window which a vertex with this bearing emits over the base of a corner.
    fn emitted(self, source: &Self::Source, corner: CornerId, frame: &FaceFrame) -> Self;

    /// That of a vertex next to one with this bearing, reached along an edge.
    fn along_edge(self, source: &Self::Source, to: u32) -> Self;

    /// That of a vertex reached from one with this bearing over a link.
    fn over_link(self) -> Self;

    /// That of a vertex or pseudo-source which the path through a window along this ray reaches.
    fn towards(self, ray: PlanePoint) -> Self;

    /// That of the same window with the ends of its edge exchanged.
    fn mirrored(self) -> Self;

    /// That of a window whose edge is turned to the left by an angle with this cosine and sine.
    fn turned(self, by: [f64; 2]) -> Self;
}

impl Bearing for () {
    type Source = ();

    fn emitted(self, (): &(), _: CornerId, _: &FaceFrame) {}
    fn along_edge(self, (): &(), _: u32) {}
    fn over_link(self) {}
    fn towards(self, _: PlanePoint) {}
    fn mirrored(self) {}
    fn turned(self, _: [f64; 2]) {}
}

/// The direction at the source: an angle between the first axis of a [`TangentPlane`] plane and paths, before scaling.
///
/// Along a ray `(t - x, depth)` of a window, in the plane of its edge, the direction is `zero` plus the angle of the ray, mirrored
/// if the faces in between turned over, and rotated. At a pseudo-source all rays have that of the path to it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) enum Direction {
    /// At the source itself.
    #[default]
    Open,
    /// All paths leave the source at one angle.
    At(f64),
    Along {
        zero: f64,
        rotation: [f64; 2],
        is_mirrored: bool,
    },
}

/// The product of two complex numbers, of which the second may be conjugated.
fn times([a, b]: [f64; 2], [c, d]: [f64; 2], is_conjugated: bool) -> [f64; 2] {
    let d = if is_conjugated { -d } else { d };
    [a * c - b * d, a * d + b * c]
}

impl Bearing for Direction {
    type Source = TangentPlane;

    fn emitted(self, source: &TangentPlane, corner: CornerId, frame: &FaceFrame) -> Self {
        let Self::Open = self else { return self };
        let layouts = source.sheets.iter().filter(|sheet| sheet.face == corner.face());
        let mut layouts = layouts.map(|sheet| (sheet, frame.vertices.map(|v| sheet.place(v))));
        let Some((Sheet { start, sign, .. }, [Some(a), Some(b), Some(c)])) = layouts.next() else {
            return Self::At(f64::NAN);
        };
        let (along, [x, y]) = (distance(a, b), sub(b, a));
        // The window looks out of the face, so that its plane is turned over.
        let is_mirrored = cross([x, y], sub(c, a)) >= 0.0;
        let rotation = [x / along, sign * y / along];
        Self::Along { zero: *start, rotation, is_mirrored: is_mirrored == (*sign > 0.0) }
    }

    fn along_edge(self, source: &TangentPlane, to: u32) -> Self {
        let Self::Open = self else { return self };
        let at = source.sheets.iter().find_map(|sheet| Some((sheet, sheet.place(to)?)));
        Self::At(at.map_or(f64::NAN, |(sheet, at)| sheet.start + sheet.sign * angle_of(at)))
    }

    fn over_link(self) -> Self {
        if self == Self::Open { Self::At(f64::NAN) } else { self }
    }

    fn towards(self, ray: PlanePoint) -> Self {
        let Self::Along { zero, rotation, is_mirrored } = self else { return self };
        Self::At(zero + angle_of(times(rotation, ray, is_mirrored)))
    }

    fn mirrored(self) -> Self {
        let Self::Along { zero, rotation: [x, y], is_mirrored } = self else { return self };
        Self::Along { zero, rotation: [-x, -y], is_mirrored: !is_mirrored }
    }

    fn turned(self, by: [f64; 2]) -> Self {
        let Self::Along { zero, rotation, is_mirrored } = self else { return self };
        Self::Along { zero, rotation: times(rotation, by, is_mirrored), is_mirrored }
    }
}
