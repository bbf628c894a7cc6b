//! SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators").

/// State of the stream; start it with any seed.
#[derive(Clone, Copy, Debug)]
pub struct Prng(u64);

/// The step of the state: 2⁶⁴ / golden ratio, odd.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

impl Prng {
    /// The published stream of a seed.
    pub fn seeded(seed: u64) -> Prng {
        Prng(seed)
    }

    /// A stream of its own for each seed and index.
    pub fn new(seed: u64, index: u64) -> Prng {
        let mut of_seed = Prng(seed);
        let mixed = of_seed.next_u64();
        Prng(mixed.wrapping_add(index.wrapping_mul(GAMMA).rotate_left(32)))
    }

    /// The next 64 bits.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GAMMA);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// The next number in [0, 1), with 53 bits.
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The next number in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// The next number of the normal distribution with mean 0 and deviation 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }

    /// The next whole number below `count`; 0 for a count of 0. The bias of the product is below count / 2⁶⁴.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next_u64()) * count as u128) >> 64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_is_the_published_one() {
        // First outputs of SplitMix64 for the seed 1234567, as in its reference implementation.
        let mut stream = Prng(1_234_567);
        assert_eq!([stream.next_u64(), stream.next_u64()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }

    #[test]
    fn normal_numbers_have_their_moments() {
        let mut stream = Prng::new(5, 0);
        let n = 20_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let x = stream.normal();
            (sum, squares) = (sum + x, squares + x * x);
        }
        let n = f64::from(n);
        assert!((sum / n).abs() < 0.03 && (squares / n - 1.0).abs() < 0.05, "{} {}", sum / n, squares / n);
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
