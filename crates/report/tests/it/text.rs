//! Laws of numbers and tables as text.

use canonform_report::Table;
use canonform_report::numbers::{bytes, seconds, signed, significant, tick_labels};

fn written(ticks: &[f64]) -> (Vec<String>, String) {
    tick_labels(ticks, "m")
}

#[test]
fn tick_labels_have_as_few_digits_as_tell_them_apart() {
    assert_eq!(
        written(&[-20.0, 0.0, 20.0]),
        (vec!["\u{2212}20".into(), "0".into(), "20".into()], "m".into())
    );
    assert_eq!(written(&[0.1, 0.2, 0.1 + 0.2]).0, ["0.1", "0.2", "0.3"]);
    assert_eq!(written(&[0.25, 0.5]).0, ["0.25", "0.50"]);
    assert_eq!(written(&[-0.001, 0.0015]), (vec!["\u{2212}1.0".into(), "1.5".into()], "×10⁻³, m".into()));
    assert_eq!(written(&[20_000.0, 40_000.0]), (vec!["20".into(), "40".into()], "×10³, m".into()));
    assert_eq!(written(&[2e12]).1, "×10¹², m");
    assert_eq!([2e12, 2.0].map(|tick| tick_labels(&[tick], "").1), ["×10¹²", ""]);
    assert_eq!(written(&[]), (vec![], "m".into()));
    assert_eq!(written(&[0.0]).0, ["0"]);
}

#[test]
fn only_numbers_that_differ_from_zero_have_a_sign() {
    let signs = [signed(-0.004, 2), signed(-0.4, 1), signed(3.0, 0), signed(-0.0, 1)];
    assert_eq!(signs, ["0.00", "\u{2212}0.4", "3", "0.0"]);
}

#[test]
fn durations_and_memory_have_digits_to_suit_their_size() {
    assert_eq!([123.0, 1.5, 0.5, 0.0012].map(seconds), ["123.0", "1.50", "0.500", "0.0012"]);
    assert_eq!([1 << 19, 200 << 20, 3 << 30].map(bytes), ["0.5 MiB", "200 MiB", "3.00 GiB"]);
    let digits = [12345.0, 1060.4, 0.012_34, 1e-9, 2.5e7 + 0.5].map(|value| significant(value, 3));
    assert_eq!(digits, ["12345", "1060", "0.0123", "1.0e-9", "2.5e7"]);
}

#[test]
fn columns_are_aligned_and_numbers_have_digits_to_suit_their_size() {
    let row = |name: &str, score: f64, seconds: Option<f64>| vec![name.into(), score.into(), seconds.into()];
    let rows =
        vec![row("long name", 1.0, Some(0.009_234)), row("b", 0.98765, Some(1234.56)), row("c", -0.5, None)];
    let table = Table::new("", ["method", "NN", "seconds"], rows);
    let expected = "method         NN   seconds\nlong name   1.000  0.009234\nb           0.988      1235\nc          -0.500         -";
    assert_eq!(table.to_text(), expected);
    let back: Table = serde_json::from_str(&serde_json::to_string(&table).unwrap()).unwrap();
    assert_eq!(back, table);
}
