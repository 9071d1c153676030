//! Bags of ROS 1, version 2.0, read record by record.
//!
//! Written here because the crate that reads them, rosbag 0.6, maps the file into memory, where one that is cut while it is read ends the
//! program, and unpacks chunks without bound. A record is a list of fields and data, each behind its length. Reference: Bags/Format/2.0
//! of the ROS wiki.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::ops::Range;
use std::path::Path;

use super::messages::{Encoding, Topic};
use super::{LONGEST, Rewriting, Topics, block, length};
use crate::arrays::Named;
use crate::fault::LogError;
use crate::guard::guarded;
use crate::rewrite::arrays::{Changes, whole};

/// What a bag begins with.
const MAGIC: &[u8; 13] = b"#ROSBAG V2.0\n";
/// No list of fields is longer, bytes.
const LONGEST_FIELDS: u64 = 1 << 20;
/// Kinds of records.
const MESSAGE: u8 = 2;
const CHUNK: u8 = 5;
const CONNECTION: u8 = 7;

/// Reads the topics that may matter.
pub(crate) fn open(path: &Path) -> Result<(Topics, Vec<Named>), LogError> {
    let file = File::open(path).map_err(|error| crate::unreadable(path, &error))?;
    let mut bag = Bag::default();
    guarded(|| {
        let mut file = BufReader::with_capacity(1 << 16, file);
        let mut magic = [0; MAGIC.len()];
        if file.read_exact(&mut magic).is_err() || magic != *MAGIC {
            return Err("it does not begin with #ROSBAG V2.0".to_owned());
        }
        bag.records(&mut file, true)
    })
    .map_err(|problem| {
        LogError::file(path, format!("is no bag of ROS 1, or damaged: {problem}"))
            .help("`rosbag reindex` and `rosbag fix` mend bags; version 2.0 is read here")
    })?;
    Ok(bag.topics.named())
}

/// The bytes of a bag with other numbers in some of its messages. Everything else stays as it is.
pub(crate) fn rewritten(path: &Path, changes: &Changes) -> Result<Vec<u8>, String> {
    let mut bytes = whole(path)?;
    let mut bag = Bag::default();
    bag.records(&mut bytes.get(MAGIC.len()..).unwrap_or_default(), true)?;
    let mut messages = Vec::new();
    find(&bytes, MAGIC.len()..bytes.len(), true, &mut messages)?;
    let mut rewriting = Rewriting::new(bag.topics, changes)?;
    for (connection, message) in messages {
        if let Some(Some(topic)) = bag.connections.get(&connection) {
            topic.write(&mut rewriting, &mut bytes[message])?;
        }
    }
    rewriting.finish()?;
    Ok(bytes)
}

/// Connection and place of the messages in a part of a bag, which has been read.
fn find(
    bytes: &[u8],
    part: Range<usize>,
    outer: bool,
    messages: &mut Vec<(u32, Range<usize>)>,
) -> Result<(), String> {
    let mut at = part.start;
    while at < part.end {
        let mut rest = &bytes[at..part.end];
        let long = length(&mut rest)?.unwrap_or_default();
        let fields = Fields(block(&mut rest, long.into(), LONGEST_FIELDS)?);
        let long = length(&mut rest)?.unwrap_or_default() as usize;
        let first = part.end - rest.len();
        at = first.saturating_add(long);
        if at > part.end {
            return Err("it is cut off".into());
        }
        match fields.get("op") {
            Some([CHUNK]) if outer && fields.get("compression") == Some(b"none") => {
                find(bytes, first..at, false, messages)?;
            }
            Some([CHUNK]) if outer => {
                return Err("the chunks of the log are packed: `rosbag decompress` unpacks them, and what it writes is written here".into());
            }
            Some([MESSAGE]) => messages.extend(fields.number("conn").map(|of| (of, first..at))),
            _ => {}
        }
    }
    Ok(())
}

/// A bag as far as it was read.
#[derive(Default)]
struct Bag {
    topics: Topics,
    connections: HashMap<u32, Option<Topic>>,
}

impl Bag {
    /// Reads records up to the end; chunks within chunks there are none.
    fn records(&mut self, bytes: &mut dyn Read, outer: bool) -> Result<(), String> {
        while let Some(long) = length(bytes)? {
            let fields = Fields(block(bytes, long.into(), LONGEST_FIELDS)?);
            let long = length(bytes)?.ok_or("it is cut off")?;
            let data = block(bytes, long.into(), LONGEST)?;
            match fields.get("op") {
                Some([CHUNK]) if outer => {
                    let size = fields.number("size").ok_or("a chunk has no size")?;
                    if u64::from(size) > LONGEST {
                        return Err(format!("a chunk says it unpacks to {} MiB", size >> 20));
                    }
                    let mut plain: Box<dyn Read + '_> = match fields.get("compression") {
                        Some(b"none") => Box::new(data.as_slice()),
                        Some(b"bz2") => Box::new(bzip2::read::BzDecoder::new(data.as_slice())),
                        Some(b"lz4") => Box::new(lz4_flex::frame::FrameDecoder::new(data.as_slice())),
                        _ => return Err("a chunk is packed in an unknown way".into()),
                    };
                    self.records(&mut plain.by_ref().take(size.into()), false)?;
                }
                Some([CONNECTION]) => self.connect(&fields, &Fields(data))?,
                Some([MESSAGE]) => {
                    let connection = fields.number("conn").and_then(|of| self.connections.get(&of));
                    if let Some(Some(topic)) = connection {
                        topic.read(&mut self.topics, &data)?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn connect(&mut self, fields: &Fields, about: &Fields) -> Result<(), String> {
        let id = fields.number("conn").ok_or("a connection has no number")?;
        if self.connections.contains_key(&id) {
            // told again, in the index
            return Ok(());
        }
        let name = String::from_utf8_lossy(fields.get("topic").unwrap_or_default()).into_owned();
        let kind = String::from_utf8_lossy(about.get("type").unwrap_or_default()).into_owned();
        let topic = Topic::new(&mut self.topics, &name, &kind, Encoding::Ros1)?;
        self.connections.insert(id, topic);
        Ok(())
    }
}

/// `NAME=VALUE`, each behind its length.
struct Fields(Vec<u8>);

impl Fields {
    fn get(&self, wanted: &str) -> Option<&[u8]> {
        let mut rest = self.0.as_slice();
        while let Some((length, after)) = rest.split_first_chunk::<4>() {
            let (field, after) = after.split_at_checked(u32::from_le_bytes(*length) as usize)?;
            let (name, value) = field.split_at(field.iter().position(|byte| *byte == b'=')?);
            if name == wanted.as_bytes() {
                return value.get(1..);
            }
            rest = after;
        }
        None
    }

    fn number(&self, wanted: &str) -> Option<u32> {
        self.get(wanted)?.try_into().ok().map(u32::from_le_bytes)
    }
}
