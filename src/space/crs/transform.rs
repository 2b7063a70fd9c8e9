//! Points from one CRS to another.

use std::sync::Arc;

use glam::DVec2;
use proj::Proj;

use super::{Crs, CrsError, Operation};

/// A transformation of points; one per thread.
pub struct PointTransform {
    inner: Option<Proj>,
    operation: Option<Arc<Operation>>,
}

impl PointTransform {
    /// From one CRS to another, by the best operation installed; the identity costs nothing and changes no bit.
    pub fn new(from: &Crs, to: &Crs) -> Result<Self, CrsError> {
        let operation = Operation::between(from, to)?;
        let inner = operation.as_ref().map(|operation| {
            Proj::new(&operation.pipeline).map_err(|error| CrsError::NoTransformation {
                from: from.name().to_owned(),
                to: to.name().to_owned(),
                why: error.to_string(),
            })
        });
        Ok(Self {
            inner: inner.transpose()?,
            operation,
        })
    }

    /// True when points stay where they are.
    pub fn is_identity(&self) -> bool {
        self.inner.is_none()
    }

    /// The operation; none for the identity.
    pub fn operation(&self) -> Option<&Operation> {
        self.operation.as_deref()
    }

    /// Transforms in place; points that PROJ cannot take become NaN.
    pub fn points(&self, xs: &mut [f64], ys: &mut [f64]) {
        if self.is_identity() {
            return;
        }
        for (x, y) in xs.iter_mut().zip(ys.iter_mut()) {
            let moved = self.point(DVec2::new(*x, *y)).unwrap_or(DVec2::NAN);
            (*x, *y) = (moved.x, moved.y);
        }
    }

    /// Transforms one point; none when PROJ cannot.
    pub fn point(&self, point: DVec2) -> Option<DVec2> {
        let Some(inner) = &self.inner else {
            return Some(point).filter(|point| point.is_finite());
        };
        if !point.is_finite() {
            return None;
        }
        let (x, y) = inner.convert((point.x, point.y)).ok()?;
        Some(DVec2::new(x, y)).filter(|moved| moved.is_finite())
    }
}
