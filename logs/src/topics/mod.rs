//! Recordings of messages: each topic's numbers as arrays, called `TOPIC.FIELD`.

#[cfg(feature = "bag")]
pub(super) mod bag;
#[cfg(feature = "mcap")]
pub(super) mod mcap;
#[cfg(any(feature = "bag", feature = "mcap"))]
mod messages;
#[cfg(all(test, feature = "bag", feature = "mcap", feature = "ulog"))]
mod tests;
#[cfg(feature = "ulog")]
pub(super) mod ulog;

#[cfg(any(feature = "bag", feature = "mcap"))]
use std::io::Read;

use super::arrays::{Arrays, LARGEST, MOST_VARIABLES, Named};

/// The numbers of all topics that may matter to a log.
#[derive(Default)]
pub(super) struct Topics {
    series: Vec<Series>,
    numbers: u64,
}

/// One field of one topic, message after message.
struct Series {
    name: String,
    width: usize,
    numbers: Vec<f64>,
}

impl Series {
    fn rows(&self) -> usize {
        self.numbers.len() / self.width.max(1)
    }

    fn dims(&self) -> Vec<u64> {
        vec![self.rows() as u64, self.width as u64]
    }

    /// The numbers of a message.
    #[cfg(feature = "ulog")]
    fn row(&self, row: usize) -> Option<&[f64]> {
        self.numbers.get(row * self.width..(row + 1) * self.width)
    }
}

impl Topics {
    /// Begins a field with so many numbers in each message; its place.
    fn declare(&mut self, topic: &str, field: &str, width: usize) -> Result<usize, String> {
        if self.series.len() == MOST_VARIABLES {
            return Err(format!("there are more than {MOST_VARIABLES} fields"));
        }
        self.series.push(Series { name: format!("{topic}.{field}"), width, numbers: Vec::new() });
        Ok(self.series.len() - 1)
    }

    /// Takes in a field of a message.
    fn push(&mut self, place: usize, numbers: &[f64]) -> Result<(), String> {
        self.numbers += numbers.len() as u64;
        let series = self.series.get_mut(place).ok_or("a field is not there")?;
        if self.numbers * 8 > LARGEST || series.numbers.try_reserve(numbers.len()).is_err() {
            return Err(
                "it holds more numbers than fit into memory: record a shorter one, or fewer topics".into()
            );
        }
        series.numbers.extend_from_slice(numbers);
        Ok(())
    }

    /// What there is. Topics without a message are left out.
    fn named(mut self) -> (Self, Vec<Named>) {
        self.series.retain(|series| !series.numbers.is_empty());
        let named = |series: &Series| Named { name: series.name.clone(), dims: Ok(series.dims()) };
        let named = self.series.iter().map(named).collect();
        (self, named)
    }
}

impl Arrays for Topics {
    fn read(&mut self, index: usize, each: &mut dyn FnMut(f64) -> bool) -> Result<(), String> {
        let series = self.series.get(index).ok_or("it is not there")?;
        let _ = series.numbers.iter().all(|number| each(*number));
        Ok(())
    }
}

/// No record is longer, bytes: an image of a camera stays below.
#[cfg(any(feature = "bag", feature = "mcap"))]
const LONGEST: u64 = 256 << 20;

/// The length of what follows; nothing at the end.
#[cfg(any(feature = "bag", feature = "mcap"))]
fn length(bytes: &mut dyn Read) -> Result<Option<u32>, String> {
    let mut length = Vec::new();
    bytes.take(4).read_to_end(&mut length).map_err(|error| error.to_string())?;
    match (length.first_chunk(), length.is_empty()) {
        (Some(length), _) => Ok(Some(u32::from_le_bytes(*length))),
        (None, true) => Ok(None),
        (None, false) => Err("it is cut off".into()),
    }
}

/// So many bytes.
#[cfg(any(feature = "bag", feature = "mcap"))]
fn block(bytes: &mut dyn Read, length: u64, longest: u64) -> Result<Vec<u8>, String> {
    if length > longest {
        return Err(format!("a record says it is {} MiB long", length >> 20));
    }
    let mut block = Vec::new();
    bytes.take(length).read_to_end(&mut block).map_err(|error| error.to_string())?;
    if block.len() as u64 == length { Ok(block) } else { Err("it is cut off".into()) }
}
