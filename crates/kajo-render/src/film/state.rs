//! A film as bytes, for checkpoints.
//!
//! First numbers of samples, and a byte that is 1 when Markov chains have counted, with their counts; where samples are
//! limited, the sums of what that took. Then for each block, row by row: what camera rays brought, after a byte that is 1
//! when there is something, and the splats likewise. Sums are written in the least number of bytes that holds all
//! numbers of an array, little-endian, after a byte with that number. How long an array is follows from the
//! [`FilmSpec`], so that nothing is allocated by what a file says.

use std::io::{self, ErrorKind, Read, Write};
use std::sync::PoisonError;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

use super::numbers::{bytes, flag, invalid, restore_array, save_numbers};
use super::{Block, Camera, ClampSums, Film, FilmError, FilmSpec, Layer, splats::SplatSums, sums::Sums};
use crate::ChainCounts;

/// Blocks that a thread makes into bytes before it hands these over.
const RUN: usize = 8;

/// Threads that do so at most, so that what waits to be written takes little memory.
const MOST_ENCODERS: usize = 4;

/// Samples that no render reaches: centuries at a billion a second. What goes on from them can still be counted.
const MOST_COUNTED: u64 = 1 << 62;

impl Film {
    /// Writes all sums, which several threads make into bytes.
    ///
    /// * `threads`: to use at most, this one included; 0 for one on each core
    ///
    /// # Errors
    /// Those of `out`; and `InvalidInput` for a film made for one pass, which has no sums.
    pub fn save(&self, threads: usize, out: &mut dyn Write) -> io::Result<()> {
        if !self.spec.keeps_sums() {
            return Err(io::Error::new(ErrorKind::InvalidInput, "the film keeps no sums"));
        }
        out.write_all(&self.samples().to_le_bytes())?;
        out.write_all(&self.non_finite().to_le_bytes())?;
        out.write_all(&saved_chains(&self.chains()))?;
        if self.spec.clamp.is_some() {
            let mut sums = Vec::new();
            self.clamp_sums().save(&mut sums);
            out.write_all(&sums)?;
        }
        let runs = self.blocks.len().div_ceil(RUN);
        let cores = || thread::available_parallelism().map_or(1, |n| n.get());
        let encoders = match threads {
            0 => cores(),
            // This one writes.
            n => n - 1,
        };
        let encoders = encoders.min(MOST_ENCODERS).min(runs);
        thread::scope(|scope| {
            let start = |first: usize| {
                let (to, from) = sync_channel(1);
                let mut mine = (first..runs).step_by(encoders);
                // The channel is closed once the writer has failed.
                let encode = move || mine.try_for_each(|run| to.send(self.encoded(run)));
                thread::Builder::new().spawn_scoped(scope, encode).ok().map(|_| from)
            };
            // In their order: those that the system gives no thread for are made here.
            let encoders: Vec<Option<Receiver<Vec<u8>>>> = (0..encoders).map(start).collect();
            (0..runs).try_for_each(|run| {
                let encoder = encoders.get(run % encoders.len().max(1)).and_then(Option::as_ref);
                let bytes = encoder.and_then(|encoder| encoder.recv().ok());
                out.write_all(&bytes.unwrap_or_else(|| self.encoded(run)))
            })
        })
    }

    /// The bytes of a run of blocks.
    fn encoded(&self, run: usize) -> Vec<u8> {
        let mut bytes = Vec::new();
        let end = self.blocks.len().min((run + 1) * RUN);
        for block in &self.blocks[run * RUN..end] {
            save_block(&block.lock().unwrap_or_else(PoisonError::into_inner), &mut bytes);
        }
        bytes
    }

    /// Reads what [`Film::save`] wrote of a film of this kind.
    ///
    /// # Errors
    /// Those of `input`; `InvalidData` when it holds something else; and as [`Film::new`].
    pub fn restore(spec: FilmSpec, budget: u64, input: &mut dyn Read) -> io::Result<Film> {
        let film = Film::new(spec, budget).map_err(|error: FilmError| io::Error::other(error.to_string()))?;
        for counter in [&film.samples, &film.non_finite] {
            let count = u64::from_le_bytes(bytes(input)?);
            if count > MOST_COUNTED {
                return Err(invalid());
            }
            counter.store(count, Ordering::Relaxed);
        }
        if flag(input)? {
            restore_array(film.chains().numbers_mut(), input)?;
        }
        if spec.clamp.is_some() {
            *film.clamp_sums() = ClampSums::restore(input)?;
        }
        for row in 0..film.grid.rows() {
            for column in 0..film.grid.columns() {
                let rect = film.grid.cell(column, row);
                let mut block = film.block(column, row);
                if flag(input)? {
                    let mut sums = Sums::empty(&spec);
                    sums.reset(rect);
                    sums.restore(input)?;
                    block.camera = Camera::Open(Box::new(sums));
                }
                if flag(input)? {
                    let mut splats = SplatSums::new(rect, spec.layers.has(Layer::Variance));
                    splats.restore(input)?;
                    block.splats = Some(Box::new(splats));
                }
            }
        }
        Ok(film)
    }
}

fn saved_chains(chains: &ChainCounts) -> Vec<u8> {
    let mut bytes = vec![u8::from(!chains.numbers().is_empty())];
    if bytes == [1] {
        save_numbers(chains.numbers().iter().map(|&n| n.into()), &mut bytes);
    }
    bytes
}

fn save_block(block: &Block, out: &mut Vec<u8>) {
    match &block.camera {
        Camera::Open(sums) => {
            out.push(1);
            sums.save(out);
        }
        Camera::Empty | Camera::Finished(_) => out.push(0),
    }
    match &block.splats {
        Some(splats) => {
            out.push(1);
            splats.save(out);
        }
        None => out.push(0),
    }
}
