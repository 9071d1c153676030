//! ULog, as PX4 records: `sensor_combined.gyro_rad`, `vehicle_attitude.q` ..., with a number behind further instances of a topic.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::Path;

use px4_ulog::stream_parser::LogParser;
use px4_ulog::stream_parser::model::{DataMessage, FlattenedField, FlattenedFieldType};

use super::{Rewriting, Topics};
use crate::arrays::Named;
use crate::fault::LogError;
use crate::guard::guarded;
use crate::rewrite::arrays::{Changes, whole};

/// Topics that may matter: those whose names begin so.
const TOPICS: [&str; 12] = [
    "sensor_combined",
    "sensor_gyro",
    "sensor_accel",
    "sensor_gps",
    "vehicle_imu",
    "vehicle_angular_velocity",
    "vehicle_acceleration",
    "vehicle_attitude",
    "vehicle_local_position",
    "vehicle_gps_position",
    "vehicle_visual_odometry",
    "vehicle_mocap_odometry",
];
/// Of these, what is no measurement.
const OTHERS: [&str; 2] = ["_setpoint", "_status"];
/// So much is read at a time, bytes.
const PIECE: usize = 1 << 16;

/// Reads the topics that may matter.
pub(crate) fn open(path: &Path) -> Result<(Topics, Vec<Named>), LogError> {
    let mut file = File::open(path).map_err(|error| crate::unreadable(path, &error))?;
    let (topics, _) = guarded(|| read(&mut file)).map_err(|problem| {
        LogError::file(path, format!("is no ULog of PX4, or damaged: {problem}"))
            .help("what PX4 writes to log/*.ulg is read here")
    })?;
    Ok(topics.named())
}

/// Where one field with all its elements stands.
struct Field {
    place: usize,
    elements: Vec<FlattenedField>,
}

/// The fields of each kind of message.
type Fields = HashMap<u16, Vec<Field>>;

/// The bytes of a file with other numbers in some of its fields. Everything else stays as it is.
pub(crate) fn rewritten(path: &Path, changes: &Changes) -> Result<Vec<u8>, String> {
    let mut bytes = whole(path)?;
    let (topics, fields) = read(&mut bytes.as_slice())?;
    let mut rewriting = Rewriting::new(topics, changes)?;
    for (id, data) in data_messages(&bytes) {
        for field in fields.get(&id).into_iter().flatten() {
            let numbers = rewriting.next(field.place)?.unwrap_or_default();
            for (element, number) in field.elements.iter().zip(numbers) {
                put(&mut bytes[data.clone()], element, *number)?;
            }
        }
    }
    rewriting.finish()?;
    Ok(bytes)
}

/// What stands before the first message, bytes.
const HEADER: usize = 16;

/// Kind and place of the messages that hold data, from one end of the file to the other.
fn data_messages(bytes: &[u8]) -> Vec<(u16, Range<usize>)> {
    let mut found = Vec::new();
    let mut at = HEADER;
    while let Some([low, high, kind]) = bytes.get(at..).and_then(|rest| rest.first_chunk()).copied() {
        let data = at + 3..at + 3 + usize::from(u16::from_le_bytes([low, high]));
        at = data.end;
        let id = bytes.get(data.clone()).and_then(|data| data.first_chunk()).copied();
        found.extend(id.filter(|_| kind == b'D').map(|id| (u16::from_le_bytes(id), data)));
    }
    found
}

/// Writes a number into a message.
fn put(data: &mut [u8], field: &FlattenedField, number: f64) -> Result<(), String> {
    let at = usize::from(field.offset);
    let bytes: &[u8] = match field.field_type {
        FlattenedFieldType::Float => &(number as f32).to_le_bytes(),
        FlattenedFieldType::Double => &number.to_le_bytes(),
        _ => return Err("its numbers are whole: what is taken out of them does not fit in".into()),
    };
    data.get_mut(at..at + bytes.len()).ok_or("a message is shorter than its format")?.copy_from_slice(bytes);
    Ok(())
}

/// What the topics that may matter hold, and where in a message it stands.
fn read(file: &mut impl Read) -> Result<(Topics, Fields), String> {
    let mut topics = Topics::default();
    let mut known = Fields::new();
    let mut failure = None;
    let mut take = |message: &DataMessage<'_>| {
        if failure.is_some() {
            return;
        }
        let mut taken = || {
            let known = match known.entry(message.msg_id) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => new.insert(fields(&mut topics, message)?),
            };
            for field in known {
                let numbers: Option<Vec<f64>> =
                    field.elements.iter().map(|element| number(message.data, element)).collect();
                topics.push(field.place, &numbers.ok_or("a message is shorter than its format")?)?;
            }
            Ok::<_, String>(())
        };
        failure = taken().err();
    };
    let mut parser = LogParser::default();
    parser.set_data_message_callback(&mut take);
    let mut piece = vec![0; PIECE];
    loop {
        let read = file.read(&mut piece).map_err(|error| error.to_string())?;
        if read == 0 {
            break;
        }
        parser.consume_bytes(&piece[..read]).map_err(|error| error.to_string())?;
    }
    drop(parser);
    failure.map_or(Ok((topics, known)), Err)
}

/// The fields of a topic that may matter, elements of an array together.
fn fields(topics: &mut Topics, message: &DataMessage<'_>) -> Result<Vec<Field>, String> {
    let format = message.flattened_format;
    let name = format.message_name();
    if !TOPICS.iter().any(|topic| name.starts_with(topic)) || OTHERS.iter().any(|other| name.ends_with(other))
    {
        return Ok(Vec::new());
    }
    let topic = match message.multi_id.value() {
        0 => name.to_owned(),
        instance => format!("{name}_{instance}"),
    };
    let mut arrays: Vec<(&str, Vec<FlattenedField>)> = Vec::new();
    for field in format.field_iter() {
        let name = field.flattened_field_name.as_str();
        let name = name.split_once('[').map_or(name, |(name, _)| name);
        match arrays.last_mut().filter(|(last, _)| *last == name) {
            Some((_, elements)) => elements.push(field.clone()),
            None => arrays.push((name, vec![field.clone()])),
        }
    }
    let arrays = arrays.into_iter().filter(|(name, _)| !name.starts_with("_padding"));
    arrays
        .map(|(name, elements)| Ok(Field { place: topics.declare(&topic, name, elements.len())?, elements }))
        .collect()
}

/// A number of a message.
fn number(data: &[u8], field: &FlattenedField) -> Option<f64> {
    let bytes = data.get(usize::from(field.offset)..)?;
    macro_rules! number {
        ($kind:ty) => {
            <$kind>::from_le_bytes(*bytes.first_chunk()?) as f64
        };
    }
    Some(match field.field_type {
        FlattenedFieldType::Int8 => number!(i8),
        FlattenedFieldType::UInt8 | FlattenedFieldType::Bool | FlattenedFieldType::Char => number!(u8),
        FlattenedFieldType::Int16 => number!(i16),
        FlattenedFieldType::UInt16 => number!(u16),
        FlattenedFieldType::Int32 => number!(i32),
        FlattenedFieldType::UInt32 => number!(u32),
        FlattenedFieldType::Int64 => number!(i64),
        FlattenedFieldType::UInt64 => number!(u64),
        FlattenedFieldType::Float => number!(f32),
        FlattenedFieldType::Double => number!(f64),
    })
}
