//! The signature of a surface in space, for surfaces that do not bend.

use mesh::{SmoothRegions, TriMesh};
use nalgebra::{Point3, Vector3};

use super::kind::{Signature, SignatureKind};
use super::quantiles::quantiles;
use rigid::{PointSet, farthest_points};

/// Bins of the distribution of distances. A convention.
const DISTANCES: usize = 16;

/// The factor of distances: another triangulation changes them by .0055, root mean square, and the other values by .0016 (48
/// generated parts, four copies of each).
const OF_DISTANCES: f64 = 0.25;

/// The factor of the powers of normals: noise of .2 % of the diagonal changes them by .12, and the other values by .02
/// (`experiments run robustness --families parts:16x1`).
const OF_NORMALS: f64 = 0.1;

/// The largest degree of the harmonics of normals, a convention. The first is zero for closed surfaces.
const DEGREE: usize = 8;

/// The shape of a surface in space: it changes if the surface bends, so it counts between two surfaces that do not.
///
/// | values | meaning |
/// |---|---|
/// | 1 | cube root of the volume |
/// | 3 | root mean square distances from the centroid along the principal axes |
/// | 16 | the distribution of distances between two points, in 16 bins of equal shares (D2 of Osada et al. 2002, `osada2002` in `REFERENCES.bib`), divided by four |
/// | 7 | the power of the areas by normal (the extended Gaussian image, `horn1984` in `REFERENCES.bib`) in the spherical harmonics of degrees 2 to 8, divided by ten |
///
/// Lengths are divided by the square root of the area. The power of degree `l` is `Σ_fg a_f a_g P_l(n_f · n_g)`, with `a` the
/// share of the area of a face, `n` its normal and `P_l` the Legendre polynomial: 1 if all normals are parallel, for even `l`.
///
/// * Invariant to rigid motions, mirror images, scale and the order of vertices.
/// * Volume, moments and powers depend on the surface only. Distances are measured between 400 pieces of it, which another
///   triangulation changes a little.
/// * `None` unless planes and cylinders between sharp edges make up the surface ([`SmoothRegions`]): others may bend.
/// * Cost `O(p)` for p vertices, with 400 passes over them.
pub fn rigid_signature(mesh: &TriMesh) -> Option<Signature> {
    let signature = || Signature { kind: SignatureKind::Rigid, values: in_space(mesh) };
    SmoothRegions::of(mesh).is_mechanical.then(signature)
}

fn in_space(mesh: &TriMesh) -> Vec<f64> {
    let unit = mesh.root_of_area();
    let (centroid, covariance) = mesh.moments();
    let mut axes = covariance.symmetric_eigenvalues().map(|x| x.max(0.0).sqrt() / unit);
    axes.as_mut_slice().sort_by(|a, b| b.total_cmp(a));
    // The volume of an open surface depends on the origin.
    let centered: Vec<_> = mesh.positions.iter().map(|p| (p - centroid) / unit).collect();
    let centered = TriMesh { positions: centered, faces: mesh.faces.clone() };
    let mut values = vec![centered.signed_volume().abs().cbrt()];
    values.extend(axes.iter());
    let distances = quantiles(distances(&centered).iter().copied(), DISTANCES);
    values.extend(distances.into_iter().map(|distance| OF_DISTANCES * distance));
    values.extend(powers(&centered)[2..].iter().map(|power| OF_NORMALS * power));
    values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
    values
}

/// Distances between the centroids of evenly spread pieces, with the product of their areas.
fn distances(mesh: &TriMesh) -> Vec<(f64, f64)> {
    let areas = mesh.vertex_areas();
    let spread = farthest_points(&mesh.positions, PointSet::SAMPLES);
    let mut pieces = vec![(Vector3::zeros(), 0.0); spread.samples.len()];
    for ((&piece, p), area) in spread.nearest.iter().zip(&mesh.positions).zip(&areas) {
        pieces[piece].0 += p.coords * *area;
        pieces[piece].1 += area;
    }
    let pieces: Vec<(Point3<f64>, f64)> = pieces
        .into_iter()
        .filter(|(_, area)| *area > 0.0)
        .map(|(sum, area)| (Point3::from(sum / area), area))
        .collect();
    let pairs = pieces.iter().enumerate().flat_map(|(i, (p, a))| {
        let others = &pieces[..i];
        others.iter().map(move |(q, b)| ((p - q).norm(), a * b))
    });
    pairs.collect()
}

/// The power of the areas by normal in the spherical harmonics of every degree.
fn powers(mesh: &TriMesh) -> [f64; DEGREE + 1] {
    // Real and imaginary part of every harmonic of order 0 and more, `sums[l][m]`.
    let mut sums = [[[0.0f64; 2]; DEGREE + 1]; DEGREE + 1];
    let mut total = 0.0;
    for f in 0..mesh.n_faces() {
        let vector = mesh.area_vector(f);
        let area = vector.norm();
        let Some(n) = vector.try_normalize(0.0) else { continue };
        total += area;
        // (x + i y)^m, and associated Legendre functions without the factor (1 - z²)^(m/2) that it contains.
        let mut turn = [1.0, 0.0];
        let mut sectoral = 1.0;
        for m in 0..=DEGREE {
            let (mut before, mut legendre) = (0.0, sectoral);
            for (l, degree) in sums.iter_mut().enumerate().skip(m) {
                if l > m {
                    let (l, m) = (l as f64, m as f64);
                    let next = ((2.0 * l - 1.0) * n.z * legendre - (l + m - 1.0) * before) / (l - m);
                    (before, legendre) = (legendre, next);
                }
                degree[m][0] += area * legendre * turn[0];
                degree[m][1] += area * legendre * turn[1];
            }
            turn = [turn[0] * n.x - turn[1] * n.y, turn[0] * n.y + turn[1] * n.x];
            sectoral *= (2 * m + 1) as f64;
        }
    }
    std::array::from_fn(|l| {
        // The factor of order m in the addition theorem: 2 (l - m)! / (l + m)!, half of it for m = 0.
        let mut factor = 1.0;
        let of_order = |(m, [re, im]): (usize, &[f64; 2])| {
            if m > 0 {
                factor /= ((l - m + 1) * (l + m)) as f64;
            }
            let both = if m > 0 { 2.0 } else { 1.0 };
            both * factor * (re * re + im * im)
        };
        sums[l][..=l].iter().enumerate().map(of_order).sum::<f64>() / (total * total)
    })
}
