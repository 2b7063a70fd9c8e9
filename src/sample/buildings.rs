//! What stands on each kind of block.

use glam::DVec2;

use super::blocks::{Block, BlockKind};
use super::features::{SampleBuilding, Tree};
use super::landscape::{ground, river_half_width, river_point, water_level};
use super::noise::Chance;
use super::shapes::{Ring, area, centre, edges, longest_direction, rectangle, round, set_back};

/// Height of a storey, metres.
const STOREY_M: f64 = 3.1;

fn house(ring: Ring, storeys: u32, extra_m: f64, kind: &'static str, ridge: Option<DVec2>) -> SampleBuilding {
    SampleBuilding {
        ring,
        holes: Vec::new(),
        height_m: (10.0 * (f64::from(storeys) * STOREY_M + extra_m)).round() / 10.0,
        storeys,
        kind,
        ridge,
    }
}

/// Fills a block.
pub fn build(block: &Block, chance: &mut Chance, buildings: &mut Vec<SampleBuilding>, trees: &mut Vec<Tree>) {
    match block.kind {
        BlockKind::Square => square(&block.ring, buildings, trees),
        BlockKind::Castle => castle(&block.ring, buildings, trees, chance),
        BlockKind::Perimeter => perimeter(block, chance, buildings, trees),
        BlockKind::Terraces => row_houses(&block.ring, chance, buildings, trees),
        BlockKind::Villas => villas(&block.ring, chance, buildings, trees),
        BlockKind::Towers => towers(&block.ring, chance, buildings, trees),
        BlockKind::Works => works(&block.ring, chance, buildings),
        BlockKind::Park => grove(&block.ring, 46.0, chance, trees),
    }
}

/// Trees scattered over a block, one per so many square metres.
fn grove(ring: &Ring, square_metres: f64, chance: &mut Chance, trees: &mut Vec<Tree>) {
    let Some(inner) = set_back(ring, 3.5) else { return };
    let (low, high) = inner.iter().fold((DVec2::MAX, DVec2::MIN), |(low, high), &p| {
        (low.min(p), high.max(p))
    });
    let count = ((high - low).element_product() / square_metres) as usize;
    for _ in 0..count {
        let at = DVec2::new(chance.between(low.x, high.x), chance.between(low.y, high.y));
        let inside = edges(&inner).all(|(a, b)| (b - a).perp_dot(at - a) > 0.0);
        let radius = chance.between(2.0, 4.6);
        if inside {
            trees.push(Tree { at, radius });
        }
    }
}

/// Parcels along every edge of a block: the quadrilateral from the street to `depth` behind it, its party walls shared
/// with the neighbours, and the direction of the street.
fn parcels(ring: &Ring, depth: f64, width: f64, chance: &mut Chance) -> Vec<(Ring, DVec2)> {
    let Some(inner) = set_back(ring, depth) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for ((a, b), (c, d)) in edges(ring).zip(edges(&inner)) {
        let count = ((b - a).length() / (width * chance.between(0.85, 1.2)))
            .round()
            .max(1.0) as usize;
        let mut cuts: Vec<f64> = (0..=count).map(|k| k as f64 / count as f64).collect();
        for cut in cuts.iter_mut().skip(1).take(count.saturating_sub(1)) {
            *cut += chance.between(-0.18, 0.18) / count as f64;
        }
        for pair in cuts.windows(2) {
            let outer = |t: f64| a.lerp(b, t);
            let back = |t: f64| c.lerp(d, t);
            let quad = vec![outer(pair[0]), outer(pair[1]), back(pair[1]), back(pair[0])];
            found.push((quad, (b - a).normalize_or(DVec2::X)));
        }
    }
    found
}

fn perimeter(
    Block { ring, urban, .. }: &Block,
    chance: &mut Chance,
    buildings: &mut Vec<SampleBuilding>,
    trees: &mut Vec<Tree>,
) {
    let usual = if *urban > 0.8 { 4.4 } else { 3.4 };
    let depth = chance.between(10.5, 13.0);
    let found = parcels(ring, depth, 11.5, chance);
    let has_yard = set_back(ring, depth).is_some_and(|inner| area(&inner) > 160.0);
    if found.is_empty() || !has_yard {
        // Too small for a courtyard: one palace, with a light well where there is room.
        let storeys = chance.between(2.6, 5.4) as u32;
        let mut palace = house(
            ring.clone(),
            storeys,
            0.8,
            "palace",
            Some(longest_direction(ring)),
        );
        palace.holes = set_back(ring, 8.0)
            .filter(|hole| area(hole) > 60.0)
            .into_iter()
            .collect();
        if !palace.holes.is_empty() {
            palace.ridge = None;
        }
        buildings.push(palace);
        return;
    }
    for (quad, street) in found {
        if chance.happens(0.035) {
            continue; // a gap in the row
        }
        let storeys = (usual + chance.between(-1.4, 1.3)).round().max(2.0) as u32;
        buildings.push(house(
            quad,
            storeys,
            chance.between(0.0, 1.1),
            "town house",
            Some(street),
        ));
    }
    if let Some(yard) = set_back(ring, depth + 4.0) {
        if area(&yard) > 500.0 && chance.happens(0.6) {
            let annex = rectangle(centre(&yard), longest_direction(&yard), 14.0, 7.0);
            buildings.push(house(annex, 1, 0.6, "workshop", None));
        }
        grove(&yard, 160.0, chance, trees);
    }
}

fn row_houses(ring: &Ring, chance: &mut Chance, buildings: &mut Vec<SampleBuilding>, trees: &mut Vec<Tree>) {
    let Some(front) = set_back(ring, 4.0) else { return };
    let storeys = if chance.happens(0.5) { 2 } else { 3 };
    for (a, b) in edges(&front) {
        let length = (b - a).length();
        let street = (b - a).normalize_or(DVec2::X);
        if length < 30.0 {
            continue;
        }
        // Rows stop short of the corners.
        let count = ((length - 22.0) / 6.6) as usize;
        for k in 0..count {
            let along = 11.0 + 6.6 * (k as f64 + 0.5);
            let step = 0.9 * f64::from(u8::from(k % 4 == 2));
            let centre = a + street * along + street.perp() * (4.8 + step);
            buildings.push(house(
                rectangle(centre, street, 6.6, 9.6),
                storeys,
                0.4,
                "terrace",
                Some(street),
            ));
        }
    }
    if let Some(gardens) = set_back(ring, 17.0) {
        grove(&gardens, 90.0, chance, trees);
    }
}

fn villas(ring: &Ring, chance: &mut Chance, buildings: &mut Vec<SampleBuilding>, trees: &mut Vec<Tree>) {
    for (quad, street) in parcels(ring, 24.0, 19.0, chance) {
        if area(&quad) < 190.0 || chance.happens(0.1) {
            continue;
        }
        let centre = centre(&quad) + street.perp() * chance.between(-2.0, 1.0);
        let turned = street.rotate(DVec2::from_angle(chance.between(-0.09, 0.09)));
        let (length, width) = (chance.between(9.0, 13.0), chance.between(7.5, 9.5));
        let storeys = chance.between(1.0, 3.4) as u32;
        let extra = chance.between(0.2, 1.4);
        if chance.happens(0.3) {
            // An L: a wing across the main house.
            let (u, v) = (turned * (0.5 * length), turned.perp() * (0.5 * width));
            let wing = turned.perp() * chance.between(3.0, 5.0);
            let ell = vec![
                centre - u - v,
                centre + u - v,
                centre + u + v + wing,
                centre + 0.1 * u + v + wing,
                centre + 0.1 * u + v,
                centre - u + v,
            ];
            buildings.push(house(ell, storeys, extra, "villa", Some(turned)));
        } else {
            buildings.push(house(
                rectangle(centre, turned, length, width),
                storeys,
                extra,
                "villa",
                Some(turned),
            ));
        }
        if chance.happens(0.3) {
            let shed = centre + street * 0.5 * (length + 7.0) + street.perp() * 3.0;
            buildings.push(house(rectangle(shed, turned, 5.2, 3.4), 1, -0.5, "garage", None));
        }
        for _ in 0..2 {
            let at = centre
                + DVec2::from_angle(chance.between(0.0, std::f64::consts::TAU)) * chance.between(8.5, 11.5);
            trees.push(Tree {
                at,
                radius: chance.between(1.6, 3.6),
            });
        }
    }
    if let Some(gardens) = set_back(ring, 26.0) {
        grove(&gardens, 70.0, chance, trees);
    }
}

fn towers(ring: &Ring, chance: &mut Chance, buildings: &mut Vec<SampleBuilding>, trees: &mut Vec<Tree>) {
    let direction = longest_direction(ring);
    let centre = centre(ring);
    if chance.happens(0.5) {
        let storeys = chance.between(8.0, 14.0) as u32;
        buildings.push(house(
            rectangle(centre, direction, 21.0, 19.0),
            storeys,
            1.5,
            "tower",
            None,
        ));
        let lift = rectangle(centre, direction, 6.0, 5.0);
        buildings.push(house(lift, storeys, 5.0, "lift house", None));
    } else {
        for side in [-1.0, 1.0] {
            let at = centre + direction.perp() * side * 17.0;
            let slab = rectangle(at, direction, 46.0, 12.0);
            buildings.push(house(slab, chance.between(4.0, 7.0) as u32, 0.8, "slab", None));
        }
    }
    grove(ring, 240.0, chance, trees);
}

fn works(ring: &Ring, chance: &mut Chance, buildings: &mut Vec<SampleBuilding>) {
    let direction = longest_direction(ring);
    let Some(yard) = set_back(ring, 7.0) else { return };
    let size = area(&yard).sqrt();
    let hall = rectangle(
        centre(&yard) + direction.perp() * 0.16 * size,
        direction,
        0.9 * size,
        0.42 * size,
    );
    buildings.push(house(hall, 1, chance.between(4.5, 8.0), "hall", Some(direction)));
    for k in 0..3 {
        let at =
            centre(&yard) - direction.perp() * 0.30 * size + direction * (f64::from(k) - 1.0) * 0.3 * size;
        let shed = rectangle(at, direction, 0.22 * size, 0.18 * size);
        buildings.push(house(shed, 1, chance.between(0.5, 3.0), "shed", None));
    }
    if chance.happens(0.35) {
        let silo = round(centre(&yard) + direction * 0.52 * size, 5.0, 20);
        buildings.push(house(silo, 1, 17.0, "silo", None));
    }
}

fn square(ring: &Ring, buildings: &mut Vec<SampleBuilding>, trees: &mut Vec<Tree>) {
    let nave = longest_direction(ring);
    let centre = centre(ring);
    let across = nave.perp();
    // A church: nave, transept and apse are one cross; the bell tower stands beside it.
    let at = |u: f64, v: f64| centre + nave * u + across * v;
    let mut cross = vec![
        at(-24.0, -6.5),
        at(4.0, -6.5),
        at(4.0, -13.0),
        at(14.0, -13.0),
        at(14.0, -6.5),
        at(20.0, -6.5),
    ];
    cross.extend((0..=8).map(|k| {
        let turn = (f64::from(k) / 8.0 - 0.5) * std::f64::consts::PI;
        at(20.0 + 6.5 * turn.cos(), 6.5 * turn.sin())
    }));
    cross.extend([
        at(20.0, 6.5),
        at(14.0, 6.5),
        at(14.0, 13.0),
        at(4.0, 13.0),
        at(4.0, 6.5),
        at(-24.0, 6.5),
    ]);
    cross.dedup_by(|a, b| a.distance(*b) < 0.01);
    buildings.push(house(cross, 1, 14.5, "church", Some(nave)));
    buildings.push(house(
        rectangle(at(-21.0, 11.5), nave, 7.0, 7.0),
        1,
        38.0,
        "bell tower",
        None,
    ));
    buildings.push(house(
        round(at(9.0, 0.0), 6.0, 24),
        1,
        23.0,
        "crossing dome",
        None,
    ));
    if let Some(edge) = set_back(ring, 4.0) {
        for (a, b) in edges(&edge) {
            let count = ((b - a).length() / 11.0) as usize;
            trees.extend((0..count).map(|k| Tree {
                at: a.lerp(b, k as f64 / count as f64),
                radius: 2.6,
            }));
        }
    }
}

fn castle(ring: &Ring, buildings: &mut Vec<SampleBuilding>, trees: &mut Vec<Tree>, chance: &mut Chance) {
    let direction = longest_direction(ring);
    let centre = centre(ring);
    let outer = rectangle(centre, direction, 52.0, 40.0);
    let mut keep = house(outer.clone(), 3, 2.5, "castle", None);
    keep.holes = set_back(&outer, 9.0).into_iter().collect();
    buildings.push(keep);
    for (k, corner) in outer.iter().enumerate() {
        buildings.push(house(
            round(*corner, 6.5, 20),
            4,
            3.0 + k as f64,
            "castle tower",
            None,
        ));
    }
    buildings.push(house(
        rectangle(centre + direction * 20.0, direction, 11.0, 11.0),
        7,
        6.0,
        "keep",
        None,
    ));
    grove(ring, 150.0, chance, trees);
}

/// Two bridges: decks over the river from bank to bank.
pub fn bridges(buildings: &mut Vec<SampleBuilding>) {
    for x in [1015.0, 1490.0] {
        let centre = river_point(x);
        let flow = (river_point(x + 1.0) - river_point(x - 1.0)).normalize_or(DVec2::X);
        let span = 2.0 * (river_half_width(centre) + 14.0);
        let deck = rectangle(centre, flow.perp(), span, 9.0);
        let bank = deck.iter().map(|&p| ground(p)).fold(f64::NEG_INFINITY, f64::max);
        let lowest = deck.iter().map(|&p| ground(p)).fold(f64::INFINITY, f64::min);
        let deck_level = bank.max(water_level(centre) + 4.0) + 0.3;
        let mut bridge = house(deck, 1, 0.0, "bridge", None);
        bridge.height_m = (10.0 * (deck_level - lowest)).round() / 10.0;
        buildings.push(bridge);
    }
}
