//! A contact sheet of ghosts: what to look at when a flare looks wrong.

use crate::camera::flare::{FlareImager, FlareRequest, GhostParameters, film_half_mm};
use crate::camera::{auto_exposure, single_crossing_ghosts, tone_mapped};
use crate::gpu::GpuError;

/// Images side by side, 8-bit sRGB.
pub struct ContactSheet {
    /// RGBA, rows from the top.
    pub rgba: Vec<u8>,
    /// Cells in a row.
    pub columns: usize,
}

/// Grey between the cells.
const GROUND: [u8; 4] = [40, 40, 40, 255];

/// Every ghost of a flare alone in a cell of its own, row by row in the order of `single_crossing_ghosts`, each as bright as
/// its own exposure makes it.
///
/// # Errors
/// When the device fails.
pub fn contact_sheet(
    imager: &mut FlareImager<'_>,
    request: &FlareRequest,
    size: [u32; 2],
) -> Result<ContactSheet, GpuError> {
    let ghosts = single_crossing_ghosts(&request.lens);
    let columns = (ghosts.len() as f64).sqrt().ceil().max(1.0) as u32;
    let rows = (ghosts.len() as u32).div_ceil(columns).max(1);
    let cell = [(size[0] / columns).max(4), (size[1] / rows).max(4)];
    // A line is left between cells.
    let inner = cell.map(|side| side - 2);
    let width = size[0] as usize;
    let mut rgba = GROUND.repeat(width * size[1] as usize);
    for (k, &ghost) in (0_u32..).zip(&ghosts) {
        let only = FlareRequest {
            ghosts: request.ghosts.map(|ghosts| GhostParameters {
                only: Some(ghost),
                ..ghosts
            }),
            image_half_mm: film_half_mm(&request.lens, inner),
            ..request.clone()
        };
        let image = imager.draw(&only, inner)?;
        let pixels = tone_mapped(&image.radiance, auto_exposure(&image.radiance));
        let corner = [k % columns * cell[0] + 1, k / columns * cell[1] + 1].map(|at| at as usize);
        for (row, line) in pixels.chunks_exact(4 * inner[0] as usize).enumerate() {
            let start = 4 * ((corner[1] + row) * width + corner[0]);
            if let Some(cells) = rgba.get_mut(start..start + line.len()) {
                cells.copy_from_slice(line);
            }
        }
    }
    Ok(ContactSheet {
        rgba,
        columns: columns as usize,
    })
}
