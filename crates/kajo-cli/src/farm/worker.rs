//! `kajo worker --stdio`: renders units as another program asks for them.

use std::io::{self, BufReader, BufWriter, Write};
use std::process;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

use kajo::{Position, Silent, SplitRender};
use kajo_farm::protocol::{FailureKind, Request, Response, receive, send};
use kajo_farm::{Bundle, Part, Plan};

use super::{in_words, job_of, with_planned};
use crate::args::WorkerArgs;
use crate::failure::Failure;

/// A message and the bytes with it.
type Message = (Request, Vec<u8>);

/// Answers requests until there are no more.
///
/// # Errors
/// When an answer cannot be written.
pub fn worker(args: &WorkerArgs) -> Result<(), Failure> {
    give_way();
    let requests = listen();
    let mut next = requests.recv().ok();
    while let Some((request, bytes)) = next.take() {
        next = match request {
            Request::Open { plan } => open(&plan, &bytes, args, &requests)?,
            Request::Unit { .. } => {
                answer(&Response::failed(FailureKind::Input, "no plan was opened"), &[])?;
                requests.recv().ok()
            }
        };
    }
    Ok(())
}

/// Lets other programs of the machine go first: the coordinator must be answered, however busy the cores are.
#[cfg(unix)]
fn give_way() {
    // Without the right to, it renders at the priority it has.
    let _ = rustix::process::nice(10);
}

#[cfg(not(unix))]
fn give_way() {}

/// Receives requests while a unit is rendered: the end of the input ends the program then, too.
fn listen() -> Receiver<Message> {
    let (to, requests) = sync_channel(1);
    let hear = move || {
        let mut input = BufReader::new(io::stdin());
        loop {
            match receive::<Request>(&mut input) {
                Ok(Some(message)) => {
                    if to.send(message).is_err() {
                        break;
                    }
                }
                Ok(None) => process::exit(0),
                Err(error) => {
                    eprintln!("error: what came is no request: {error}");
                    process::exit(2);
                }
            }
        }
    };
    // Without a thread no requests are received, and the channel is closed.
    let _ = thread::Builder::new().name("requests".to_owned()).spawn(hear);
    requests
}

/// Opens a plan and renders its units. Returns the next request that is for none of them.
fn open(
    text: &str,
    bundle: &[u8],
    args: &WorkerArgs,
    requests: &Receiver<Message>,
) -> Result<Option<Message>, Failure> {
    let refuse = |message: &str| {
        let message = if message.is_empty() { "the scene has errors" } else { message };
        answer(&Response::failed(FailureKind::Input, message), &[]).map(|()| requests.recv().ok())
    };
    let hash = kajo_farm::plan_hash(text);
    let plan = match Plan::read(text) {
        Ok(plan) => plan,
        Err(error) => return refuse(&in_words(&error)),
    };
    let bundle = match bundle.is_empty() {
        true => None,
        false => match Bundle::read(bundle) {
            Ok(bundle) => Some(bundle),
            Err(error) => return refuse(&in_words(&error)),
        },
    };
    let served = job_of(&plan).and_then(|mut job| {
        job.resources.threads = args.threads.into();
        with_planned(&plan, &job, bundle.as_ref(), |split, _| {
            // What goes wrong from here on is no answer to this request.
            Ok(serve(&plan, &hash, split, job.resources.threads as u64, requests))
        })
    });
    match served {
        Ok(next) => next,
        Err(failure) => refuse(failure.message()),
    }
}

/// Renders units of a plan.
fn serve(
    plan: &Plan,
    hash: &[u8; 32],
    split: &SplitRender<'_>,
    threads: u64,
    requests: &Receiver<Message>,
) -> Result<Option<Message>, Failure> {
    answer(&Response { ok: true, threads, ..Response::default() }, &[])?;
    while let Ok((request, bytes)) = requests.recv() {
        let Request::Unit { stage, unit } = request else { return Ok(Some((request, bytes))) };
        match render(plan, hash, split, (stage, unit), &bytes) {
            Ok((response, part)) => answer(&response, part.bytes())?,
            Err(response) => answer(&response, &[])?,
        }
    }
    Ok(None)
}

fn render(
    plan: &Plan,
    hash: &[u8; 32],
    split: &SplitRender<'_>,
    (stage, unit): (u32, u64),
    beginning: &[u8],
) -> Result<(Response, Part), Response> {
    let input = |message: String| Response::failed(FailureKind::Input, message);
    let position = match beginning {
        [] => Position::default(),
        mut bytes => split.restore_position(&mut bytes).map_err(|error| input(error.to_string()))?,
    };
    let layout =
        plan.layout(split.stage(&position).unwrap_or_default()).map_err(|error| input(error.to_string()))?;
    let work = layout.work_unit(unit).ok_or_else(|| input(format!("there is no unit {unit}")))?;
    let failed = |message: String| Response::failed(FailureKind::Unit, message);
    let (film, stats) = split.render(&position, &work, &Silent).map_err(|error| failed(error.to_string()))?;
    let part = Part::new(hash, (stage, unit), &film, &kajo_farm::host())
        .map_err(|error| failed(error.to_string()))?;
    let (samples, rays, seconds) = (stats.samples, stats.rays.total(), stats.seconds);
    Ok((Response { ok: true, samples, rays, seconds, ..Response::default() }, part))
}

fn answer(response: &Response, bytes: &[u8]) -> Result<(), Failure> {
    let mut out = BufWriter::new(io::stdout().lock());
    send(&mut out, response, bytes)
        .and_then(|()| out.flush())
        .map_err(|error| Failure::Output(format!("nobody takes the answer: {error}")))
}
