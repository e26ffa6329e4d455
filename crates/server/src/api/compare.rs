//! Comparison of two shapes.

use std::sync::Arc;

use axum::extract::State;
use canonform::descriptors::{CanonicalForm, PreparedShape, ShapeMetric, ShapePair};
use canonform::index::ContentHash;
use canonform::{
    Budget, Comparison, Error, MatchEvidence, Overlay, Residual, SurfaceComparison, Triangulation,
    compare_surfaces,
};
use serde::{Deserialize, Serialize};
use view::interactive::Geometry;

use super::answer::{Params, Written};
use super::shapes::is_missing;
use crate::app::{App, Query};
use crate::collection::Collection;
use crate::error::ApiError;
use crate::measured::{Measured, overlaid};

/// The two shapes: `query` or `a`, and `b`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CompareParams {
    /// The `query_id` of an upload.
    pub(super) query: Option<String>,
    /// A shape of the index.
    pub(super) a: Option<String>,
    /// A shape of the index.
    pub(super) b: String,
}

impl CompareParams {
    /// The size of the meshes, for [`Work::run`](crate::work::Work::run).
    pub(super) fn cost(&self, app: &App, collection: &Collection) -> usize {
        let ids = self.a.iter().chain([&self.b]);
        ids.map(|id| app.cost(collection, id)).fold(0, usize::saturating_add)
    }

    /// The error that there is no first shape, or two of them.
    pub(super) fn not_two() -> ApiError {
        ApiError::bad_request("give either an upload with `query` or a shape with `a`")
    }
}

#[derive(Serialize)]
struct Answer {
    a: String,
    b: String,
    /// What kind of match the shapes are.
    evidence: MatchEvidence,
    #[serde(flatten)]
    comparison: Comparison,
    /// Whether both meshes have the same triangles; unknown if a mesh is missing.
    triangulation: Option<Triangulation>,
    /// Of either form from the other, in units of the first mesh.
    residual: [Residual; 2],
    /// Both forms after alignment, coloured by the distance of each point from the other form.
    forms: [Geometry; 2],
}

/// One of the two shapes.
enum Side {
    Query(Arc<Query>, Box<PreparedShape>),
    /// Not measured if the mesh is missing.
    Shape(Box<PreparedShape>, Option<Arc<Measured>>, ContentHash),
}

impl Side {
    fn of_shape(app: &App, collection: &Collection, id: &str, budget: &Budget) -> Result<Self, Error> {
        let shape = Box::new(collection.search.prepared(id)?);
        let content = collection.search.index().entry(id)?.content;
        match app.indexed(collection, id, budget) {
            Err(fault) if !is_missing(&fault) => Err(fault),
            measured => Ok(Self::Shape(shape, measured.ok(), content)),
        }
    }

    fn shape(&self) -> &PreparedShape {
        match self {
            Self::Query(_, shape) | Self::Shape(shape, ..) => shape,
        }
    }

    fn measured(&self) -> Option<&Measured> {
        match self {
            Self::Query(query, _) => Some(&query.measured),
            Self::Shape(_, measured, _) => measured.as_deref(),
        }
    }

    /// The hash of the file.
    fn content(&self) -> ContentHash {
        match self {
            Self::Query(query, _) => query.content,
            Self::Shape(.., content) => *content,
        }
    }

    fn form(&self) -> &CanonicalForm {
        self.measured().map_or(self.shape().form(), |measured| &measured.form)
    }
}

pub(super) async fn compare(
    State(app): State<Arc<App>>,
    Params(params): Params<CompareParams>,
) -> Result<Written, ApiError> {
    let (shared, collection) = (app.clone(), app.served.collection());
    let cost = params.cost(&app, &collection);
    let job = move |budget: &Budget| Written::new(&answer(&shared, &collection, params, budget)?);
    app.work.run(cost, None, job).await
}

fn answer(
    app: &App,
    collection: &Collection,
    params: CompareParams,
    budget: &Budget,
) -> Result<Answer, ApiError> {
    let (name, a) = match (params.query, params.a) {
        (Some(query), None) => {
            let query = app.query(collection, &query)?;
            let shape = Box::new(query.description.prepare()?);
            (query.name.clone(), Side::Query(query, shape))
        }
        (None, Some(id)) => {
            let side = Side::of_shape(app, collection, &id, budget)?;
            (id, side)
        }
        _ => return Err(CompareParams::not_two()),
    };
    let b = Side::of_shape(app, collection, &params.b, budget)?;
    budget.check().map_err(ApiError::exceeded)?;
    let pair = ShapePair::new(ShapeMetric::default(), [a.shape(), b.shape()]);
    let (comparison, triangulation, overlay) = match (a.measured(), b.measured()) {
        (Some(a), Some(b)) => {
            let surfaces = [(&a.surface, &a.form), (&b.surface, &b.form)];
            let SurfaceComparison { comparison, triangulation, overlay } =
                compare_surfaces(&pair, pair.distance(), surfaces)?;
            (comparison, Some(triangulation), overlay)
        }
        _ => (canonform::compare(&pair)?, None, Overlay::new(&pair, [a.form(), b.form()])?),
    };
    let geometries = [&a, &b].map(|side| side.measured().and_then(|measured| measured.geometry.as_ref()));
    let evidence = match geometries {
        [Some(a), Some(b)] => MatchEvidence::new([a, b], comparison.verdict),
        _ => MatchEvidence::of_shapes([a.content(), b.content()].map(Some), comparison.verdict),
    };
    let dot = a.form().spread();
    Ok(Answer {
        evidence: evidence.named(&name, &params.b),
        a: name,
        b: params.b,
        comparison,
        triangulation,
        residual: overlay.residual(),
        forms: [overlaid(&overlay, 0, a.measured(), dot), overlaid(&overlay, 1, b.measured(), dot)],
    })
}
