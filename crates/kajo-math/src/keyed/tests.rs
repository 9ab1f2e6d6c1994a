use super::*;
use crate::{DMat3, DVec3};

const ALL: [Interpolation; 4] =
    [Interpolation::Step, Interpolation::Linear, Interpolation::Cubic, Interpolation::Monotone];

fn curve(keys: &[(f64, f64)], interpolation: Interpolation, outside: Outside) -> KeyedNumbers {
    let keys: Vec<_> = keys.iter().map(|&(time, value)| (time, vec![value])).collect();
    KeyedNumbers::new(&keys, interpolation, outside).unwrap()
}

#[test]
fn keys_are_met_and_held() {
    let keys = [(0.0, 1.0), (0.5, -3.0), (2.0, 4.0)];
    for interpolation in ALL {
        let curve = curve(&keys, interpolation, Outside::Hold);
        for (time, value) in keys {
            assert_eq!(curve.one_at(time, 0), value, "{interpolation:?} at {time}");
        }
        assert_eq!((curve.one_at(-5.0, 0), curve.one_at(9.0, 0)), (1.0, 4.0));
    }
}

#[test]
fn curves_have_the_values_of_their_formulas() {
    let at = |interpolation, time| {
        curve(&[(0.0, 0.0), (1.0, 1.0), (3.0, 9.0)], interpolation, Outside::Hold).one_at(time, 0)
    };
    assert_eq!(at(Interpolation::Step, 0.99), 0.0);
    assert_eq!(at(Interpolation::Linear, 2.0), 5.0);
    // Slopes 1 and (2 * 1 + 1 * 4) / 3 = 2 of the first piece: 0.5 + (1 - 2) / 8.
    assert!((at(Interpolation::Cubic, 0.5) - 0.375).abs() < 1e-15);
    // The harmonic mean: 9 / (5 / 1 + 4 / 4) = 1.5.
    assert!((at(Interpolation::Monotone, 0.5) - (0.5 + (1.0 - 1.5) / 8.0)).abs() < 1e-15);
    // A parabola on equal steps is met exactly where both slopes are its own.
    let parabola = [(0.0, 0.0), (1.0, 1.0), (2.0, 4.0), (3.0, 9.0)];
    assert!((curve(&parabola, Interpolation::Cubic, Outside::Hold).one_at(1.5, 0) - 2.25).abs() < 1e-15);
}

#[test]
fn monotone_curves_never_overshoot_and_cubics_do() {
    let keys = [(0.0, 0.0), (1.0, 0.1), (1.5, 3.0), (4.0, 3.0), (5.0, -1.0)];
    let reach = |interpolation| {
        let curve = curve(&keys, interpolation, Outside::Hold);
        (0..=500).map(|i| curve.one_at(f64::from(i) / 100.0, 0)).fold(f64::MIN, f64::max)
    };
    assert_eq!(reach(Interpolation::Monotone), 3.0);
    assert!(reach(Interpolation::Cubic) > 3.3);
    let monotone = curve(&keys, Interpolation::Monotone, Outside::Hold);
    let values: Vec<f64> = (0..=150).map(|i| monotone.one_at(f64::from(i) / 100.0, 0)).collect();
    assert!(values.windows(2).all(|pair| pair[1] >= pair[0]));
}

#[test]
fn loops_repeat_to_the_bit_and_pingpong_turns_back() {
    let keys = [(1.0, 0.3), (2.0, 1.7), (5.0, 0.3)];
    for interpolation in ALL {
        let round = curve(&keys, interpolation, Outside::Loop);
        let there_and_back = curve(&keys, interpolation, Outside::PingPong);
        for i in 0..64 {
            let t = 1.0 + f64::from(i) / 16.0;
            for turns in [-3.0, 1.0, 7.0] {
                assert_eq!(round.one_at(t + 4.0 * turns, 0), round.one_at(t, 0));
            }
            assert_eq!(there_and_back.one_at(10.0 - t, 0), there_and_back.one_at(t, 0));
        }
    }
    // A closed curve has one slope where it closes, and an open one stands still where it turns.
    let slope = |curve: &KeyedNumbers, t: f64| (curve.one_at(t + 1e-6, 0) - curve.one_at(t - 1e-6, 0)) / 2e-6;
    let round = curve(&keys, Interpolation::Cubic, Outside::Loop);
    let before = (round.one_at(5.0, 0) - round.one_at(5.0 - 1e-6, 0)) / 1e-6;
    let after = (round.one_at(5.0 + 1e-6, 0) - round.one_at(5.0, 0)) / 1e-6;
    assert!((before - after).abs() < 1e-4, "{before} {after}");
    assert!(slope(&curve(&keys, Interpolation::Cubic, Outside::PingPong), 5.0).abs() < 1e-5);
    // A jump shows the first value at the moment of the last key.
    assert_eq!(curve(&[(0.0, 1.0), (2.0, 7.0)], Interpolation::Linear, Outside::Loop).one_at(2.0, 0), 1.0);
}

#[test]
fn given_slopes_make_a_cubic() {
    // t^3 - t on [0, 2].
    let curve =
        KeyedNumbers::with_slopes(vec![0.0, 2.0], 1, vec![0.0, 6.0], vec![[7.0, -1.0], [11.0, 7.0]]).unwrap();
    for t in [0.0, 0.3, 1.0, 1.9, 2.0_f64] {
        assert!((curve.one_at(t, 0) - (t * t * t - t)).abs() < 1e-13);
    }
}

#[test]
fn bad_keys_are_refused() {
    let make =
        |keys: &[(f64, Vec<f64>)]| KeyedNumbers::new(keys, Interpolation::Linear, Outside::Hold).unwrap_err();
    assert_eq!(make(&[]), KeyedError::Empty);
    assert_eq!(make(&[(0.0, vec![1.0]), (0.0, vec![2.0])]), KeyedError::Order(1));
    assert_eq!(make(&[(1.0, vec![1.0]), (0.0, vec![2.0])]), KeyedError::Order(1));
    assert_eq!(make(&[(f64::NAN, vec![1.0])]), KeyedError::Order(0));
    assert_eq!(make(&[(0.0, vec![1.0]), (1.0, vec![])]), KeyedError::Values(1));
    assert_eq!(make(&[(0.0, vec![f64::INFINITY])]), KeyedError::Values(0));
    let slopes = |values: Vec<f64>, slopes| KeyedNumbers::with_slopes(vec![0.0, 1.0], 1, values, slopes);
    assert_eq!(slopes(vec![0.0], vec![[0.0; 2]; 2]), Err(KeyedError::Values(1)));
    assert_eq!(slopes(vec![0.0, 1.0], vec![[0.0, f64::NAN]; 2]), Err(KeyedError::Values(0)));
    let one = curve(&[(3.0, 5.0)], Interpolation::Cubic, Outside::Loop);
    assert_eq!([one.one_at(-1.0, 0), one.one_at(3.0, 0), one.one_at(9.0, 0)], [5.0; 3]);
}

#[test]
fn rotations_turn_steadily_by_the_shorter_way() {
    let about = |angle: f64| DQuat::from_xyzw(0.0, 0.0, fmath::sin64(angle / 2.0), fmath::cos64(angle / 2.0));
    for sign in [1.0, -1.0] {
        let (a, b) = (about(0.2), about(1.4) * sign);
        for u in [0.0, 0.25, 0.5, 1.0] {
            let turned = DMat3::from_quat(slerp(a, b, u)) * DVec3::X;
            let angle = 0.2 + u * 1.2;
            assert!(turned.distance(DVec3::new(fmath::cos64(angle), fmath::sin64(angle), 0.0)) < 1e-14);
        }
    }
    let same = slerp(about(0.2), about(0.2), 0.7);
    assert!((same - about(0.2)).length() < 1e-15);
}
