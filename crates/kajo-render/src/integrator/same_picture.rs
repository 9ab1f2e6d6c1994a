//! The law that a picture is a function of the scene and the seed: whatever the threads, the tiles, and the moments at which a render is
//! stopped and taken up again. Whether Markov chains agree is the same function.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use crate::{
    Film, FilmSpec, Goal, Layer, LayerSet, PixelIntegrator, Position, Progress, RenderError, RenderSettings,
    RenderStats, Silent, render, render_passes,
};

/// Stops a render after so many questions whether it goes on.
struct Cancel(AtomicUsize);

impl Progress for Cancel {
    fn done(&self, _: u64, _: u64, _: u64) {}

    fn cancelled(&self) -> bool {
        self.0.fetch_update(Relaxed, Relaxed, |n| n.checked_sub(1)).is_err()
    }
}

/// Renders with 1, 2 and 7 threads, three sizes of tiles, and with stops, and demands the same bits of all.
///
/// * `integrator`: with a layer of colour
/// * `stop`: questions to the progress until a render is stopped, and how many more each time that it is taken up again
#[track_caller]
pub fn assert_same_picture<I: PixelIntegrator + ?Sized>(
    integrator: &I,
    size: [u32; 2],
    settings: &RenderSettings,
    stop: [usize; 2],
) {
    let film = || {
        let layers = LayerSet::of(&[Layer::Color]);
        Film::new(FilmSpec { layers, ..FilmSpec::new(size[0], size[1]) }, u64::MAX).expect("a film")
    };
    let bits = |film: &Film| -> Vec<u32> {
        film.develop(Layer::Color).expect("a picture").data().iter().map(|v| v.to_bits()).collect()
    };
    let with = |threads, tile| RenderSettings { threads, tile, ..settings.clone() };
    let whole = film();
    render(integrator, &whole, &with(1, 0), &Silent).expect("a render");
    assert!(bits(&whole).iter().any(|&v| v != 0), "all is black");
    for (threads, tile) in [(2, 8), (7, 5)] {
        let (again, stopped) = (film(), film());
        render(integrator, &again, &with(threads, tile), &Silent).expect("a render");
        assert_eq!(bits(&whole), bits(&again), "{threads} threads");
        assert_eq!(whole.r_hat(), again.r_hat(), "{threads} threads");
        let mut position = Position::default();
        let go_on = &mut |_: &Film, _: &Position, _: &RenderStats| ControlFlow::Continue(());
        let mut stops = 0;
        while let Err(error) = render_passes(
            integrator,
            &stopped,
            &with(threads, tile),
            &Goal::default(),
            &mut position,
            &Cancel((stop[0] + stop[1] * stops).into()),
            go_on,
        ) {
            assert!(matches!(error, RenderError::Cancelled(_)), "{error}");
            stops += 1;
        }
        assert!(stops > 1, "{threads} threads were stopped {stops} times");
        assert_eq!(bits(&whole), bits(&stopped), "{threads} threads, stopped {stops} times");
        assert_eq!(whole.r_hat(), stopped.r_hat(), "{threads} threads, stopped {stops} times");
    }
}
