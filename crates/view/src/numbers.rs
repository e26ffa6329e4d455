//! How the numbers of one scale are written: as few digits as tell its ticks apart.

/// A common power of ten and a number of decimals for all numbers along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numbers {
    exponent: i32,
    decimals: usize,
}

impl Numbers {
    /// The shortest way to write all of `ticks`. Very large and very small ones share a power of ten.
    pub fn for_ticks(ticks: &[f64]) -> Self {
        let largest = ticks.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        let plain = largest == 0.0 || (0.01..10_000.0).contains(&largest);
        let exponent = if plain { 0 } else { 3 * (largest.log10() / 3.0).floor() as i32 };
        let unit = 10f64.powi(exponent);
        let exact = |t: &f64, decimals: i32| {
            let digits = t / unit * 10f64.powi(decimals);
            (digits - digits.round()).abs() < 1e-6 * (largest / unit * 10f64.powi(decimals)).max(1.0)
        };
        let decimals = (0..9).find(|&d| ticks.iter().all(|t| exact(t, d))).unwrap_or(9);
        Self { exponent, decimals: decimals as usize }
    }

    /// A number as it stands at its tick.
    pub fn write(self, value: f64) -> String {
        signed(value / 10f64.powi(self.exponent), self.decimals)
    }

    /// What stands beside the axis: the unit, and the power of ten that was left out of the numbers.
    pub fn unit(self, unit: &str) -> String {
        if self.exponent == 0 {
            return unit.to_string();
        }
        format!("×10{}, {unit}", raised(self.exponent))
    }
}

/// An exponent in raised digits.
pub fn raised(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let sign = if exponent < 0 { "⁻" } else { "" };
    let digits: String =
        exponent.unsigned_abs().to_string().bytes().map(|d| DIGITS[usize::from(d - b'0')]).collect();
    format!("{sign}{digits}")
}

/// A number with a proper minus sign, none before zero.
pub fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| matches!(c, '0' | '.')) => zero.to_string(),
        Some(positive) => format!("\u{2212}{positive}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(ticks: &[f64]) -> (Vec<String>, String) {
        let numbers = Numbers::for_ticks(ticks);
        (ticks.iter().map(|&t| numbers.write(t)).collect(), numbers.unit("m"))
    }

    #[test]
    fn ticks_get_the_digits_they_need_and_no_more() {
        assert_eq!(
            written(&[-20.0, 0.0, 20.0]),
            (vec!["\u{2212}20".into(), "0".into(), "20".into()], "m".into())
        );
        assert_eq!(written(&[0.1, 0.2, 0.1 + 0.2]).0, ["0.1", "0.2", "0.3"]);
        assert_eq!(written(&[0.25, 0.5]).0, ["0.25", "0.50"]);
        assert_eq!(written(&[-0.001, 0.0015]), (vec!["\u{2212}1.0".into(), "1.5".into()], "×10⁻³, m".into()));
        assert_eq!(written(&[20_000.0, 40_000.0]), (vec!["20".into(), "40".into()], "×10³, m".into()));
        assert_eq!(written(&[2e12]).1, "×10¹², m");
        assert_eq!(written(&[]), (vec![], "m".into()));
        assert_eq!(written(&[0.0]).0, ["0"]);
    }

    #[test]
    fn numbers_have_a_sign_only_when_they_differ_from_zero() {
        let signs = [signed(-0.004, 2), signed(-0.4, 1), signed(3.0, 0), signed(-0.0, 1)];
        assert_eq!(signs, ["0.00", "\u{2212}0.4", "3", "0.0"]);
    }
}
