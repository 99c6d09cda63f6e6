//! Numbers of eight people side by side: loops over them become vector instructions.

use glam::{Vec2, Vec3};

use crate::geom::Rotation;

/// People side by side.
pub(super) const WIDTH: usize = 8;

pub(super) type Eight = [f32; WIDTH];

/// Several numbers of each of them.
#[derive(Clone, Copy)]
pub(super) struct Eights<const N: usize>(pub [Eight; N]);

impl<const N: usize> Default for Eights<N> {
    fn default() -> Self {
        Self([[0.0; WIDTH]; N])
    }
}

// Written out, as closures would not be inlined into what is compiled for wide instructions.
impl Eights<2> {
    #[inline(always)]
    pub fn at(&self, i: usize) -> Vec2 {
        Vec2::new(self.0[0][i], self.0[1][i])
    }

    #[inline(always)]
    pub fn put(&mut self, i: usize, v: Vec2) {
        (self.0[0][i], self.0[1][i]) = (v.x, v.y);
    }
}

impl Eights<3> {
    #[inline(always)]
    pub fn at(&self, i: usize) -> Vec3 {
        Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i])
    }

    #[inline(always)]
    pub fn put(&mut self, i: usize, v: Vec3) {
        (self.0[0][i], self.0[1][i], self.0[2][i]) = (v.x, v.y, v.z);
    }
}

impl Eights<4> {
    #[inline(always)]
    pub fn at(&self, i: usize) -> Rotation {
        Rotation { axis: Vec3::new(self.0[0][i], self.0[1][i], self.0[2][i]), cosine: self.0[3][i] }
    }

    #[inline(always)]
    pub fn put(&mut self, i: usize, Rotation { axis, cosine }: Rotation) {
        (self.0[0][i], self.0[1][i], self.0[2][i], self.0[3][i]) = (axis.x, axis.y, axis.z, cosine);
    }
}
