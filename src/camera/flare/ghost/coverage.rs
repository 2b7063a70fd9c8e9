//! Where on the sensor a ghost's triangles lie.

use glam::{DVec2, IVec2};

use super::vertex::FlareVertex;

/// Cells along a side.
const CELLS: usize = u64::BITS as usize;

/// Cells of a rectangle of the sensor that triangles touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// Least coordinates, millimetres.
    min_mm: DVec2,
    cell_mm: DVec2,
    /// A bit a column.
    rows: [u64; CELLS],
}

impl Coverage {
    /// Of triangles between least and greatest coordinates, millimetres.
    pub fn new(vertices: &[FlareVertex], [min_mm, max_mm]: [DVec2; 2]) -> Self {
        let cell_mm = ((max_mm - min_mm) / CELLS as f64).max(DVec2::splat(1e-9));
        let mut rows = [0; CELLS];
        for triangle in vertices.chunks_exact(3) {
            let cells = [0, 1, 2].map(|k: usize| {
                let at_mm = glam::Vec2::from_array(triangle[k].sensor_mm).as_dvec2();
                let cell = ((at_mm - min_mm) / cell_mm).as_ivec2();
                cell.clamp(IVec2::ZERO, IVec2::splat(CELLS as i32 - 1))
            });
            let [min, max] = [
                cells[0].min(cells[1]).min(cells[2]),
                cells[0].max(cells[1]).max(cells[2]),
            ];
            let columns = (u64::MAX << min.x) & (u64::MAX >> (CELLS as i32 - 1 - max.x));
            for row in &mut rows[min.y as usize..=max.y as usize] {
                *row |= columns;
            }
        }
        Self {
            min_mm,
            cell_mm,
            rows,
        }
    }

    /// Least and greatest coordinates of what is touched, millimetres: neighbours in a row together.
    pub fn rectangles(&self) -> Vec<[DVec2; 2]> {
        let mut rectangles = Vec::new();
        for (y, &row) in self.rows.iter().enumerate() {
            let mut rest = row;
            while rest != 0 {
                let from = rest.trailing_zeros();
                let to = from + (rest >> from).trailing_ones();
                let corner =
                    |x: u32, y: usize| self.min_mm + DVec2::new(f64::from(x), y as f64) * self.cell_mm;
                rectangles.push([corner(from, y), corner(to, y + 1)]);
                rest &= u64::MAX.checked_shl(to).unwrap_or(0);
            }
        }
        rectangles
    }
}
