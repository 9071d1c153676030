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
use super::rewrite::arrays::Changes;

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
}

/// The numbers of a recording as they will be, message after message.
struct Rewriting<'a> {
    topics: Topics,
    changes: &'a Changes,
    /// How many messages of each field have been asked for.
    rows: Vec<usize>,
}

impl<'a> Rewriting<'a> {
    fn new(mut topics: Topics, changes: &'a Changes) -> Result<Self, String> {
        for (place, series) in topics.series.iter_mut().enumerate().filter(|(place, _)| changes.has(*place)) {
            changes.apply(place, &series.dims(), &mut series.numbers)?;
        }
        Ok(Self { rows: vec![0; topics.series.len()], topics, changes })
    }

    /// What the next message has in a field; nothing where that does not change.
    fn next(&mut self, place: usize) -> Result<Option<&[f64]>, String> {
        if !self.changes.has(place) {
            return Ok(None);
        }
        let (row, series) = (self.rows[place], &self.topics.series[place]);
        self.rows[place] += 1;
        let numbers = series.numbers.get(row * series.width..(row + 1) * series.width);
        numbers.map(Some).ok_or_else(|| MEANWHILE.to_owned())
    }

    /// Whether every message that was read has been asked for.
    fn finish(self) -> Result<(), String> {
        let series = self.topics.series.iter().enumerate().zip(self.rows);
        let whole = |((place, series), rows): ((usize, &Series), usize)| {
            !self.changes.has(place) || series.rows() == rows
        };
        if series.into_iter().all(whole) { Ok(()) } else { Err(MEANWHILE.into()) }
    }
}

/// Why what was read and what is written do not go together.
const MEANWHILE: &str = "its messages do not follow each other as they were read";

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
#[cfg(feature = "bag")]
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
