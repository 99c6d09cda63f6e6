//! What people wear: a few outfits, dealt out so that neighbours differ.

use super::mannequin::Material;

/// Linear RGB colours, one per [`Material`].
pub type Look = [[f32; 3]; Material::COUNT];

const SHIRTS: [[f32; 3]; 8] = [
    [0.604, 0.070, 0.058],
    [0.035, 0.150, 0.360],
    [0.800, 0.560, 0.140],
    [0.050, 0.270, 0.180],
    [0.640, 0.640, 0.600],
    [0.230, 0.090, 0.260],
    [0.700, 0.240, 0.080],
    [0.090, 0.330, 0.410],
];
const TROUSERS: [[f32; 3]; 4] =
    [[0.030, 0.045, 0.085], [0.075, 0.070, 0.065], [0.270, 0.205, 0.130], [0.018, 0.020, 0.024]];
const SKINS: [[f32; 3]; 5] =
    [[0.680, 0.400, 0.280], [0.520, 0.270, 0.165], [0.300, 0.140, 0.080], [0.150, 0.070, 0.042], [0.780, 0.510, 0.390]];
const HAIRS: [[f32; 3]; 5] =
    [[0.020, 0.014, 0.010], [0.075, 0.036, 0.018], [0.010, 0.009, 0.009], [0.330, 0.190, 0.070], [0.220, 0.210, 0.200]];
const SHOES: [[f32; 3]; 3] = [[0.022, 0.020, 0.020], [0.560, 0.550, 0.530], [0.110, 0.050, 0.025]];

/// Number of different looks.
pub const LOOKS: usize = 24;

/// The look of a person; the same for the same number. People `LOOKS` apart look alike.
pub fn look(person: usize) -> Look {
    let i = person % LOOKS;
    // Steps that share no factor with the lists' lengths walk through all of each before they repeat.
    [SHIRTS[i * 3 % 8], TROUSERS[(i + i / 8) % 4], SKINS[i * 2 % 5], HAIRS[(i * 3 + i / 5) % 5], SHOES[(i + i / 3) % 3]]
}
