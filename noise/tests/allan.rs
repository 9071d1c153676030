//! Allan deviations against allantools.

use noise::{Recorded, scales};

/// What `python noise/tests/allantools.py` prints: readings averaged, overlapping Allan deviation, number of terms.
const EXPECTED: [(u64, f64, u64); 10] = [
    (1, 0.2928804063330208, 1999),
    (2, 0.2047516251977916, 1997),
    (4, 0.1448440210966727, 1993),
    (8, 0.10526554486656085, 1985),
    (16, 0.071017019732437, 1969),
    (32, 0.05188672317403993, 1937),
    (64, 0.03584246908906106, 1873),
    (128, 0.026433385600539157, 1745),
    (256, 0.032814238759340246, 1489),
    (512, 0.0507062876582928, 977),
];

/// The same readings as in `allantools.py`.
fn series(count: usize) -> Vec<f64> {
    let (mut state, mut walk) = (1_u64, 0.0);
    let next = |_| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let uniform = (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        walk += 0.01 * uniform;
        uniform + walk
    };
    (0..count).map(next).collect()
}

#[test]
fn deviations_are_those_of_allantools() -> std::io::Result<()> {
    let scales = scales(&mut Recorded::of(&series(2000), 0.02)?)?;
    assert_eq!(scales.len(), EXPECTED.len());
    for (scale, (m, deviation, terms)) in scales.iter().zip(EXPECTED) {
        assert_eq!((scale.m, scale.terms), (m, terms));
        assert!((scale.deviation() / deviation - 1.0).abs() < 1e-10, "{scale:?} {deviation}");
    }
    Ok(())
}
