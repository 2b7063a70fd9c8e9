//! The one traversal on the CPU, function for function `shaders/lib/march.wgsl` (whose two nested loops, made for
//! lanes in step, are one here): for counting reads, picking, and the test that compares the two. f32 like the shader.

use glam::{IVec2, Vec2, Vec3, Vec3Swizzles};

use super::GridPosition;
use super::constants::{MAX_STEPS, SLACK};
use crate::buildings::{Block, BuildingMap, CellKind, MapTile, Pyramid};
use crate::scene::TileSet;

/// A ray from an eye-relative start.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Start, metres from the eye.
    pub start: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    pub(super) inverse: Vec2,
}

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Metres along the ray.
    pub t: f32,
    /// Index of the building in its tile.
    pub building: u32,
    /// First vertex of the wall, none for a roof.
    pub edge: Option<u32>,
    /// Facade coordinate: bays along the outline, 0 on a roof.
    pub bays: f32,
    /// Id of the building.
    pub fid: u32,
    /// Outward normal of the wall, a unit vector in plan; none for a roof.
    pub wall_normal: Option<Vec2>,
}

/// What is seen along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// Metres along the ray.
    pub t: f32,
    /// Id of the building, 0 for the ground.
    pub fid: u32,
}

/// A ray in a tile.
#[derive(Clone, Copy, Debug)]
pub struct LocalRay<'a> {
    /// The ray.
    pub ray: &'a Ray,
    /// Its start, metres from the tile's south-west corner.
    pub start: Vec2,
    /// The height that `ray.start.z` counts from, metres.
    pub eye_elevation: f32,
}

impl Ray {
    /// A ray; directions across an axis are nudged off the plane by a nanometre a metre.
    pub fn new(start: Vec3, direction: Vec3) -> Self {
        let nudge = |d: f32| {
            if d.abs() < 1e-9 {
                if d >= 0.0 { 1e-9 } else { -1e-9 }
            } else {
                d
            }
        };
        let direction = Vec3::new(nudge(direction.x), nudge(direction.y), nudge(direction.z));
        Self {
            start,
            direction,
            inverse: direction.xy().recip(),
        }
    }
}

/// Rounding of a hit's position along the ray, metres.
pub(super) fn slack(t: f32) -> f32 {
    SLACK[0] + SLACK[1] * t
}

/// First hit with the roofs and walls of one texel, between `t0` and `t1`. `reference`: the texel's point where its outline's parity
/// is known.
fn visit_cell(
    map: &BuildingMap,
    code: u32,
    reference: Vec2,
    local: &LocalRay<'_>,
    [t0, t1]: [f32; 2],
) -> Option<Hit> {
    let LocalRay {
        ray,
        start,
        eye_elevation,
    } = *local;
    let mut best: Option<Hit> = None;
    let best_t = |best: &Option<Hit>| best.map_or(f32::INFINITY, |hit| hit.t);
    let from_t = t0 - slack(t0);
    let to_t = t1 + slack(t1);
    let single = [code];
    let codes = match CellKind::from_code(code) {
        CellKind::List(_) => map.codes(code),
        _ => &single[..],
    };
    let mut codes = codes.iter();
    while let Some(&code) = codes.next() {
        let Some(building) = map.building_of(code) else {
            continue;
        };
        let record = &map.roofs[building as usize];
        let roof = record.roof_m - eye_elevation;
        let t_roof = (roof - ray.start.z) / ray.direction.z;
        let meets_roof =
            ray.direction.z < 0.0 && t_roof >= from_t && t_roof <= to_t && t_roof < best_t(&best);
        // A ray that stays above the roof can meet none of its walls.
        let dips = ray.start.z + (from_t * ray.direction.z).min(to_t * ray.direction.z) <= roof;
        let mut inside = match CellKind::from_code(code) {
            CellKind::Full(full) => full.is_shown(),
            CellKind::Run(run) => run.inside,
            _ => false,
        };
        if let CellKind::Run(mut run) = CellKind::from_code(code) {
            let p = start + t_roof * ray.direction.xy();
            let to_p = p - reference;
            loop {
                let vertex = |index: u32| {
                    let vertex = &map.vertices[index as usize];
                    Vec2::new(vertex.x_m, vertex.y_m)
                };
                let bays_at = |index: u32| map.vertices[index as usize].bays;
                let mut a = vertex(run.first);
                let edges = if dips { run.edges } else { 0 };
                for edge in run.first..run.first + edges {
                    let b = vertex(edge + 1);
                    let along = b - a;
                    // The building is to the left of its outline: the wall faces right.
                    let facing = ray.direction.xy().perp_dot(along);
                    if facing < 0.0 {
                        let t = (a - start).perp_dot(along) / facing;
                        let low_enough = ray.start.z + t * ray.direction.z <= roof;
                        if t >= from_t && t <= to_t && t < best_t(&best) && low_enough {
                            let u = (start + t * ray.direction.xy() - a).dot(along) / along.dot(along);
                            if (-1e-5..=1.00001).contains(&u) {
                                best = Some(Hit {
                                    t,
                                    building,
                                    edge: Some(edge),
                                    bays: bays_at(edge) + u * (bays_at(edge + 1) - bays_at(edge)),
                                    fid: record.fid,
                                    wall_normal: Some(Vec2::new(along.y, -along.x).normalize()),
                                });
                            }
                        }
                    }
                    if meets_roof {
                        let apart =
                            (to_p.perp_dot(a - reference) >= 0.0) != (to_p.perp_dot(b - reference) >= 0.0);
                        let between =
                            (along.perp_dot(reference - a) >= 0.0) != (along.perp_dot(p - a) >= 0.0);
                        inside = inside != (apart && between);
                    }
                    a = b;
                }
                let next = codes.as_slice().first().map(|&code| CellKind::from_code(code));
                match next {
                    Some(CellKind::Run(more)) if run.more => {
                        codes.next();
                        run = more;
                    }
                    _ => break,
                }
            }
        }
        if meets_roof && inside && t_roof < best_t(&best) {
            best = Some(Hit {
                t: t_roof,
                building,
                edge: None,
                bays: 0.0,
                fid: record.fid,
                wall_normal: None,
            });
        }
    }
    best
}

/// First hit with a column, the texel of a coarse level, between `t0` and `t1`. `corner`, `size`: its plan.
fn visit_column(
    map: &BuildingMap,
    code: u32,
    [corner, size]: [Vec2; 2],
    local: &LocalRay<'_>,
    [t0, t1]: [f32; 2],
) -> Option<Hit> {
    let LocalRay {
        ray,
        start,
        eye_elevation,
    } = *local;
    let CellKind::Full(full) = CellKind::from_code(code) else {
        return None;
    };
    let record = map
        .roofs
        .get(full.building as usize)
        .filter(|_| full.is_shown())?;
    let roof = record.roof_m - eye_elevation;
    let hit = |t: f32, wall_normal: Option<Vec2>| Hit {
        t,
        building: full.building,
        edge: None,
        bays: 0.0,
        fid: record.fid,
        wall_normal,
    };
    if ray.start.z + t0 * ray.direction.z <= roof {
        // The side that the ray came in by.
        let sign = ray.direction.xy().signum();
        let past = (start + t0 * ray.direction.xy() - corner) * sign;
        let deep = Vec2::select(sign.cmplt(Vec2::ZERO), past + size, past);
        let normal = if deep.x < deep.y {
            Vec2::new(-sign.x, 0.0)
        } else {
            Vec2::new(0.0, -sign.y)
        };
        return Some(hit(t0, Some(normal)));
    }
    let t_roof = (roof - ray.start.z) / ray.direction.z;
    (ray.direction.z < 0.0 && t_roof <= t1 + slack(t1)).then(|| hit(t_roof, None))
}

/// 1 along the axes on which the ray goes forward.
pub(super) fn lead(forward: [bool; 2]) -> Vec2 {
    Vec2::new(f32::from(u8::from(forward[0])), f32::from(u8::from(forward[1])))
}

/// The step to the next square along each axis.
pub(super) fn step(forward: [bool; 2]) -> IVec2 {
    IVec2::new(if forward[0] { 1 } else { -1 }, if forward[1] { 1 } else { -1 })
}

/// First hit within one tile of a level between `t0` and `t1`. Also counts the map's reads into `reads`.
fn walk_tile(
    tile: &MapTile,
    level: u32,
    local: &LocalRay<'_>,
    [t0, t1]: [f32; 2],
    reads: &mut u32,
) -> Option<Hit> {
    let LocalRay {
        ray,
        start,
        eye_elevation,
    } = *local;
    let (map, is_exact) = (&tile.map, level == 0);
    let forward = [ray.direction.x >= 0.0, ray.direction.y >= 0.0];
    let (step, lead) = (step(forward), lead(forward));
    // Begin with nodes about as large as the way to go: a short way need not come down from the tile's top.
    let texels = ray.direction.xy().length() * (t1 - t0) / map.texel_m;
    let top = Pyramid::top_level(map.side);
    let mut level = ((0.5 * texels.max(1.0).log2()).ceil() - 1.0).clamp(1.0, top as f32) as u32;
    let place = (start + t0 * ray.direction.xy()) / map.texel_m;
    let most = IVec2::splat(map.side as i32 - 1);
    let mut node = place.floor().as_ivec2().clamp(IVec2::ZERO, most) >> (2 * level + 2);
    let mut t = t0;
    // On level 0 the node is a block.
    let (mut block, mut codes, mut block_bound) = (Block::Empty, [0; 16], f32::NEG_INFINITY);
    for _ in 0..MAX_STEPS {
        let size = map.texel_m * (1_u32 << (2 * level)) as f32;
        *reads += 1;
        let rounding = slack(t);
        let place = (start + t * ray.direction.xy()) / size;
        let mut child = place.floor().as_ivec2().clamp(4 * node, 4 * node + 3);
        let mut t_border = ((child.as_vec2() + lead) * size - start) * ray.inverse;
        let t_step = size * ray.inverse.abs();
        let texel = |child: IVec2| ((child.y & 3) * 4 + (child.x & 3)) as usize;
        // The texels of a block count as high as the block.
        let bound_of = |child: IVec2| match level {
            0 if codes[texel(child)] == 0 => f32::NEG_INFINITY,
            0 => block_bound,
            _ => tile.pyramid.bound(level, child.x as usize, child.y as usize),
        };
        // Past the node's children, at most seven, to the first that the ray dips into.
        let dips = loop {
            let t_past = t_border.min_element().min(t1);
            let lowest = ray.start.z + (t * ray.direction.z).min(t_past * ray.direction.z);
            if t_past > t && lowest <= bound_of(child) - eye_elevation + rounding {
                break Some(t_past);
            }
            t = t.max(t_past);
            let axis = usize::from(t_border.x > t_border.y);
            child[axis] += step[axis];
            t_border[axis] += t_step[axis];
            if (child >> 2) != node || t >= t1 {
                break None;
            }
        };
        if let (Some(_), 1) = (dips, level) {
            block = map.block(child.x as usize, child.y as usize);
            codes = map.codes_in(block);
            block_bound = tile.pyramid.bound(1, child.x as usize, child.y as usize);
            *reads += 2;
        }
        let found = level == 0 || (level == 1 && matches!(block, Block::Uniform(_)));
        match dips {
            Some(t_past) if found => {
                let code = codes[if level == 0 { texel(child) } else { 0 }];
                *reads += 1;
                let corner = child.as_vec2();
                let hit = if is_exact {
                    let reference = (corner + Vec2::from_array(BuildingMap::REFERENCE)) * map.texel_m;
                    visit_cell(map, code, reference, local, [t, t_past])
                } else {
                    visit_column(map, code, [corner * size, Vec2::splat(size)], local, [t, t_past])
                };
                if hit.is_some() {
                    return hit;
                }
                t = t_past;
            }
            Some(_) => {
                level -= 1;
                node = child;
            }
            None => {
                let children = IVec2::splat((map.side >> (2 * level)).max(1) as i32);
                if t >= t1 || child.cmplt(IVec2::ZERO).any() || child.cmpge(children).any() {
                    break;
                }
                // Over to the next node, and up when that has another parent, or out of a block.
                let next = child >> 2;
                if level == 0 || (level < top && (next >> 2) != (node >> 2)) {
                    level += 1;
                    node = next >> 2;
                } else {
                    node = next;
                }
            }
        }
    }
    None
}

/// First hit with any building of the city between `t0` and `t1` along a ray whose start counts from `eye`.
pub fn walk_city(
    tiles: &TileSet,
    eye: &GridPosition,
    ray: &Ray,
    [t0, t1]: [f32; 2],
    reads: &mut u32,
) -> Option<Hit> {
    let grid = &tiles.grid;
    let forward = [ray.direction.x >= 0.0, ray.direction.y >= 0.0];
    let lead = lead(forward);
    let counts = IVec2::new(grid.columns as i32, grid.rows as i32);
    // Only the path through the city's volume: over its tiles and below its highest roof.
    let [t_in, t_past] = across_grid(tiles, eye, ray);
    let t_roofs = (tiles.bounds.max_roof - eye.elevation - ray.start.z) / ray.direction.z;
    let mut t = t0.max(t_in);
    let mut end = t1.min(t_past);
    if ray.direction.z > 0.0 {
        end = end.min(t_roofs);
    } else if ray.direction.z < 0.0 {
        t = t.max(t_roofs);
    }
    let mut tile = eye.tile_at(grid, ray.start.xy() + t * ray.direction.xy());
    for _ in 0..MAX_STEPS {
        if t >= end {
            break;
        }
        let (level, map) = tiles.map_over(tile);
        let first = tile_over(tile, level);
        let corner = eye.tile_corner(grid, first);
        let tile_m = grid.tile_m as f32 * (1_u32 << level) as f32;
        let t_border = (corner + lead * tile_m - ray.start.xy()) * ray.inverse;
        let t_out = t_border.min_element().min(end);
        if let Some(map) = map {
            *reads += 1;
            // Of the path through the tile only what lies between its lowest ground and its highest roof.
            let t_low = (map.pyramid.min_height() - eye.elevation - ray.start.z) / ray.direction.z;
            let t_high = (map.pyramid.max_height() - eye.elevation - ray.start.z) / ray.direction.z;
            let (t_first, t_last) = (t_low.min(t_high), t_low.max(t_high));
            let from_t = t.max(t_first - slack(t_first.abs()));
            let to_t = t_out.min(t_last + slack(t_last.abs()));
            if from_t <= to_t {
                let local = LocalRay {
                    ray,
                    start: ray.start.xy() - corner,
                    eye_elevation: eye.elevation,
                };
                let hit = walk_tile(map, level, &local, [from_t, to_t], reads);
                if let Some(hit) = hit.filter(|hit| hit.t <= end) {
                    return Some(hit);
                }
            }
        }
        t = t.max(t_out);
        let position = eye.tile_at(grid, ray.start.xy() + t * ray.direction.xy());
        tile = tile_past(first, level, position, ray, t_border);
        let gone = |axis: usize| {
            if forward[axis] {
                tile[axis] >= counts[axis]
            } else {
                tile[axis] < 0
            }
        };
        if gone(0) || gone(1) {
            break;
        }
    }
    None
}

/// The tile of a level over a tile of the grid, by its south-western one.
pub(super) fn tile_over(tile: IVec2, level: u32) -> IVec2 {
    (tile >> level) << level
}

/// The tile of the grid that a ray comes into as it leaves the tile of a level over `first`. `position`: the tile of the grid where
/// that is, `t_border`: how far the borders ahead are.
pub(super) fn tile_past(first: IVec2, level: u32, position: IVec2, ray: &Ray, t_border: Vec2) -> IVec2 {
    let last = first + (1 << level) - 1;
    let axis = usize::from(t_border.x > t_border.y);
    let mut tile = position.clamp(first, last);
    tile[axis] = if ray.direction[axis] >= 0.0 {
        last[axis] + 1
    } else {
        first[axis] - 1
    };
    tile
}

/// Where the ray comes over the grid and where it leaves it, metres along it.
pub(super) fn across_grid(tiles: &TileSet, eye: &GridPosition, ray: &Ray) -> [f32; 2] {
    let counts = IVec2::new(tiles.grid.columns as i32, tiles.grid.rows as i32);
    let to_min = (eye.tile_corner(&tiles.grid, IVec2::ZERO) - ray.start.xy()) * ray.inverse;
    let to_max = (eye.tile_corner(&tiles.grid, counts) - ray.start.xy()) * ray.inverse;
    let [t_in, t_out] = [to_min.min(to_max), to_min.max(to_max)];
    [t_in.max_element(), t_out.min_element()]
}
