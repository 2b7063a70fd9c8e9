//! Streets by recursive splitting: every cut is a street, what is left between the streets is a block.

use glam::DVec2;

use super::landscape::{CASTLE, CENTRE, density, river_distance, river_half_width, slope};
use super::noise::Chance;
use super::shapes::{Ring, area, centre, left_of, longest_direction, rectangle, without_short_edges};

/// What stands on a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockKind {
    /// The market square with the great church.
    Square,
    /// The castle.
    Castle,
    /// Houses wall to wall round courtyards.
    Perimeter,
    /// Rows of narrow houses.
    Terraces,
    /// Houses in gardens.
    Villas,
    /// Blocks of flats on lawns.
    Towers,
    /// Workshops and sheds.
    Works,
    /// Trees and lawns.
    Park,
}

/// A block between streets.
#[derive(Clone, Debug)]
pub struct Block {
    /// Convex outline.
    pub ring: Ring,
    /// What stands on it.
    pub kind: BlockKind,
    /// How urban it is, 0 to 1.
    pub urban: f64,
}

/// All blocks of the town.
pub fn blocks() -> Vec<Block> {
    let mut chance = Chance::new(1);
    let whole = rectangle(
        CENTRE + DVec2::new(20.0, -10.0),
        DVec2::from_angle(0.14),
        2050.0,
        1560.0,
    );
    let mut rings = Vec::new();
    split(whole, 0, &density, (&mut chance, &mut rings));
    rings.retain(is_buildable);
    let nearest = |to: DVec2| {
        let by_distance = |ring: &Ring| centre(ring).distance(to);
        (0..rings.len()).min_by(|&a, &b| by_distance(&rings[a]).total_cmp(&by_distance(&rings[b])))
    };
    let (square, castle) = (nearest(CENTRE), nearest(CASTLE));
    let mut kinds = Vec::new();
    for (index, ring) in rings.iter().enumerate() {
        kinds.push(if Some(index) == castle {
            BlockKind::Castle
        } else if Some(index) == square {
            BlockKind::Square
        } else {
            kind_of(ring, &mut chance)
        });
    }
    rings
        .into_iter()
        .zip(kinds)
        .map(|(ring, kind)| Block {
            urban: density(centre(&ring)),
            ring,
            kind,
        })
        .collect()
}

/// Cuts a ring into blocks, the larger the less urban (`urban`: 0 to 1) the place is.
pub fn split(
    ring: Ring,
    depth: u32,
    urban: &dyn Fn(DVec2) -> f64,
    (chance, leaves): (&mut Chance, &mut Vec<Ring>),
) {
    let centre = centre(&ring);
    let wanted = 2900.0 + 6200.0 * (1.0 - urban(centre)).powf(1.4);
    if ring.len() < 3 || area(&ring) < wanted * chance.between(0.75, 1.35) {
        leaves.push(without_short_edges(&ring, 4.0));
        return;
    }
    let bend = chance.between(-0.13, 0.13);
    let across = longest_direction(&ring).rotate(DVec2::from_angle(std::f64::consts::FRAC_PI_2 + bend));
    let shift = longest_direction(&ring) * chance.between(-0.12, 0.12) * area(&ring).sqrt();
    let half_street = match depth {
        0..=2 => 8.0,
        3..=5 => 5.5,
        _ => 3.6,
    };
    let through = centre + shift;
    let aside = across.perp() * half_street;
    let halves = [
        left_of(&ring, through + aside, across),
        left_of(&ring, through - aside, -across),
    ];
    for half in halves {
        split(half, depth + 1, urban, (&mut *chance, &mut *leaves));
    }
}

fn is_buildable(ring: &Ring) -> bool {
    let centre = centre(ring);
    let dry = ring
        .iter()
        .all(|&p| river_distance(p).abs() > river_half_width(p) + 17.0)
        && ring
            .windows(2)
            .all(|pair| river_distance(pair[0]) * river_distance(pair[1]) > 0.0);
    ring.len() >= 3 && area(ring) > 350.0 && dry && density(centre) > 0.06 && slope(centre) < 0.34
}

fn kind_of(ring: &Ring, chance: &mut Chance) -> BlockKind {
    let centre = centre(ring);
    let urban = density(centre);
    let flat = slope(centre) < 0.07;
    if centre.x > 1640.0 && flat && urban < 0.5 && chance.happens(0.55) {
        return BlockKind::Works;
    }
    if chance.happens(0.045) {
        return BlockKind::Park;
    }
    if centre.x < 800.0 && flat && urban < 0.55 && chance.happens(0.30) {
        return BlockKind::Towers;
    }
    match urban + chance.between(-0.08, 0.08) {
        u if u > 0.52 => BlockKind::Perimeter,
        u if u > 0.30 && chance.happens(0.6) => BlockKind::Terraces,
        _ => BlockKind::Villas,
    }
}
