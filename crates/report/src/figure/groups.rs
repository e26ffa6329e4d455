//! Plots with several series side by side in every category.

use super::axis::Axis;
use super::model::{Plot, Point, Series, Shape};
use super::style::Style;
use crate::classes::Classes;
use crate::results;

/// The value of a series at a category.
#[derive(Debug, Clone)]
pub struct Group<'a> {
    /// Name of the category.
    pub category: &'a str,
    /// Name of the series.
    pub series: &'a str,
    /// Our value, with any `x`, if there is one.
    pub own: Option<Point>,
    /// The value printed in the paper, if there is one.
    pub paper: Option<f64>,
}

/// A plot of our values (filled) and the paper's (hollow, with the name that `paper` makes of that of the series) over
/// a vertical axis of this quantity. Series without a value are left out.
pub fn grouped(
    title: &str,
    quantity: &results::Axis,
    groups: &[Group<'_>],
    paper: fn(&str) -> String,
) -> Plot {
    let categories = Classes::of(groups.iter().map(|group| group.category));
    let is_known = |group: &&Group<'_>| group.own.is_some() || group.paper.is_some();
    let names = Classes::of(groups.iter().filter(is_known).map(|group| group.series));
    let n = names.names().len() as f64;
    let mut series = Vec::new();
    for (i, name) in names.names().iter().enumerate() {
        let side = (i as f64 - (n - 1.0) / 2.0) * 0.7 / n;
        let members = || groups.iter().filter(|group| group.series == *name);
        let x = |group: &Group<'_>| categories.index(group.category) as f64 + side;
        let own = members().filter_map(|g| Some(Point { x: x(g), ..g.own.clone()? }));
        let printed = members().filter_map(|g| Some(Point::new(x(g), g.paper?, "")));
        for (name, shape, points) in [
            ((*name).to_owned(), Shape::Filled, own.collect::<Vec<_>>()),
            (paper(name), Shape::Hollow, printed.collect()),
        ] {
            if !points.is_empty() {
                series.push(Series { name, style: Style(i), shape, points });
            }
        }
    }
    let label = format!("{}: {title}", quantity.name);
    let x = Axis::categories("", categories.names().iter().map(|name| (*name).to_owned()));
    Plot { x, ..Plot::new(title, label, quantity, quantity, series, vec![]) }
}
