//! Searching several indexes as one: a query goes to each, and their answers are merged.

use relations::RelationKind;

use super::agreement::Agreement;
use super::found::Hit;
use super::predict::{n_results, predicted};
use super::query::Query;
use super::search::Answer;

/// The answer of one index that holds the shapes of several, from the answers of these to one query: its `k` best results and
/// its class. `classes` are those [of all of them](Agreement::of_indexes), which each was asked with.
///
/// Each must have been asked for [`n_results`] results at least. Explanations are not merged.
pub fn merge_answers(query: &Query, answers: Vec<Answer>, classes: Option<Agreement>, k: usize) -> Answer {
    let mut merged = Answer { recall: 1.0, ..Answer::default() };
    for answer in answers {
        merged.rank_by = answer.rank_by;
        merged.n_shapes += answer.n_shapes;
        merged.measured += answer.measured;
        merged.aligned += answer.aligned;
        merged.unread += answer.unread;
        merged.results.extend(answer.results);
    }
    merged.results.sort_by(Hit::cmp);
    merged.results.truncate(n_results(k));
    let classes = classes.map(|agreement| agreement.classes());
    for (hit, rank) in merged.results.iter_mut().zip(1..) {
        let evidence = &hit.relation.evidence;
        // Of other shapes, their distance says no less than this.
        let may_be_parts = hit.relation.kind == RelationKind::SameClass;
        let numbers = (evidence.distance, evidence.scale);
        hit.relation = Hit::by_descriptions(numbers, may_be_parts, hit.order, classes);
        hit.relation = hit.relation.clone().named(&query.name, &hit.id);
        hit.rank = rank;
    }
    merged.predicted = predicted(&merged.results, classes, &query.shape.entry.facts);
    merged.results.truncate(k);
    merged
}

/// How many shapes with the nearest fused vectors are candidates for `k` results, where only vectors are searched.
pub fn n_candidates(k: usize) -> usize {
    n_results(k).saturating_mul(CANDIDATES).max(LEAST_CANDIDATES)
}

/// Candidates for each result, and for any number of results.
const CANDIDATES: usize = 4;
const LEAST_CANDIDATES: usize = 40;

#[cfg(test)]
mod tests {
    use mesh::shapes;

    use super::*;
    use crate::form::DescribeOptions;
    use crate::library::{BuildOptions, Shard, build_index};
    use crate::search::{SearchOptions, SearchRank, ShapeSearch};

    /// The answer of some shards, as it is sent from other processes.
    fn asked(shards: &[ShapeSearch], query: &Query, rank_by: SearchRank, k: usize) -> Answer {
        let paths: Vec<_> = shards.iter().map(|shard| shard.index().path.clone()).collect();
        let classes = Agreement::of_indexes(&paths, &()).unwrap();
        assert!(classes.is_some());
        let options = SearchOptions { k: n_results(k), rank_by, classes, ..SearchOptions::default() };
        let answers = shards.iter().map(|shard| {
            let answer = shard.search(query, &options, &()).unwrap();
            // Among its own results and a name that it does not hold, a shard finds the same.
            let ids: Vec<String> =
                answer.results.iter().map(|hit| hit.id.clone()).chain(["gone".to_owned()]).collect();
            assert_eq!(shard.search_among(query, Some(&ids), &options, &()).unwrap().results, answer.results);
            serde_json::from_str(&serde_json::to_string(&answer).unwrap()).unwrap()
        });
        merge_answers(query, answers.collect(), classes, k)
    }

    #[test]
    fn shards_answer_as_one_index() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        // Thirty pairs of one class, and none of that many in a shard.
        for (i, size) in [0.7, 0.75, 0.8, 0.85, 0.9, 0.95].into_iter().enumerate() {
            mesh_io::write(&at(&format!("ring{i}.off")), &shapes::torus(20, 10, 2.0, size)).unwrap();
            mesh_io::write(&at(&format!("tube{i}.off")), &shapes::torus(30, 8, 4.0, size)).unwrap();
        }
        let describe_options = DescribeOptions::default();
        let built = |name: &str, shard| {
            let options = BuildOptions { shard, ..BuildOptions::new(&describe_options) };
            build_index(folder.path(), &at(name), &options, &()).unwrap();
            ShapeSearch::open(&at(name)).unwrap()
        };
        let whole = built("whole", None);
        let shards = [1, 2].map(|i| built(&format!("part{i}"), Some(Shard::new(i, 2).unwrap())));
        let mut scaled = whole.mesh("ring0").unwrap();
        scaled.positions.iter_mut().for_each(|p| p.coords *= 25.4);
        let explained = SearchOptions { explain: true, ..SearchOptions::default() };
        let queries = [&shapes::torus(22, 13, 1.0, 0.36), &scaled]
            .map(|mesh| whole.query(mesh, ("the query", None), &explained, &()).unwrap());
        let queries = queries.into_iter().chain([whole.query_of("ring1", &explained, &()).unwrap()]);
        for query in queries {
            let sent: Query = serde_json::from_str(&serde_json::to_string(&query).unwrap()).unwrap();
            assert_eq!((&sent.shape, &sent.name, &sent.options), (&query.shape, &query.name, &query.options));
            for (k, rank_by) in [
                (0, SearchRank::Plain),
                (2, SearchRank::Plain),
                (15, SearchRank::Plain),
                (2, SearchRank::Forms),
            ] {
                let options = SearchOptions { k, rank_by, ..Default::default() };
                let expected = whole.search(&query, &options, &()).unwrap();
                let found = asked(&shards, &sent, rank_by, k);
                let (aligned, seconds) = (expected.aligned, expected.seconds);
                assert_eq!(Answer { aligned, seconds, ..found }, expected);
            }
            // The mesh in space is sent with the query.
            let relation =
                |query: &Query| whole.search(query, &explained, &()).unwrap().results[0].relation.to_string();
            assert_eq!(relation(&query), relation(&sent));
        }
    }
}
