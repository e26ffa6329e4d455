//! Compactness and separation of classes.

use linalg::DistanceMatrix;

use crate::Labels;

/// Mean silhouette `(b - a) / max(a, b)` of all shapes, in -1..=1, where `a` is the mean distance to the other
/// members of the class and `b` the smallest mean distance to another class (Rousseeuw 1987).
///
/// A shape that is alone in its class counts as 0. Returns 0 for fewer than two classes.
pub fn silhouette(distances: &DistanceMatrix, labels: &Labels) -> f64 {
    let n = labels.n_points();
    let n_classes = labels.classes().len();
    if n == 0 || n_classes < 2 {
        return 0.0;
    }
    let mut sum = 0.0;
    for i in 0..n {
        let mut totals = vec![0.0; n_classes];
        for (j, d) in distances.row(i).iter().enumerate() {
            totals[labels.class(j)] += d;
        }
        let own = labels.class(i);
        if labels.size(own) < 2 {
            continue;
        }
        let a = totals[own] / (labels.size(own) - 1) as f64;
        let b = (0..n_classes)
            .filter(|&class| class != own)
            .map(|class| totals[class] / labels.size(class) as f64)
            .fold(f64::INFINITY, f64::min);
        let larger = a.max(b);
        if larger > 0.0 {
            sum += (b - a) / larger;
        }
    }
    sum / n as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ranking::line;

    #[test]
    fn matches_its_definition() {
        let labels = Labels::new(&["a", "a", "b", "b"]);
        let value = silhouette(&line(&[0.0, 1.0, 10.0, 12.0]), &labels);
        let term = |a: f64, b: f64| (b - a) / a.max(b);
        let expected = (term(1.0, 11.0) + term(1.0, 10.0) + term(2.0, 9.5) + term(2.0, 11.5)) / 4.0;
        assert!((value - expected).abs() < 1e-15);
    }

    #[test]
    fn degenerate_cases_are_zero() {
        assert_eq!(silhouette(&line(&[0.0, 1.0]), &Labels::new(&["a", "a"])), 0.0);
        assert_eq!(silhouette(&line(&[0.0, 0.0, 0.0]), &Labels::new(&["a", "a", "b"])), 0.0);
    }
}
