//! Hands units to an engine: another program, which knows machines that render.
//!
//! The engine started this program, reads [`Order`]s from its standard output and writes [`News`] to its standard input, by
//! the messages of [`protocol`]. It keeps no record of what is finished: what it loses is ordered again, and a unit that it
//! brings twice counts once. A unit that fails is tried three times, on different hosts where there are several, and then
//! left out; one that takes ten times as long as others, and ten minutes, is ordered again. When no unit waits, those that
//! take twice as long as others are ordered a second time.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::io::{Read, Write};
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use kajo::SplitRender;
use serde::{Deserialize, Serialize};

use crate::coordinator::{LEASE, LEAST_LEASE, MOST_LOSSES, TRIES};
use crate::hosts::HostShare;
use crate::{FailedUnit, FarmError, Job, Layout, Part, Watch, protocol};

/// What an engine is told.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase")]
pub enum Order {
    /// What is rendered: the first order of all.
    Plan {
        /// The text of the plan, for `open` of a worker.
        plan: String,
        /// The file of the scene's bundle, for the same.
        bundle: String,
    },
    /// Units are of this stage from now on; where it begins goes with it, for `unit` of a worker.
    Stage {
        /// The stage.
        stage: u32,
    },
    /// Render a unit.
    Unit {
        /// The stage.
        stage: u32,
        /// The unit.
        unit: u64,
        /// Hosts on which it has failed, and that are not to have it where there are others.
        avoid: Vec<String>,
    },
    /// A unit is not wanted any more.
    Drop {
        /// The stage.
        stage: u32,
        /// The unit.
        unit: u64,
    },
    /// All is done.
    End,
}

/// What an engine says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "is", rename_all = "lowercase")]
pub enum News {
    /// So many units may be ordered at once.
    Room {
        /// How many.
        units: u64,
    },
    /// A part goes with this.
    Part {
        /// The stage.
        stage: u32,
        /// The unit.
        unit: u64,
        /// Who rendered it.
        host: String,
        /// Samples that were taken.
        samples: u64,
        /// Rays that were cast.
        rays: u64,
        /// Seconds that it took.
        seconds: f64,
    },
    /// A unit comes back without a part.
    Lost {
        /// The stage.
        stage: u32,
        /// The unit.
        unit: u64,
        /// Who had it.
        host: String,
        /// Whose fault it was.
        kind: LossKind,
        /// Why.
        message: String,
    },
    /// Something worth a line.
    Note {
        /// The line.
        message: String,
    },
    /// The engine cannot go on.
    Over {
        /// Whether the same command will not do better.
        wrong: bool,
        /// Why.
        message: String,
    },
}

/// Whose fault it is that there is no part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LossKind {
    /// The worker's: it is gone, and has nothing against the unit.
    Worker,
    /// The unit's, perhaps.
    Unit,
    /// The plan's: no worker would do better.
    Input,
}

/// A message, or why there are no more.
type Heard = Result<(News, Vec<u8>), String>;

/// An engine that is talked to.
pub struct Engine {
    orders: Box<dyn Write + Send>,
    news: Receiver<Heard>,
    room: u64,
    hosts: BTreeMap<String, HostShare>,
}

impl std::fmt::Debug for Engine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Engine").field("room", &self.room).finish_non_exhaustive()
    }
}

impl Engine {
    /// Starts to listen.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn new(
        mut input: impl Read + Send + 'static,
        orders: impl Write + Send + 'static,
    ) -> Result<Engine, FarmError> {
        let (to, news) = sync_channel(64);
        let hear = move || {
            loop {
                let heard = match protocol::receive::<News>(&mut input) {
                    Ok(Some(message)) => Ok(message),
                    Ok(None) => Err("the engine has ended".to_owned()),
                    Err(error) => Err(format!("the engine does not speak the protocol: {error}")),
                };
                let is_last = heard.is_err();
                if to.send(heard).is_err() || is_last {
                    break;
                }
            }
        };
        thread::Builder::new()
            .name("news".to_owned())
            .spawn(hear)
            .map_err(|error| FarmError::Input(format!("the system gives no thread: {error}")))?;
        Ok(Engine { orders: Box::new(orders), news, room: 0, hosts: BTreeMap::new() })
    }

    /// Tells what is rendered.
    ///
    /// # Errors
    /// [`FarmError::NotYet`] when the engine has ended.
    pub fn begin(&mut self, job: &Job, bundle: &Path) -> Result<(), FarmError> {
        let bundle = bundle.to_string_lossy().into_owned();
        self.order(&Order::Plan { plan: job.text().to_owned(), bundle }, &[])
    }

    /// Tells the engine that all is done, if it still runs.
    pub fn end(&mut self) {
        let _ = self.order(&Order::End, &[]);
    }

    /// What each host has brought.
    pub fn hosts(&self) -> &BTreeMap<String, HostShare> {
        &self.hosts
    }

    fn order(&mut self, order: &Order, bytes: &[u8]) -> Result<(), FarmError> {
        protocol::send(&mut *self.orders, order, bytes)
            .map_err(|error| FarmError::NotYet(format!("the engine takes no orders: {error}")))
    }

    /// Renders what is missing of a stage.
    ///
    /// # Errors
    /// As [`coordinate`](crate::coordinate); [`FarmError::NotYet`] when the engine is gone.
    pub fn coordinate(
        &mut self,
        job: &Job,
        split: &SplitRender<'_>,
        watch: &dyn Watch,
    ) -> Result<(), FarmError> {
        let (stage, position) = job.stage(split)?;
        let layout = job.layout(split, &position)?;
        let bytes = job.stage_bytes()?.map(|(_, bytes)| bytes).unwrap_or_default();
        let finished = job.finished(&layout)?;
        let waiting = (0..layout.units()).filter(|&unit| !finished.contains(&(stage, unit)));
        let waiting: VecDeque<u64> = waiting.collect();
        self.order(&Order::Stage { stage }, &bytes)?;
        let total = layout.units();
        let done = total - waiting.len() as u64;
        watch.done(done, total, 0, 0);
        let ledger = Ledger { waiting, done, ..Ledger::default() };
        Rendering { engine: self, job, split, layout, stage, watch, total, ledger }.run()
    }
}

/// Who has which unit, and what became of others.
#[derive(Default)]
struct Ledger {
    waiting: VecDeque<u64>,
    /// Ordered, since when, and how many times.
    out: BTreeMap<u64, (Instant, u32)>,
    tries: BTreeMap<u64, usize>,
    losses: BTreeMap<u64, u32>,
    /// Hosts on which units failed.
    avoid: BTreeMap<u64, BTreeSet<String>>,
    failed: Vec<FailedUnit>,
    /// How long units took.
    took: Vec<Duration>,
    done: u64,
    samples: u64,
    rays: u64,
}

impl Ledger {
    /// Orders that are out.
    fn orders(&self) -> u64 {
        self.out.values().map(|&(_, copies)| u64::from(copies)).sum()
    }

    fn median(&self) -> Option<Duration> {
        /// Fewer say nothing.
        const ENOUGH: usize = 3;
        let mut took = self.took.clone();
        took.sort_unstable();
        took.get(took.len() / 2).copied().filter(|_| took.len() >= ENOUGH)
    }

    /// A unit whose second copy may be faster than the first.
    fn straggler(&self) -> Option<u64> {
        /// Shorter units are not worth it.
        const LEAST: Duration = Duration::from_secs(1);
        let late = (2 * self.median()?).max(LEAST);
        let late = self.out.iter().filter(|(_, (since, copies))| *copies == 1 && since.elapsed() > late);
        late.min_by_key(|(_, (since, _))| *since).map(|(&unit, _)| unit)
    }

    /// Units that take too long.
    fn overdue(&self) -> Vec<u64> {
        let lease = (self.median().unwrap_or_default() * LEASE).max(LEAST_LEASE);
        self.out.iter().filter(|(_, (since, _))| since.elapsed() > lease).map(|(&unit, _)| unit).collect()
    }
}

/// One stage that is rendered.
struct Rendering<'a> {
    engine: &'a mut Engine,
    job: &'a Job,
    split: &'a SplitRender<'a>,
    layout: Layout,
    stage: u32,
    watch: &'a dyn Watch,
    total: u64,
    ledger: Ledger,
}

impl Rendering<'_> {
    fn run(mut self) -> Result<(), FarmError> {
        const STEP: Duration = Duration::from_millis(50);
        while !(self.ledger.waiting.is_empty() && self.ledger.out.is_empty()) {
            self.hand_out()?;
            match self.engine.news.recv_timeout(STEP) {
                Ok(Ok((news, bytes))) => self.heard(news, bytes)?,
                Ok(Err(why)) => return Err(FarmError::NotYet(why)),
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(FarmError::NotYet("the engine has ended".to_owned()));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            if self.watch.cancelled() {
                return Err(FarmError::Cancelled);
            }
            for unit in self.ledger.overdue() {
                self.drop_unit(unit)?;
                self.failed(unit, "", "it took too long")?;
            }
        }
        match self.ledger.failed {
            failed if failed.is_empty() => Ok(()),
            units => Err(FarmError::Failed { units }),
        }
    }

    /// Orders units while there is room.
    fn hand_out(&mut self) -> Result<(), FarmError> {
        while self.ledger.orders() < self.engine.room {
            let next = self.ledger.waiting.pop_front();
            let Some(unit) = next.or_else(|| self.ledger.straggler()) else { break };
            let avoid = self.ledger.avoid.get(&unit).into_iter().flatten().cloned().collect();
            self.engine.order(&Order::Unit { stage: self.stage, unit, avoid }, &[])?;
            self.ledger.out.entry(unit).or_insert((Instant::now(), 0)).1 += 1;
        }
        Ok(())
    }

    fn heard(&mut self, news: News, bytes: Vec<u8>) -> Result<(), FarmError> {
        match news {
            News::Room { units } => self.engine.room = units,
            News::Note { message } => self.watch.note(&message),
            News::Over { wrong: true, message } => return Err(FarmError::Input(message)),
            News::Over { wrong: false, message } => return Err(FarmError::NotYet(message)),
            // Of a stage that is over.
            News::Part { stage, .. } | News::Lost { stage, .. } if stage != self.stage => {}
            News::Lost { kind: LossKind::Input, message, .. } => return Err(FarmError::Input(message)),
            // Its result is no longer needed.
            News::Lost { unit, .. } if !self.ledger.out.contains_key(&unit) => {}
            News::Lost { unit, kind: LossKind::Worker, message, .. } => self.lost(unit, &message),
            News::Lost { unit, host, kind: LossKind::Unit, message, .. } => {
                self.came_back(unit);
                self.failed(unit, &host, &message)?;
            }
            News::Part { unit, host, samples, rays, seconds, .. } => {
                let share = HostShare { units: 1, samples, seconds };
                self.brought(unit, &host, share, rays, bytes)?;
            }
        }
        Ok(())
    }

    /// A part came.
    fn brought(
        &mut self,
        unit: u64,
        host: &str,
        share: HostShare,
        rays: u64,
        bytes: Vec<u8>,
    ) -> Result<(), FarmError> {
        let part = match Part::read(bytes, self.job.hash()) {
            Ok(part) if (part.stage, part.unit) == (self.stage, unit) => part,
            Ok(_) => {
                self.lost(unit, &format!("{host} brought another unit than it was asked for"));
                return Ok(());
            }
            Err(error) => {
                self.lost(unit, &format!("what {host} brought is no part of this job: {error}"));
                return Ok(());
            }
        };
        // A second copy is compared with the first, also when it is no longer needed.
        self.job.publish(&part, &self.layout, self.split)?;
        let Some((since, copies)) = self.ledger.out.remove(&unit) else { return Ok(()) };
        if copies > 1 {
            self.drop_unit(unit)?;
        }
        let of_host = self.engine.hosts.entry(host.to_owned()).or_default();
        of_host.units += 1;
        of_host.samples += share.samples;
        of_host.seconds += share.seconds;
        let ledger = &mut self.ledger;
        ledger.took.push(since.elapsed());
        ledger.done += 1;
        ledger.samples += share.samples;
        ledger.rays += rays;
        self.watch.done(ledger.done, self.total, ledger.samples, ledger.rays);
        self.watch.hosts(&self.engine.hosts);
        Ok(())
    }

    /// One copy of a unit is not out any more. Returns whether that was the last one.
    fn came_back(&mut self, unit: u64) -> bool {
        match self.ledger.out.get_mut(&unit) {
            Some((_, copies)) if *copies > 1 => {
                *copies -= 1;
                false
            }
            Some(_) => self.ledger.out.remove(&unit).is_some(),
            None => false,
        }
    }

    fn drop_unit(&mut self, unit: u64) -> Result<(), FarmError> {
        self.ledger.out.remove(&unit);
        self.engine.order(&Order::Drop { stage: self.stage, unit }, &[])
    }

    /// A worker was lost with a unit.
    fn lost(&mut self, unit: u64, message: &str) {
        if !self.came_back(unit) {
            return;
        }
        let losses = self.ledger.losses.entry(unit).or_insert(0);
        *losses += 1;
        if *losses > MOST_LOSSES {
            let message = format!("{MOST_LOSSES} workers were lost with it; the last: {message}");
            self.ledger.failed.push(FailedUnit { stage: self.stage, unit, message });
        } else {
            self.ledger.waiting.push_front(unit);
        }
        self.watch.note(&format!("unit {unit} is rendered again: {message}"));
    }

    /// A unit failed. Copies of it that are still out may do better, unless it has failed often enough.
    fn failed(&mut self, unit: u64, host: &str, message: &str) -> Result<(), FarmError> {
        let tries = self.ledger.tries.entry(unit).or_insert(0);
        *tries += 1;
        let tries = *tries;
        if !host.is_empty() {
            self.ledger.avoid.entry(unit).or_default().insert(host.to_owned());
        }
        self.job.log(self.stage, unit, tries, &format!("{host}: {message}\n"));
        self.watch.note(&format!("unit {unit} failed, try {tries} of {TRIES}: {message}"));
        let is_out = self.ledger.out.contains_key(&unit);
        if tries >= TRIES {
            if is_out {
                self.drop_unit(unit)?;
            }
            let message = message.lines().next().unwrap_or_default().to_owned();
            self.ledger.failed.push(FailedUnit { stage: self.stage, unit, message });
        } else if !is_out {
            self.ledger.waiting.push_back(unit);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_units_that_others_overtook_are_ordered_twice() {
        let long_ago = Instant::now().checked_sub(Duration::from_secs(60)).unwrap();
        let out = BTreeMap::from([(1, (long_ago, 1)), (2, (Instant::now(), 1)), (3, (long_ago, 2))]);
        let mut ledger = Ledger { out, ..Ledger::default() };
        assert_eq!(ledger.straggler(), None, "nothing is known of how long they take");
        ledger.took = vec![Duration::from_secs(10); 3];
        assert_eq!((ledger.straggler(), ledger.orders()), (Some(1), 4));
        ledger.took = vec![Duration::from_secs(31); 3];
        assert_eq!(ledger.straggler(), None);
        assert_eq!(ledger.overdue(), Vec::<u64>::new(), "ten minutes are allowed");
        if let Some(before) = Instant::now().checked_sub(LEAST_LEASE + Duration::from_secs(1)) {
            ledger.out.insert(7, (before, 1));
            ledger.took = vec![Duration::from_secs(1); 3];
            assert_eq!(ledger.overdue(), [7]);
        }
    }

    #[test]
    fn messages_have_the_words_of_the_manual() {
        let text = |order: &Order| serde_json::to_string(order).unwrap();
        assert_eq!(
            text(&Order::Unit { stage: 0, unit: 7, avoid: vec!["a".into()] }),
            r#"{"do":"unit","stage":0,"unit":7,"avoid":["a"]}"#
        );
        assert_eq!(text(&Order::End), r#"{"do":"end"}"#);
        let news: News = serde_json::from_str(
            r#"{"is":"lost","stage":0,"unit":3,"host":"a","kind":"worker","message":"gone"}"#,
        )
        .unwrap();
        assert!(matches!(news, News::Lost { unit: 3, kind: LossKind::Worker, .. }));
    }
}
