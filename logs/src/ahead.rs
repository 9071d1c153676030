//! Reading ahead: rows are decoded and checked in a thread of their own while the filter works on those before.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use sinscal::Sample;

use super::{Bridged, LogError, Samples};

/// Samples that change hands together: about 100 kB.
const CHUNK: usize = 512;
/// Chunks that wait at most.
const WAITING: usize = 4;

/// Some consecutive samples of a log.
pub struct Chunk {
    pub samples: Vec<Sample>,
    /// How far reading had come after them, out of the log's size.
    pub position: u64,
    /// What was put into gaps up to there.
    pub bridged: Bridged,
}

/// The end of the log is told in so many words: a thread that breaks off must not pass for it.
type Message = Option<Result<Chunk, LogError>>;

/// The chunks of a log in order; ends after the first error. The same samples as [`Samples`] gives.
pub struct Ahead {
    receiver: Receiver<Message>,
    ended: bool,
}

impl Ahead {
    pub(super) fn new(mut samples: Samples) -> Result<Self, LogError> {
        let (sender, receiver) = sync_channel(WAITING);
        thread::Builder::new()
            .name("reader".into())
            .spawn(move || {
                // whoever listens may have gone away after an error
                let _ = send(&mut samples, &sender);
            })
            .map_err(|error| LogError::message(format!("no thread to read with: {error}")))?;
        Ok(Self { receiver, ended: false })
    }
}

/// Sends everything; `None` when nobody listens any more.
fn send(rows: &mut Samples, to: &SyncSender<Message>) -> Option<()> {
    loop {
        let mut samples = Vec::with_capacity(CHUNK);
        let mut fault = None;
        while samples.len() < CHUNK && fault.is_none() {
            match rows.next() {
                Some(Ok(sample)) => samples.push(sample),
                Some(Err(error)) => fault = Some(error),
                None => break,
            }
        }
        let last = samples.len() < CHUNK;
        to.send(Some(Ok(Chunk { samples, position: Samples::position(rows), bridged: rows.bridged() })))
            .ok()?;
        if let Some(fault) = fault {
            to.send(Some(Err(fault))).ok()?;
        }
        if last {
            return to.send(None).ok();
        }
    }
}

impl Iterator for Ahead {
    type Item = Result<Chunk, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let message = match self.receiver.recv() {
            Ok(message) => message,
            Err(_) => Some(Err(LogError::message("the reading of the log broke off".into()))),
        };
        self.ended = !matches!(message, Some(Ok(_)));
        message
    }
}
