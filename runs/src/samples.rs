//! Samples that can be read again and again.

use core::ops::ControlFlow;

use sinscal::{Sample, Setup, SiteRests, SiteShown};

/// Why samples could not be read.
pub type ReadError = Box<dyn std::error::Error + Send + Sync>;

/// Samples in the order of time, which can be read from the first one on any number of times: a run goes over them once for
/// each pass and does not keep them.
pub trait Samples: Sync {
    /// Gives the samples to `visit`, some consecutive ones at a time, until that breaks off.
    ///
    /// # Errors
    /// When a sample cannot be read.
    fn read(&self, visit: &mut dyn FnMut(&[Sample]) -> ControlFlow<()>) -> Result<(), ReadError>;
}

impl Samples for Vec<Sample> {
    fn read(&self, visit: &mut dyn FnMut(&[Sample]) -> ControlFlow<()>) -> Result<(), ReadError> {
        // whoever breaks off knows why
        let _ = visit(self);
        Ok(())
    }
}

/// Gives each sample to `work`, until there is an error.
///
/// # Errors
/// That of `work`, or of reading.
pub fn each<E: From<ReadError>>(
    samples: &dyn Samples,
    mut work: impl FnMut(&Sample) -> Result<(), E>,
) -> Result<(), E> {
    let mut fault = None;
    samples.read(&mut |samples| match samples.iter().try_for_each(&mut work) {
        Ok(()) => ControlFlow::Continue(()),
        Err(error) => {
            fault = Some(error);
            ControlFlow::Break(())
        }
    })?;
    fault.map_or(Ok(()), Err)
}

/// Times and number of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// Time of the first sample, s.
    pub first: f64,
    /// Time of the last sample, s.
    pub last: f64,
    /// Number of samples.
    pub samples: u64,
}

impl Extent {
    /// Takes in the next sample.
    pub(crate) fn push(&mut self, time: f64) {
        if self.samples == 0 {
            self.first = time;
        }
        self.last = time;
        self.samples += 1;
    }
}

/// Reads samples for what rests in them show of the site; nothing where the gyros do not feel the Earth, or the unit rests in too few
/// positions.
///
/// # Errors
/// When a sample cannot be read.
pub fn site_shown(samples: &dyn Samples, setup: &Setup) -> Result<Option<SiteShown>, ReadError> {
    let Some(mut rests) = SiteRests::new(setup.rate, setup.noise) else { return Ok(None) };
    each::<ReadError>(samples, |sample| {
        rests.push(sample);
        Ok(())
    })?;
    Ok(rests.finish(&setup.site))
}

/// Reads samples for nothing but their times.
///
/// # Errors
/// When a sample cannot be read.
pub fn extent(samples: &dyn Samples) -> Result<Extent, ReadError> {
    let mut extent = Extent::default();
    each::<ReadError>(samples, |sample| {
        extent.push(sample.time);
        Ok(())
    })?;
    Ok(extent)
}
