//! SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators"): a seeded stream, so that a
//! scene grows the same way on every run.

/// State of the stream; start it with any seed.
pub(crate) struct Prng(pub(crate) u64);

impl Prng {
    /// The next number in [0, 1), with 53 bits.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The next number in [low, high).
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}
