//! Random numbers: one independent stream per purpose.
//!
//! ChaCha8 is keyed with the seed (and the run, for what is not the unit's own), and its 64-bit stream number is the FNV-1a hash of what the numbers are for, for
//! instance `noise/gyro-walk`. Turning one thing off therefore leaves every other number as it was, and a
//! unit's errors do not depend on how long its log is.

use chacha20::ChaCha8Rng;
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

/// What random numbers depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seed {
    /// Which unit.
    pub unit: u64,
    /// Which run of that unit: another one has other noise.
    pub run: u64,
}

/// Random numbers for one purpose.
#[derive(Debug)]
pub struct Stream(ChaCha8Rng);

impl Clone for Stream {
    /// A stream that goes on with the same numbers.
    fn clone(&self) -> Self {
        Self(ChaCha8Rng::deserialize_state(&self.0.serialize_state()))
    }
}

impl Stream {
    /// The stream of unit `seed` for `purpose`, the same in every run.
    pub fn new(seed: u64, purpose: &str) -> Self {
        Self::in_run(Seed { unit: seed, run: 0 }, purpose)
    }

    /// The stream of one run of a unit for `purpose`.
    pub fn in_run(seed: Seed, purpose: &str) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.unit.to_le_bytes());
        key[8..15].copy_from_slice(b"sinscal");
        key[16..24].copy_from_slice(&seed.run.to_le_bytes());
        let mut generator = ChaCha8Rng::from_seed(key);
        generator.set_stream(fnv1a(purpose.as_bytes()));
        Self(generator)
    }

    /// A number of the standard normal distribution.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Three numbers of the standard normal distribution.
    pub fn normals(&mut self) -> Vector3<f64> {
        let x = self.normal();
        let y = self.normal();
        Vector3::new(x, y, self.normal())
    }

    /// A number between 0 and 1.
    pub fn uniform(&mut self) -> f64 {
        StandardUniform.sample(&mut self.0)
    }
}

/// The 64-bit hash of Fowler, Noll and Vo (draft-eastlake-fnv).
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first number of a stream, by another implementation of ChaCha8: another one would silently make every unit another unit.
    const KNOWN: f64 = 0.565_168_556_862_786_1;

    #[test]
    fn hash_of_the_published_test_vectors() {
        assert_eq!(fnv1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn streams_repeat_and_differ() {
        let numbers = |seed, purpose| {
            let mut stream = Stream::new(seed, purpose);
            [stream.normal(), stream.uniform(), stream.normal()]
        };
        assert_eq!(numbers(7, "a"), numbers(7, "a"));
        assert_ne!(numbers(7, "a"), numbers(7, "b"));
        assert_ne!(numbers(7, "a"), numbers(8, "a"));
    }

    #[test]
    fn known_numbers_and_clones() {
        let mut stream = Stream::new(1, "known");
        let first = stream.uniform();
        let mut clone = stream.clone();
        assert_eq!(first, KNOWN);
        for _ in 0..100 {
            assert_eq!(stream.normal(), clone.normal());
        }
    }

    #[test]
    fn normal_numbers_have_the_moments_of_the_distribution() {
        let mut stream = Stream::new(1, "moments");
        let n = 200_000;
        let (mut mean, mut square, mut fourth) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            let x = stream.normal();
            mean += x;
            square += x * x;
            fourth += x.powi(4);
        }
        let n = f64::from(n);
        assert!((mean / n).abs() < 4.0 / n.sqrt());
        assert!((square / n - 1.0).abs() < 4.0 * (2.0 / n).sqrt());
        assert!((fourth / n - 3.0).abs() < 4.0 * (96.0 / n).sqrt());
    }
}
