//! Groups of shapes of an index that are one: copies of a file, and the same surface in another place, size or
//! triangulation.
//!
//! ```text
//! equal bytes -> fused vectors -> near pairs -> invariants -> clusters -> meshes -> keeper, and what is proved to be the keeper
//! ```

mod candidates;
mod groups;
mod options;
mod places;
mod report;

pub use options::{DuplicateOptions, Keep};
pub(in crate::shape_index) use places::has_one_name;
pub use report::{DuplicateFile, DuplicateGroup, DuplicateMember, DuplicateReport};

use std::time::Instant;

use base::Observer;
use rayon::prelude::*;

use self::candidates::Clusters;
use self::groups::{ClusterShape, groups};
use self::places::Places;
use super::search::ShapeSearch;
use crate::error::Error;

/// Finds the duplicates of an index. Signatures choose which meshes are compared, and their geometry decides: every member
/// of a group is proved against its keeper. Nothing is changed.
///
/// ```
/// use canonform::{DescribeOptions, mesh};
/// use canonform::library::{BuildOptions, DuplicateOptions, build_index, find_duplicates};
/// use canonform::relations::RelationKind;
/// use canonform::search::ShapeSearch;
///
/// let folder = tempfile::tempdir()?;
/// let mut ring = mesh::shapes::torus(24, 12, 2.0, 0.7);
/// mesh::io::write(&folder.path().join("ring.off"), &ring)?;
/// mesh::io::write(&folder.path().join("ball.off"), &mesh::shapes::icosphere(2))?;
/// ring.positions.iter_mut().for_each(|p| *p *= 25.4);
/// mesh::io::write(&folder.path().join("ring-mm.ply"), &ring)?;
/// let index = folder.path().join("shapes.canonform");
/// let describe = DescribeOptions::default();
/// build_index(folder.path(), &index, &BuildOptions::new(&describe), &())?;
///
/// let found = find_duplicates(&ShapeSearch::open(&index)?, &DuplicateOptions::default(), &())?;
/// assert_eq!((found.groups.len(), found.groups[0].members[0].relation.kind), (1, RelationKind::Scaled));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::Index`], [`Error::Exceeded`].
pub fn find_duplicates(
    search: &ShapeSearch,
    options: &DuplicateOptions,
    observer: &dyn Observer,
) -> Result<DuplicateReport, Error> {
    let start = Instant::now();
    let places = Places::new(search, options)?;
    let Clusters { candidates, clusters, unread } = Clusters::new(search, options, observer)?;
    observer.begin("comparing", clusters.iter().map(Vec::len).sum());
    let found = clusters
        .par_iter()
        .map(|cluster| {
            let read = |&number: &usize| ClusterShape::read(&candidates[number], &places);
            groups(cluster.par_iter().map(read).collect(), &places, options, observer)
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let n_compared = found.iter().map(|(_, n_compared)| n_compared).sum();
    let mut groups: Vec<DuplicateGroup> = found.into_iter().flat_map(|(groups, _)| groups).collect();
    // Nothing is suggested about files in references alone.
    groups
        .retain(|group| !group.keeper.reference || group.members.iter().any(|member| !member.file.reference));
    groups.sort_by(|a, b| b.members.len().cmp(&a.members.len()).then(a.keeper.id.cmp(&b.keeper.id)));
    let (n_shapes, seconds) = (search.index().len(), start.elapsed().as_secs_f64());
    Ok(DuplicateReport { n_shapes, n_compared, groups, unread, seconds })
}
