//! Workers that are processes of this machine: `kajo worker --stdio`.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use crate::coordinator::{Loss, Reply, Start, Task, Worker};
use crate::protocol::{self, FailureKind, Request, Response};

/// Starts worker processes.
#[derive(Debug)]
pub struct ProcessWorkers<F> {
    /// The text of the plan.
    pub plan: String,
    /// The command of a worker at a place; its input and output are taken care of.
    pub command: F,
}

impl<F: Fn(usize) -> Command + Sync> Start for ProcessWorkers<F> {
    fn start(&self, place: usize) -> Result<Box<dyn Worker + '_>, Loss> {
        let no_start = |error: io::Error| Loss::Worker(format!("cannot start a worker: {error}"));
        let said = tempfile::tempfile().map_err(no_start)?;
        let mut command = (self.command)(place);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(said.try_clone().map_err(no_start)?);
        let mut child = command.spawn().map_err(no_start)?;
        let (input, output) = (child.stdin.take(), child.stdout.take());
        let (Some(input), Some(output)) = (input, output) else {
            return Err(Loss::Worker("a worker without input and output".to_owned()));
        };
        let (child, output) = (Arc::new(Mutex::new(child)), BufReader::new(output));
        let mut worker = ProcessWorker { child, input: Some(input), output, said };
        worker.ask(&Request::Open { plan: self.plan.clone() }, &[])?;
        Ok(Box::new(worker))
    }
}

struct ProcessWorker {
    child: Arc<Mutex<Child>>,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    /// Its standard error.
    said: File,
}

impl ProcessWorker {
    fn ask(&mut self, request: &Request, bytes: &[u8]) -> Result<(Response, Vec<u8>), Loss> {
        let input = self.input.as_mut();
        let answer = input
            .ok_or_else(|| io::ErrorKind::BrokenPipe.into())
            .and_then(|mut input| protocol::send(&mut input, request, bytes))
            .and_then(|()| protocol::receive::<Response>(&mut self.output));
        match answer {
            Ok(Some((response, bytes))) if response.ok => Ok((response, bytes)),
            Ok(Some((Response { kind, message, .. }, _))) => {
                let message = message.unwrap_or_else(|| "it gave no reason".to_owned());
                Err(match kind {
                    Some(FailureKind::Input) => Loss::Input(message),
                    _ => Loss::Unit(message),
                })
            }
            Ok(None) | Err(_) => Err(self.ended()),
        }
    }

    /// Why the process has ended.
    fn ended(&mut self) -> Loss {
        self.input = None;
        let status = self.wait();
        let said = self.last_words();
        match status {
            Ok(status) if is_from_outside(status) => Loss::Worker(format!("its worker ended with {status}")),
            Ok(status) => Loss::Unit(format!("its worker ended with {status}{said}")),
            Err(error) => Loss::Worker(format!("its worker is lost: {error}")),
        }
    }

    /// Waits for the end of a process that closed its output, without keeping others from ending it.
    fn wait(&self) -> io::Result<ExitStatus> {
        for _ in 0..100 {
            if let Some(status) = lock(&self.child).try_wait()? {
                return Ok(status);
            }
            thread::sleep(Duration::from_millis(20));
        }
        let mut child = lock(&self.child);
        child.kill()?;
        child.wait()
    }

    fn last_words(&mut self) -> String {
        const MOST: u64 = 1 << 14;
        let mut words = Vec::new();
        let length = self.said.seek(SeekFrom::End(0)).unwrap_or(0);
        let from = SeekFrom::Start(length.saturating_sub(MOST));
        let _ = self.said.seek(from).and_then(|_| (&self.said).take(MOST).read_to_end(&mut words));
        let words = String::from_utf8_lossy(&words).trim().to_owned();
        if words.is_empty() { words } else { format!("\n{words}") }
    }
}

impl Worker for ProcessWorker {
    fn render(&mut self, task: &Task) -> Result<Reply, Loss> {
        let request = Request::Unit { stage: task.stage, unit: task.unit };
        let (Response { samples, rays, .. }, bytes) = self.ask(&request, &task.position)?;
        Ok(Reply { bytes, samples, rays })
    }

    fn end(&self) -> Box<dyn Fn() + Send + Sync> {
        let child = Arc::clone(&self.child);
        Box::new(move || {
            // It may have ended by itself.
            let _ = lock(&child).kill();
        })
    }
}

impl Drop for ProcessWorker {
    fn drop(&mut self) {
        // The end of its input ends it; the signal is for one that does not listen.
        self.input = None;
        let mut child = lock(&self.child);
        let _ = child.kill();
        let _ = child.wait();
    }
}

fn lock(child: &Mutex<Child>) -> std::sync::MutexGuard<'_, Child> {
    child.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether somebody ended the process who cannot have meant the unit: by SIGHUP, SIGINT, SIGKILL or SIGTERM.
#[cfg(unix)]
fn is_from_outside(status: ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt;
    let by_signal = status.signal().is_some_and(|signal| [1, 2, 9, 15].contains(&signal));
    // The same signals, heard and turned into an exit code; and 75, interrupted.
    by_signal || status.code().is_some_and(|code| [75, 129, 130, 143].contains(&code))
}

#[cfg(not(unix))]
fn is_from_outside(status: ExitStatus) -> bool {
    status.code().is_some_and(|code| code == 1 || code == 75)
}
