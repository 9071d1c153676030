//! One pass over a log for many readers: it is decoded once, the readers work in parallel.

use miette::Result;
use rayon::prelude::*;
use sinscal::Sample;

use crate::say::progress_bar;
use logs::Log;

/// Samples handed over at a time: enough to make a thread's while, few enough to stay in the cache.
const CHUNK: usize = 8192;

/// Something that reads a log from its first sample to its last.
pub(crate) trait Reader: Send {
    /// Takes in the next samples.
    fn read(&mut self, samples: &[Sample]) -> Result<()>;
}

/// First and last time of what was read, s, and the number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent {
    pub(crate) first: f64,
    pub(crate) last: f64,
    pub(crate) samples: u64,
}

/// Reads `log`, up to `seconds` after its first sample where given, for all readers. Each gets every sample in order: what
/// it finds does not depend on the number of threads.
pub(crate) fn broadcast<R: Reader + ?Sized>(
    log: &Log,
    seconds: Option<f64>,
    task: &'static str,
    readers: &mut [Box<R>],
) -> Result<Extent> {
    let bar = progress_bar(log.size(), task);
    let mut extent = Extent { first: f64::NAN, last: f64::NAN, samples: 0 };
    let mut chunk = Vec::with_capacity(CHUNK);
    let mut rows = log.samples()?;
    loop {
        chunk.clear();
        while chunk.len() < CHUNK {
            let Some(sample) = rows.next().transpose()? else { break };
            if extent.first.is_nan() {
                extent.first = sample.time;
            }
            if seconds.is_some_and(|seconds| sample.time > extent.first + seconds) {
                break;
            }
            extent.last = sample.time;
            chunk.push(sample);
        }
        readers.par_iter_mut().try_for_each(|reader| reader.read(&chunk))?;
        extent.samples += chunk.len() as u64;
        bar.set_position(rows.position());
        if chunk.len() < CHUNK {
            bar.finish_and_clear();
            return Ok(extent);
        }
    }
}
