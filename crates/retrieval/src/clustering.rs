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
