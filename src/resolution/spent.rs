//! What finding a light's maps takes, counted.

use std::ops::{AddAssign, Sub};

/// Work that does not depend on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spent {
    /// Texels of all maps drawn.
    pub texels_drawn: u64,
    /// Triangles of all maps drawn.
    pub triangles_drawn: u64,
    /// Evaluations of all fits.
    pub evaluations: u64,
    /// Rays of lookups: one for each point, and short ones behind steep surfaces that are not counted.
    pub rays: u64,
}

impl AddAssign for Spent {
    fn add_assign(&mut self, more: Spent) {
        self.texels_drawn += more.texels_drawn;
        self.triangles_drawn += more.triangles_drawn;
        self.evaluations += more.evaluations;
        self.rays += more.rays;
    }
}

impl Sub for Spent {
    type Output = Spent;

    /// What was spent since.
    fn sub(self, before: Spent) -> Spent {
        Spent {
            texels_drawn: self.texels_drawn - before.texels_drawn,
            triangles_drawn: self.triangles_drawn - before.triangles_drawn,
            evaluations: self.evaluations - before.evaluations,
            rays: self.rays - before.rays,
        }
    }
}
