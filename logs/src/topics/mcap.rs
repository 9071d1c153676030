//! MCAP, as ROS 2 and others record, read record by record.
//!
//! Written here because the crate that reads it, mcap 0.26, brings 25 others and a second build of Zstandard, for the heads of a few
//! records: an operation, a length, and fields one after the other. Reference: MCAP Format Specification, mcap.dev.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::ops::Range;
use std::path::Path;

use super::messages::{Encoding, Topic};
use super::{LONGEST, Rewriting, Topics, block};
use crate::arrays::Named;
use crate::fault::LogError;
use crate::guard::guarded;
use crate::rewrite::arrays::{Changes, whole};

/// What a recording begins with.
const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";
/// Kinds of records.
const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
const CHUNK: u8 = 6;
const DATA_END: u8 = 15;
/// Of a message before its contents: channel, number, two times.
const MESSAGE_HEAD: usize = 2 + 4 + 8 + 8;

/// Reads the topics that may matter.
pub(crate) fn open(path: &Path) -> Result<(Topics, Vec<Named>), LogError> {
    let file = File::open(path).map_err(|error| crate::unreadable(path, &error))?;
    let mut recording = Recording::default();
    guarded(|| {
        let mut file = BufReader::with_capacity(1 << 16, file);
        let mut magic = [0; MAGIC.len()];
        if file.read_exact(&mut magic).is_err() || magic != *MAGIC {
            return Err("it does not begin with MCAP0".to_owned());
        }
        match recording.records(&mut file, true)? {
            true => Ok(()),
            false => Err("it has no end".into()),
        }
    })
    .map_err(|problem| {
        LogError::file(path, format!("is no MCAP recording, or damaged: {problem}"))
            .help("messages of ROS 1 and ROS 2, plain or packed with Zstandard or LZ4, are read; `mcap recover` mends what was cut off")
    })?;
    Ok(recording.topics.named())
}

/// The bytes of a recording with other numbers in some of its messages, and without the checksums of what these stand in. Everything
/// else stays as it is.
pub(crate) fn rewritten(path: &Path, changes: &Changes) -> Result<Vec<u8>, String> {
    let mut bytes = whole(path)?;
    let mut recording = Recording::default();
    recording.records(&mut bytes.get(MAGIC.len()..).unwrap_or_default(), true)?;
    let mut found = Found::default();
    found.records(&bytes, MAGIC.len()..bytes.len(), true)?;
    let mut rewriting = Rewriting::new(recording.topics, changes)?;
    for (channel, message) in found.messages {
        if let Some(Some(topic)) = recording.channels.get(&channel) {
            topic.write(&mut rewriting, &mut bytes[message])?;
        }
    }
    rewriting.finish()?;
    // which says that there is none
    found.checksums.into_iter().for_each(|checksum| bytes[checksum].fill(0));
    Ok(bytes)
}

/// Where things stand in a recording.
#[derive(Default)]
struct Found {
    /// Channel and place of the messages.
    messages: Vec<(u16, Range<usize>)>,
    /// Places of the checksums of chunks and of all data.
    checksums: Vec<Range<usize>>,
}

impl Found {
    /// Finds what stands in a part of a recording, which has been read.
    fn records(&mut self, bytes: &[u8], part: Range<usize>, outer: bool) -> Result<(), String> {
        let mut at = part.start;
        while let Some([operation, length @ ..]) = bytes[at..part.end].first_chunk::<9>() {
            let length = usize::try_from(u64::from_le_bytes(*length)).ok();
            let first = at + 9;
            at = length.and_then(|length| first.checked_add(length)).ok_or("a record is too long")?;
            let data = bytes.get(first..at).filter(|_| at <= part.end).ok_or("it is cut off")?;
            let mut fields = Fields(data);
            match *operation {
                MESSAGE => self.messages.push((fields.short()?, first + MESSAGE_HEAD..at)),
                CHUNK if outer => {
                    let checksum = first + CHUNK_TIMES;
                    fields.take::<CHUNK_TIMES>()?;
                    fields.take::<4>()?;
                    if !fields.text()?.is_empty() {
                        return Err(
                            "the chunks of the log are packed: `mcap decompress` unpacks them, and what it writes is written here".into()
                        );
                    }
                    fields.take::<8>()?;
                    self.checksums.push(checksum..checksum + 4);
                    self.records(bytes, at - fields.0.len()..at, false)?;
                }
                DATA_END if outer => {
                    fields.take::<4>()?;
                    self.checksums.push(first..first + 4);
                    return Ok(());
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// Of a chunk before its checksum: times of its first and last message, and its size.
const CHUNK_TIMES: usize = 8 + 8 + 8;

/// A recording as far as it was read.
#[derive(Default)]
struct Recording {
    topics: Topics,
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Option<Topic>>,
}

impl Recording {
    /// Reads records up to the end of the data, and whether that was there; chunks within chunks there are none.
    fn records(&mut self, bytes: &mut dyn Read, outer: bool) -> Result<bool, String> {
        loop {
            let head = block(bytes, 9, 9);
            let Ok([operation, length @ ..]) = head.as_deref() else { return Ok(false) };
            let length = length.first_chunk().map_or(0, |length| u64::from_le_bytes(*length));
            let data = block(bytes, length, LONGEST)?;
            let mut fields = Fields(&data);
            match *operation {
                SCHEMA => {
                    let id = fields.short()?;
                    self.schemas.insert(id, fields.text()?);
                }
                CHANNEL => self.channel(&mut fields)?,
                MESSAGE => {
                    let id = fields.short()?;
                    let message = data.get(MESSAGE_HEAD..).ok_or("a message is cut off")?;
                    if let Some(Some(topic)) = self.channels.get(&id) {
                        topic.read(&mut self.topics, message)?;
                    }
                }
                CHUNK if outer => self.chunk(&mut fields)?,
                DATA_END if outer => return Ok(true),
                _ => {}
            }
        }
    }

    fn channel(&mut self, fields: &mut Fields<'_>) -> Result<(), String> {
        let (id, schema) = (fields.short()?, fields.short()?);
        let (name, encoding) = (fields.text()?, fields.text()?);
        // a channel is told again in each chunk
        if self.channels.contains_key(&id) {
            return Ok(());
        }
        let encoding = match encoding.as_str() {
            "ros1" => Some(Encoding::Ros1),
            "cdr" => Some(Encoding::Cdr),
            _ => None,
        };
        let topic = match self.schemas.get(&schema).zip(encoding) {
            Some((kind, encoding)) => Topic::new(&mut self.topics, &name, kind, encoding)?,
            None => None,
        };
        self.channels.insert(id, topic);
        Ok(())
    }

    fn chunk(&mut self, fields: &mut Fields<'_>) -> Result<(), String> {
        // times of its first and last message
        fields.take::<16>()?;
        let size = u64::from_le_bytes(fields.take()?);
        // a checksum
        fields.take::<4>()?;
        let packing = fields.text()?;
        let length = u64::from_le_bytes(fields.take()?);
        let packed = usize::try_from(length).ok().and_then(|length| fields.0.get(..length));
        let packed = packed.ok_or("a chunk is cut off")?;
        if size > LONGEST {
            return Err(format!("a chunk says it unpacks to {} MiB", size >> 20));
        }
        let mut plain: Box<dyn Read + '_> = match packing.as_str() {
            "" => Box::new(packed),
            "zstd" => Box::new(zstd::Decoder::new(packed).map_err(|error| error.to_string())?),
            "lz4" => Box::new(lz4_flex::frame::FrameDecoder::new(packed)),
            _ => return Err(format!("a chunk is packed with {}", crate::fault::shown(&packing, 32))),
        };
        self.records(&mut plain.by_ref().take(size), false).map(drop)
    }
}

/// The fields of a record.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or("a record is cut off")?;
        self.0 = rest;
        Ok(*bytes)
    }

    fn short(&mut self) -> Result<u16, String> {
        self.take().map(u16::from_le_bytes)
    }

    fn text(&mut self) -> Result<String, String> {
        let length = u32::from_le_bytes(self.take()?) as usize;
        let (text, rest) = self.0.split_at_checked(length).ok_or("a record is cut off")?;
        self.0 = rest;
        Ok(String::from_utf8_lossy(text).into_owned())
    }
}
