//! Colours for values.

/// Equally spaced colours of the viridis map: perceptually uniform, readable in grey and by the
/// colour-blind.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// The colour of what has no value.
const GREY: [u8; 3] = [128, 128, 128];

/// Colours for values from the least finite one (dark) to the greatest (bright); what is not finite
/// is grey.
pub(super) fn colors(values: &[f64]) -> impl Fn(f64) -> [u8; 3] {
    let finite = || values.iter().copied().filter(|x| x.is_finite());
    let (least, most) =
        finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
    move |value| {
        if !value.is_finite() {
            return GREY;
        }
        // Halved first: the range of finite values may overflow.
        let range = most / 2.0 - least / 2.0;
        let share = if range > 0.0 { (value / 2.0 - least / 2.0) / range } else { 0.0 };
        let at = share.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
        let below = (at as usize).min(VIRIDIS.len() - 2);
        let weight = at - below as f64;
        std::array::from_fn(|c| {
            let (a, b) = (f64::from(VIRIDIS[below][c]), f64::from(VIRIDIS[below + 1][c]));
            (a + weight * (b - a)).round() as u8
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_of_finite_values_is_spread_over_the_map() {
        let color = colors(&[3.0, f64::NAN, 1.0, f64::INFINITY, 2.0]);
        assert_eq!([color(1.0), color(2.0), color(3.0)], [VIRIDIS[0], VIRIDIS[4], VIRIDIS[8]]);
        assert_eq!([color(f64::NAN), color(f64::INFINITY)], [GREY, GREY]);
        assert_eq!(color(1.125), [70, 23, 103]);
    }

    #[test]
    fn degenerate_ranges_are_no_problem() {
        assert_eq!(colors(&[])(f64::NAN), GREY);
        assert_eq!(colors(&[5.0; 3])(5.0), VIRIDIS[0]);
        let wide = colors(&[f64::MIN, f64::MAX]);
        assert_eq!([wide(f64::MIN), wide(0.0), wide(f64::MAX)], [VIRIDIS[0], VIRIDIS[4], VIRIDIS[8]]);
    }
}
