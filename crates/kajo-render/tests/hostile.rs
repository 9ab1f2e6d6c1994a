//! Saved states of renders, damaged in thousands of ways.

#[path = "hostile/state.rs"]
mod state;

use kajo_math::rng::Stream;

#[test]
fn damaged_states_are_refused_or_gone_on_from() {
    let mut read = 0;
    for passes in 1..4 {
        let whole = state::saved(passes);
        assert!(state::go_on(&whole), "the state itself");
        for i in 0..2000 {
            let stream = Stream::new(31, [i, passes], 0);
            let below = |k: u32, n: usize| (stream.uniform(k) * n as f32) as usize;
            let mut data = whole.clone();
            for k in 0..1 + below(0, 3) as u32 {
                let at = below(1 + 3 * k, data.len().max(1)).min(data.len().saturating_sub(1));
                match below(2 + 3 * k, 4) {
                    0 => data[at] ^= 1 << below(3 + 3 * k, 8),
                    1 => data[at] = [0, 0xff, 0x7f, 0x80][below(3 + 3 * k, 4)],
                    2 => data.iter_mut().skip(at).take(16).for_each(|byte| *byte = 0xff),
                    _ => data.truncate(at.max(1)),
                }
            }
            read += u32::from(state::go_on(&data));
        }
    }
    assert!(read > 500, "hardly any damage passed the first look: {read}");
}

#[test]
fn numbers_as_large_as_they_can_be_are_refused_or_gone_on_from() {
    for passes in 1..4 {
        let whole = state::saved(passes);
        for at in 0..whole.len() {
            for byte in [0xff, 0x7f] {
                let mut data = whole.clone();
                data.iter_mut().skip(at).take(8).for_each(|other| *other = 0xff);
                data.iter_mut().skip(at + 7).take(1).for_each(|last| *last = byte);
                state::go_on(&data);
            }
        }
    }
}

#[test]
fn states_that_fuzzing_found_are_refused_or_gone_on_from() {
    for (_, data) in kajo_testkit::corpus("checkpoint") {
        state::go_on(&data);
    }
}
