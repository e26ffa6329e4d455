//! Searching for every component of a query.

use budget::Budget;
use descriptors::PreparedShape;

use super::found::ComponentResult;
use super::search::{Explain, Query, SearchOptions, ShapeSearch};
use crate::compare::MeshGeometry;
use crate::error::Error;
use crate::form::describe_within;
use crate::input::Surface;

/// Most different components that are searched for, the largest by area.
const MOST_SEARCHED: usize = 12;

impl ShapeSearch {
    /// Searches for each different component of a query that has several, largest first.
    ///
    /// # Errors
    /// [`Error::Exceeded`] and [`Error::Index`]. A component that cannot be described is left out.
    pub(super) fn search_components(
        &self,
        query: &Query<'_>,
        options: &SearchOptions,
        budget: &Budget,
    ) -> Result<Vec<ComponentResult>, Error> {
        let Some(whole) = query.geometry.filter(|_| options.explain == Explain::Kind) else {
            return Ok(Vec::new());
        };
        let mut found = Vec::new();
        for (part, copies) in whole.different_components().into_iter().take(MOST_SEARCHED) {
            budget.check()?;
            let Some(shape) = self.described_part(part, budget)? else { continue };
            let name = match copies {
                1 => format!("a component of {}", query.name),
                _ => format!("{copies} components of {}", query.name),
            };
            let known = Query { name: &name, content: None, geometry: Some(part) };
            let options = SearchOptions { k: 1, ..options.clone() };
            let nearest = self.nearest(&shape, &known, Default::default(), &options, budget)?;
            found.push(ComponentResult {
                copies,
                area_share: (part.size() / whole.size()).powi(2),
                n_vertices: part.n_vertices(),
                nearest: nearest.results.into_iter().next(),
            });
        }
        Ok(found)
    }

    /// A component, described as the shapes of the index are.
    fn described_part(&self, part: &MeshGeometry, budget: &Budget) -> Result<Option<PreparedShape>, Error> {
        let options = self.describe_options();
        let described = Surface::within(&part.to_mesh(), &options.form.repair, budget)
            .and_then(|surface| describe_within(&surface, options, budget))
            .and_then(|description| description.prepare());
        match described {
            Ok(shape) => Ok(Some(shape)),
            Err(fault @ Error::Exceeded(_)) => Err(fault),
            Err(_) => Ok(None),
        }
    }
}
