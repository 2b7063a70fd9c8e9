//! The paths of light through a lens: straight on, or as a ghost with two reflections.

use super::lens::Lens;

/// A ghost: light goes forward, is reflected at `first`, runs back, is reflected at `second` (which lies before it), and
/// goes on to the sensor. Indices into the lens's surfaces, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ghost {
    /// Where it is reflected first.
    pub first: usize,
    /// Where it is reflected next, nearer the front.
    pub second: usize,
}

/// One meeting with a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Index of the surface.
    pub surface: usize,
    /// Whether the light comes from the front.
    pub forward: bool,
    /// Whether it is reflected there.
    pub reflects: bool,
}

/// All meetings in order; without a ghost, the path of the image.
pub fn path(surfaces: usize, ghost: Option<Ghost>) -> Vec<Step> {
    let step = |forward, reflects| {
        move |surface| Step {
            surface,
            forward,
            reflects,
        }
    };
    let Some(Ghost { first, second }) = ghost else {
        return (0..surfaces).map(step(true, false)).collect();
    };
    let mut steps: Vec<Step> = (0..first).map(step(true, false)).collect();
    steps.push(step(true, true)(first));
    steps.extend((second + 1..first).rev().map(step(false, false)));
    steps.push(step(false, true)(second));
    steps.extend((second + 1..surfaces).map(step(true, false)));
    steps
}

/// How often a path crosses the stop: 1, or 3 when its reflections lie on either side.
pub fn crossings(lens: &Lens, ghost: Option<Ghost>) -> usize {
    path(lens.surfaces.len(), ghost)
        .iter()
        .filter(|step| step.surface == lens.stop)
        .count()
}

/// Every pair of surfaces that reflect, the first reflection in rising order (Lee & Eisemann 2013, section 3).
pub fn ghosts(lens: &Lens) -> Vec<Ghost> {
    let mirrors: Vec<usize> = (0..lens.surfaces.len())
        .filter(|&surface| lens.reflects(surface))
        .collect();
    let below = |first: usize| mirrors.iter().copied().filter(move |&second| second < first);
    mirrors
        .iter()
        .flat_map(|&first| below(first).map(move |second| Ghost { first, second }))
        .collect()
}

/// The ghosts that cross the stop once: those that are drawn (others pass it three times and are mostly cut off).
pub fn single_crossing_ghosts(lens: &Lens) -> Vec<Ghost> {
    ghosts(lens)
        .into_iter()
        .filter(|&ghost| crossings(lens, Some(ghost)) == 1)
        .collect()
}
