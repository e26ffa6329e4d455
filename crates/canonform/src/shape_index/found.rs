//! What a search found.

use std::cmp::Ordering;

use descriptors::{Boundary, ShapeDistance};
use serde::{Deserialize, Deserializer, Serialize};

use crate::compare::Comparison;
use relations::{Relation, RelationKind};
use rigid::Handedness;

/// What a result is ordered by, unless it is its distance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum OrderedBy {
    /// Its place on the graph.
    Graph {
        /// Rank distance, from 0 to 1: by fused distance and by neighbors in common, see [`retrieval::graph_rank`].
        rank_distance: f64,
        /// Its rank by fused distance, counted from 1; `None` if it is found through its neighbors only.
        plain_rank: Option<usize>,
    },
    /// How well the query fits into it as a part.
    Part {
        /// Root mean square of the differences of logarithms of disc areas that no missing part explains; 0 if all fit. See
        /// [`descriptors::PartDiscAreas`].
        part_distance: f64,
        /// The share of the area of the shape that the query has if it fits best.
        part_share: f64,
    },
    /// How far its surface is from that of a query with noise, which comes before all that is not aligned.
    Surface {
        /// Root mean square distance in space, relative to the square root of the area.
        surface_gap: f64,
    },
    /// How much the forms alone differ.
    Forms {
        /// The distance by [`descriptors::SampledForm::spectrum`], in units of two poses of one body.
        form_distance: f64,
    },
}

impl OrderedBy {
    /// The number by which results ascend.
    pub fn distance(&self) -> f64 {
        match *self {
            Self::Graph { rank_distance, .. } => rank_distance,
            Self::Part { part_distance, .. } => part_distance,
            Self::Surface { surface_gap } => surface_gap,
            Self::Forms { form_distance } => form_distance,
        }
    }
}

/// A shape that was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hit {
    /// Counted from 1.
    pub rank: usize,
    /// Name of the shape.
    pub id: String,
    /// Its class.
    pub label: String,
    /// Whether it is the shape that the query is, which has no vote on its own class.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub itself: bool,
    /// Path of its mesh as the index states it; [`mesh_path`](crate::library::mesh_path) finds the file.
    pub path: String,
    /// Combined distance, by signatures and aligned forms; results are ordered by it if they are ranked
    /// plainly.
    pub distance: f64,
    /// Fused distance, by signatures alone.
    pub fused: f64,
    /// What results are ordered by if they are not ranked plainly.
    #[serde(flatten)]
    pub order: Option<OrderedBy>,
    /// How the query and the shape are related: by descriptions and, if results are explained, by files and meshes. The
    /// handedness is unknown. Of what is read from JSON, only the kind and the distances are there.
    #[serde(deserialize_with = "recorded")]
    pub relation: Relation,
    /// The numbers of the comparison with the query, if results are explained.
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Comparison>,
}

/// The distance and the kind of the relation that a record states.
fn recorded<'de, D: Deserializer<'de>>(from: D) -> Result<Relation, D::Error> {
    #[derive(Deserialize)]
    struct Record {
        kind: RelationKind,
        because: Numbers,
    }
    #[derive(Deserialize)]
    struct Numbers {
        #[serde(flatten)]
        distance: ShapeDistance,
        scale: f64,
    }
    let Record { kind, because: Numbers { distance, scale } } = Record::deserialize(from)?;
    let mut relation = Relation::by_distance(distance, scale, Handedness::Unknown);
    relation.kind = kind;
    Ok(relation)
}

impl Hit {
    /// How a query and a shape are related by their descriptions. Parts of machines do not bend.
    pub(super) fn by_descriptions(
        (distance, scale): (ShapeDistance, f64),
        are_parts: bool,
        order: Option<OrderedBy>,
        classes: Option<Boundary>,
    ) -> Relation {
        // A part differs from shapes of its own class, too.
        let classes = classes.filter(|_| !matches!(order, Some(OrderedBy::Part { .. })));
        let relation = Relation::in_classes(distance, scale, Handedness::Unknown, classes);
        if are_parts { relation.without_poses() } else { relation }
    }

    /// What shapes are ordered by before anything else: how far their surface is from that of the query, if it is known.
    pub(super) fn surface_gap(&self) -> f64 {
        match self.order {
            Some(OrderedBy::Surface { surface_gap }) => surface_gap,
            _ => f64::INFINITY,
        }
    }

    /// The order in which one index would have met shapes of several.
    pub(super) fn cmp(&self, other: &Self) -> Ordering {
        let key = |x: &Self| {
            let [first, second] = x.order.map_or([x.distance, x.fused], |order| [order.distance(), 0.0]);
            [x.surface_gap(), first, second]
        };
        let numbers = key(self).into_iter().zip(key(other)).map(|(a, b)| a.total_cmp(&b));
        numbers.fold(Ordering::Equal, Ordering::then).then_with(|| self.id.cmp(&other.id))
    }
}

/// One of the components of a query, or several copies of one, and the shape nearest to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComponentResult {
    /// Copies of the component in the query.
    pub copies: usize,
    /// The share of the surface of one copy.
    pub area_share: f64,
    /// Vertices of one copy.
    pub n_vertices: usize,
    /// The nearest shape of the index, and how it is related.
    pub nearest: Option<Hit>,
}
