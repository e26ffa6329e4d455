//! The lower envelope of the windows on one side of an edge.
//!
//! Where two windows overlap, the distance of the one whose paths come from further left increases faster: the
//! derivative of a distance along the edge is the cosine of the angle at which the path arrives. Which of the two
//! comes from further left changes at most once, where the line through both pseudo-sources meets the edge. On either
//! part, the distances are equal at one point at most.

use super::bearing::Bearing;
use super::window::{PathWindow, crossing, order};

/// Two pseudo-sources nearer to each other than this share of their distance from the edge are the same, with paths
/// on both sides of a vertex without curvature. On flat parts this leaves one window, not one for every vertex
/// passed.
const SAME_SOURCE: f64 = 1e-12;

/// Two windows with the same pseudo-source are joined over a gap of this many lengths of the edge, which is rounding.
const GAP: f64 = 1e-12;

/// Share of the narrower of two windows up to which an overlap stays, as cutting it costs more than propagating it. It
/// affects time only, which `make bench` measures.
const OVERLAP: f64 = 0.5;

/// Reduces the windows at an edge of the given length to what may carry a shortest path, in order along the edge;
/// `ends` are the labels of the edge's ends.
pub(super) fn trim<D: Bearing>(windows: &mut Vec<PathWindow<D>>, length: f64, ends: [f64; 2]) {
    cut_ends(windows, length, ends);
    windows.sort_by(|p, q| p.start.total_cmp(&q.start));
    // Of the windows before the current one, `kept` are left, in place.
    let mut kept = 0;
    for i in 0..windows.len() {
        let mut fate = Fate::BothStay;
        while kept > 0 {
            let (before, rest) = windows.split_at_mut(i);
            let (left, right) = (&mut before[kept - 1], &mut rest[0]);
            if right.start - left.end > GAP * length {
                break;
            }
            fate = meet(left, right);
            if fate != Fate::RightStays {
                break;
            }
            kept -= 1;
        }
        if fate != Fate::LeftStays {
            if kept < i {
                windows[kept] = windows[i];
            }
            kept += 1;
        }
    }
    windows.truncate(kept);
}

/// Cuts the outermost windows where paths through the ends of the edge are shorter.
fn cut_ends<D: Bearing>(windows: &mut Vec<PathWindow<D>>, length: f64, ends: [f64; 2]) {
    while windows.pop_if(|last| !last.cut_end(length, ends[1])).is_some() {}
    let gone = windows.iter_mut().position(|first| first.cut_start(ends[0])).unwrap_or(windows.len());
    windows.drain(..gone);
}

/// Which of two windows that meet are left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fate {
    BothStay,
    LeftStays,
    RightStays,
}

/// Whether two windows have the same pseudo-source at the same place.
#[inline]
fn have_same_source<D>(left: &PathWindow<D>, right: &PathWindow<D>) -> bool {
    let same = SAME_SOURCE * (left.depth + left.x.abs());
    (left.x - right.x).abs() <= same
        && (left.depth - right.depth).abs() <= same
        && (left.offset - right.offset).abs() <= same
}

/// Shares the overlap of two windows, of which `left` comes first.
#[inline]
fn meet<D: Bearing>(left: &mut PathWindow<D>, right: &mut PathWindow<D>) -> Fate {
    if have_same_source(left, right) {
        left.end = left.end.max(right.end);
        return Fate::LeftStays;
    }
    // A window that lost its start to the one before it may start after the one behind it.
    let (low, high) = (right.start, left.end.min(right.end));
    if low < left.start || high - low <= OVERLAP * (left.end - left.start).min(right.end - right.start) {
        return Fate::BothStay;
    }
    // By how much `right` is nearer at either end.
    let at_low = left.distance(low) - right.distance(low);
    let at_high = left.distance(high) - right.distance(high);
    let is_nested = right.end < left.end;
    if at_low < 0.0 && at_high > 0.0 {
        let Some(at) = crossing(left, right, [low, high]) else { return Fate::BothStay };
        right.start = at;
        if !is_nested {
            left.end = at;
        }
    } else if at_low <= 0.0 && at_high <= 0.0 {
        // Between two points where `left` is nearer, `right` may be, if it first gains, then loses.
        if order(left, right, low) > 0.0 && order(left, right, high) < 0.0 {
            return Fate::BothStay;
        }
        right.start = high;
    } else if at_low >= 0.0 && at_high >= 0.0 && !is_nested {
        if order(left, right, low) < 0.0 && order(left, right, high) > 0.0 {
            return Fate::BothStay;
        }
        left.end = low;
    }
    if right.end <= right.start {
        Fate::LeftStays
    } else if left.end <= left.start {
        Fate::RightStays
    } else {
        Fate::BothStay
    }
}
