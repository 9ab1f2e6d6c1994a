//! Who goes first when there is more to do than there are cores.
//!
//! A trace takes all cores it gets, and where there is no graphics card the window is drawn by the same ones. The
//! trace can wait for a frame of the window, and its user would rather not wait for the trace.

/// How far behind, of 19 steps; each is a fifth less of a core that others want too.
#[cfg(target_os = "linux")]
const NICE: i32 = 15;

/// Lets everything else of the program go before this thread, and before those that it starts from now on.
///
/// On Linux, where a thread's "nice" value is its own and goes on to the threads that it starts. Elsewhere it does nothing:
/// there the system favours what the user looks at by itself.
pub fn give_way() {
    #[cfg(target_os = "linux")]
    {
        // It is allowed to everybody. Should a sandbox refuse it, the window is slower while it traces.
        let _ = rustix::process::setpriority_process(None, NICE);
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::thread;

    fn nice() -> i32 {
        rustix::process::getpriority_process(None).unwrap()
    }

    #[test]
    fn a_thread_and_those_that_it_starts_give_way_to_the_others() {
        let own = nice();
        let found = thread::spawn(|| {
            give_way();
            [nice(), thread::spawn(nice).join().unwrap()]
        });
        // Nobody may come nearer to the front than they stand.
        assert_eq!(found.join().unwrap(), [own.max(NICE); 2]);
        assert_eq!(nice(), own);
    }
}
