//! A thread for one kind of work, so that the window stays alive meanwhile. Only the newest order counts: what was
//! ordered before and is not begun is not done. What is done too late may still be worth a look, as while something is
//! dragged about, or not.

use std::sync::mpsc::{self, Receiver, Sender};
use std::thread;

use super::tracer::Wake;

/// Turns orders into results.
pub struct Worker<I, O> {
    orders: Sender<(u64, I)>,
    results: Receiver<(u64, O)>,
    last: u64,
    is_busy: bool,
}

impl<I: Send + 'static, O: Send + 'static> Worker<I, O> {
    /// A worker without orders; `wake` is called when a result is there.
    pub fn new(wake: Wake, mut work: impl FnMut(I) -> O + Send + 'static) -> Worker<I, O> {
        let (orders, new_orders) = mpsc::channel::<(u64, I)>();
        let (done, results) = mpsc::channel();
        thread::spawn(move || {
            while let Ok(first) = new_orders.recv() {
                let (number, order) = new_orders.try_iter().last().unwrap_or(first);
                if done.send((number, work(order))).is_err() {
                    return;
                }
                wake();
            }
        });
        Worker { orders, results, last: 0, is_busy: false }
    }

    /// Orders this instead of anything else.
    pub fn order(&mut self, order: I) {
        self.last += 1;
        // The thread lives as long as this sender; should it have panicked, there will be no result.
        self.is_busy = self.orders.send((self.last, order)).is_ok();
    }

    /// The result of the newest order, once it is there.
    pub fn take(&mut self) -> Option<O> {
        let newest = self.last;
        let result = self.results.try_iter().filter(|(number, _)| *number == newest).last();
        self.is_busy &= result.is_none();
        result.map(|(_, result)| result)
    }

    /// Waits for the result of the newest order; `None` when none is to come.
    pub fn wait(&mut self) -> Option<O> {
        while self.is_busy {
            // Should the thread have panicked, there will be no result.
            let Ok((number, result)) = self.results.recv() else { break };
            if number == self.last {
                self.is_busy = false;
                return Some(result);
            }
        }
        self.is_busy = false;
        None
    }

    /// The newest result there is and was not taken yet, whether there are newer orders or not.
    pub fn take_latest(&mut self) -> Option<O> {
        let (number, result) = self.results.try_iter().last()?;
        self.is_busy &= number != self.last;
        Some(result)
    }

    /// Whether a result is still to come.
    pub fn is_busy(&self) -> bool {
        self.is_busy
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::Mutex;

    #[test]
    fn only_the_newest_order_counts() {
        let gate = Arc::new(Mutex::new(()));
        let closed = gate.lock().unwrap();
        let (woken, wakes) = mpsc::channel();
        let inner = Arc::clone(&gate);
        let wake: Wake = Arc::new(move || woken.send(()).unwrap());
        let mut worker = Worker::new(wake, move |n: u32| {
            drop(inner.lock());
            10 * n
        });
        for n in [1, 2, 3] {
            worker.order(n);
        }
        assert!(worker.is_busy() && worker.take().is_none());
        drop(closed);
        let mut result = None;
        while result.is_none() {
            wakes.recv().unwrap();
            result = worker.take();
        }
        assert_eq!(result, Some(30));
        assert!(!worker.is_busy() && worker.take().is_none() && worker.wait().is_none());
        worker.order(4);
        worker.order(5);
        assert_eq!(worker.wait(), Some(50));
        assert!(!worker.is_busy() && worker.take().is_none());
    }

    #[test]
    fn a_late_result_can_be_looked_at_while_the_newest_is_awaited() {
        let (open, gate) = mpsc::channel::<()>();
        let (woken, wakes) = mpsc::channel();
        let wake: Wake = Arc::new(move || woken.send(()).unwrap());
        let mut worker = Worker::new(wake, move |n: u32| {
            gate.recv().unwrap();
            10 * n
        });
        worker.order(1);
        open.send(()).unwrap();
        wakes.recv().unwrap();
        worker.order(2);
        assert_eq!(worker.take_latest(), Some(10));
        assert!(worker.is_busy() && worker.take_latest().is_none());
        open.send(()).unwrap();
        wakes.recv().unwrap();
        assert_eq!(worker.take_latest(), Some(20));
        assert!(!worker.is_busy());
    }
}
