//! SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators").

/// State of the stream; start it with any seed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prng(u64);

/// The step of the state: 2⁶⁴ / golden ratio, odd.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

impl Prng {
    /// A stream of its own for each seed and index.
    pub(super) fn new(seed: u64, index: u64) -> Prng {
        let mut of_seed = Prng(seed);
        let mixed = of_seed.next();
        Prng(mixed.wrapping_add(index.wrapping_mul(GAMMA).rotate_left(32)))
    }

    /// The next 64 bits.
    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GAMMA);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// The next number in [0, 1), with 53 bits.
    pub(super) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The next whole number below `count`; 0 for a count of 0. The bias of the product is below count / 2⁶⁴.
    pub(super) fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next()) * count as u128) >> 64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_is_the_published_one() {
        // First outputs of SplitMix64 for the seed 1234567, as in its reference implementation.
        let mut stream = Prng(1_234_567);
        assert_eq!([stream.next(), stream.next()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }

    #[test]
    fn numbers_below_reach_every_value() {
        let mut stream = Prng::new(1, 2);
        let mut seen = [0; 7];
        for _ in 0..7000 {
            seen[stream.below(7)] += 1;
        }
        assert!(seen.iter().all(|n| (850..1150).contains(n)), "{seen:?}");
        assert_eq!(stream.below(0), 0);
    }
}
