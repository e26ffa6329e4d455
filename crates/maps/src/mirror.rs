//! Maps of a surface to itself.

use base::Budget;
use descriptors::DescriptorError;

use crate::known::KnownMap;
use crate::params::MapParams;
use crate::score::Scored;
use crate::search::MapSearch;
use crate::shape::{MapShape, Mirrors};
use crate::surface_map::MapKind;

impl MapShape {
    /// The mirrors of the surface, which are sought once, with the default parameters.
    pub(crate) fn mirrors(&self, budget: &Budget) -> Result<&Mirrors, DescriptorError> {
        if let Some(found) = self.found_mirrors.get() {
            return Ok(found);
        }
        let (known, params) = (KnownMap::default(), MapParams::default());
        let search = MapSearch { shapes: [self; 2], known: &known, params: &params, budget };
        let is_mirrored = |found: &Scored| found.kind() == MapKind::Mirrored;
        let starts = search.starts(&[-1.0])?.into_iter().filter(is_mirrored).map(|start| start.functional);
        let mut found = search.sketched(&search.stage(1), starts)?;
        // Bodies in different poses have distortions of .02 to .04.
        found.retain(|found| is_mirrored(found) && found.distortion < params.same);
        let least = params.least_agreement(&found);
        found.retain(|found| !found.is_mixture(least));
        let mut found = params.distinct(found);
        found.truncate(2);
        // The mean distance of the landmarks from their images. Points of front and back are on one limb: the mirror of built-in
        // people moves them by .06 to .07, and that of left and right by .18 and more, of cats.
        let moved = |found: &Scored| found.to_images.diagonal().mean();
        let sides = found.iter().position(|found| moved(found) > 2.0 * params.same);
        let sides = sides.map(|i| found.remove(i).functional);
        let others = found.into_iter().map(|found| found.functional).collect();
        // If another thread was faster, it found the same.
        Ok(self.found_mirrors.get_or_init(|| Mirrors { sides, others }))
    }
}
