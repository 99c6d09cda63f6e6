//! Glue of the preference function: tables that somebody's own functions filled.

use crowdquilt::tiling::{Form, Grid, Scene, Term};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// What f is at the nodes of a table.
#[derive(FromPyObject)]
pub enum Table<'py> {
    /// By name of the kind.
    Kinds(Vec<(String, f32)>),
    /// Over time.
    Times(PyReadonlyArray1<'py, f32>),
    /// Over the ground.
    Places(PyReadonlyArray2<'py, f32>),
    /// Over headings and the ground.
    Headings(PyReadonlyArray3<'py, f32>),
}

/// The scene with one more factor exp(-f / sigma), f given by a table with nodes `step` apart.
pub fn with_table(scene: &Scene, table: Table, step: f32, sigma: f32) -> PyResult<Scene> {
    let bad = |expected: &str| Err(PyValueError::new_err(format!("expected {expected}")));
    if !(step > 0.0 && step.is_finite() && sigma > 0.0 && sigma.is_finite()) {
        return bad(&format!("a step and a sigma above 0, found {step} and {sigma}"));
    }
    let form = form(scene, table, step)?;
    let fine = match &form {
        Form::Kinds(values) => values.iter().all(|v| is_fine(v.1)),
        Form::Times { values, .. } => !values.is_empty() && values.iter().copied().all(is_fine),
        Form::Places(grid) => is_whole(grid),
        Form::Headings(grids) => !grids.is_empty() && grids.iter().all(is_whole),
        _ => true,
    };
    if !fine {
        return bad("numbers that are finite and not negative, at least one");
    }
    let mut scene = scene.clone();
    scene.preference.terms.push(Term { form, strength: 1.0 / sigma, labels: vec![], during: None });
    Ok(scene)
}

fn is_fine(value: f32) -> bool {
    value >= 0.0 && value.is_finite()
}

fn is_whole(grid: &Grid) -> bool {
    grid.columns > 0 && !grid.values.is_empty() && grid.values.iter().copied().all(is_fine)
}

fn form(scene: &Scene, table: Table, step: f32) -> PyResult<Form> {
    let grid = |values: &[f32], columns: usize| {
        let (origin, _) = scene.region.bounds();
        Grid { origin, cell: step, columns, values: values.to_vec() }
    };
    Ok(match table {
        Table::Kinds(values) => Form::Kinds(values),
        Table::Times(values) => Form::Times { step, values: values.as_slice()?.to_vec() },
        Table::Places(values) => Form::Places(grid(values.as_slice()?, values.shape()[1])),
        Table::Headings(values) => {
            let (size, columns) = (values.shape()[1] * values.shape()[2], values.shape()[2]);
            let all = values.as_slice()?;
            Form::Headings(all.chunks(size.max(1)).map(|one| grid(one, columns)).collect())
        }
    })
}

/// The places of the nodes of a grid over the region, `cell` apart: columns, and all nodes row by row.
pub fn nodes(scene: &Scene, cell: f32) -> PyResult<(usize, Vec<glam::Vec2>)> {
    let (low, high) = scene.region.bounds();
    let count = ((high - low) / cell).element_product();
    if !(cell > 0.0 && count < 4e6) {
        let problem = format!("expected a cell that divides the region into fewer than 4 million, found {cell} m");
        return Err(PyValueError::new_err(problem));
    }
    Ok(Grid::nodes(low, high, cell))
}
