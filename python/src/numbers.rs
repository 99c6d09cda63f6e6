//! Points and rotations as NumPy arrays.

use glam::{Quat, Vec2, Vec3};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

/// (n, 2) array of ground points.
pub fn points2<'py>(py: Python<'py>, points: &[Vec2]) -> PyResult<Bound<'py, PyArray2<f32>>> {
    table(py, points.iter().flat_map(|p| p.to_array()).collect(), 2)
}

/// (n, 3) array of points.
pub fn points3<'py>(py: Python<'py>, points: &[Vec3]) -> PyResult<Bound<'py, PyArray2<f32>>> {
    table(py, points.iter().flat_map(|p| p.to_array()).collect(), 3)
}

/// (n, columns) array.
pub fn table<'py>(py: Python<'py>, values: Vec<f32>, columns: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let rows = values.len() / columns;
    PyArray1::from_vec(py, values).reshape([rows, columns])
}

/// (n, rows, columns) array.
pub fn stack<'py>(
    py: Python<'py>,
    values: Vec<f32>,
    rows: usize,
    columns: usize,
) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let n = values.len() / (rows * columns);
    PyArray1::from_vec(py, values).reshape([n, rows, columns])
}

/// (n, joints, 4) array of rotations as x, y, z, w.
pub fn rotations<'py>(py: Python<'py>, rotations: &[Quat], joints: usize) -> PyResult<Bound<'py, PyArray3<f32>>> {
    stack(py, rotations.iter().flat_map(|q| q.to_array()).collect(), joints, 4)
}
