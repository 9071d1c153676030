//! Files of a kilobyte that announce more than a machine can hold. The program runs within 800 MB of address space, and must end
//! with a message: never by the system, never by an allocation that fails.

use std::fs::{self, File};
use std::io::{Read as _, Write as _};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type as Kind};
use parquet::file::metadata::{
    ColumnChunkMetaData, FileMetaData, ParquetMetaData, ParquetMetaDataWriter, RowGroupMetaData,
};
use parquet::schema::types::{SchemaDescriptor, Type};

use crate::support::{DESCRIPTION, Done};

/// Address space of a run, KiB.
const SPACE: u32 = 800_000;
/// The largest number of 32 bits.
const MOST: i64 = i32::MAX as i64;

/// A number as Thrift's compact protocol writes it.
fn number(value: i64) -> Vec<u8> {
    let mut rest = (value << 1 ^ value >> 63) as u64;
    let mut bytes = Vec::new();
    while rest >= 0x80 {
        bytes.push(rest as u8 | 0x80);
        rest >>= 7;
    }
    bytes.push(rest as u8);
    bytes
}

/// The header of a page: its kind, what it says it unpacks to, the number of bytes that follow, and a structure as field `field`
/// that holds some numbers.
fn header(kind: i64, unpacked: i64, packed: i64, field: u8, numbers: &[i64]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for value in [kind, unpacked, packed] {
        bytes.push(0x15);
        bytes.extend(number(value));
    }
    bytes.push((field - 3) << 4 | 0xc);
    for value in numbers {
        bytes.push(0x15);
        bytes.extend(number(*value));
    }
    bytes.extend([0, 0]);
    bytes
}

/// A header of a page of plain numbers.
fn data(unpacked: i64, packed: i64, values: i64) -> Vec<u8> {
    header(0, unpacked, packed, 5, &[values, 0, 3, 3])
}

/// A Parquet file whose columns all hold these bytes, and whose end says that they hold so many rows in so many bytes.
fn parquet(path: &Path, pages: &[u8], codec: Compression, rows: i64, length: i64) -> Done {
    let names = ["time_s", "dtheta_x", "dtheta_y", "dtheta_z", "dvel_x", "dvel_y", "dvel_z"];
    let field = |name: &&str| {
        let field = Type::primitive_type_builder(name, Kind::DOUBLE).with_repetition(Repetition::REQUIRED);
        field.build().map(Arc::new)
    };
    let fields = names.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    let schema = Type::group_type_builder("log").with_fields(fields).build()?;
    let schema = Arc::new(SchemaDescriptor::new(Arc::new(schema)));
    let mut bytes = b"PAR1".to_vec();
    let mut columns = Vec::new();
    for column in schema.columns() {
        let chunk = ColumnChunkMetaData::builder(Arc::clone(column))
            .set_compression(codec)
            .set_num_values(rows)
            .set_data_page_offset(bytes.len() as i64)
            .set_total_compressed_size(length)
            .set_total_uncompressed_size(length);
        columns.push(chunk.build()?);
        bytes.extend_from_slice(pages);
    }
    let group =
        RowGroupMetaData::builder(Arc::clone(&schema)).set_num_rows(rows).set_column_metadata(columns);
    let file = FileMetaData::new(1, rows, None, None, schema, None);
    ParquetMetaDataWriter::new(&mut bytes, &ParquetMetaData::new(file, vec![group.build()?])).finish()?;
    assert!(bytes.len() < 4096, "a bomb is small");
    Ok(fs::write(path, bytes)?)
}

/// What a NumPy array of the seven columns of PSINS begins with.
fn npy_header(rows: u64) -> Vec<u8> {
    let dictionary = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, 7), }}");
    [b"\x93NUMPY\x01\0\x76\0", format!("{dictionary:<117}\n").as_bytes()].concat()
}

/// A NumPy array of the seven columns of PSINS, and so many bytes of zeros that take no place on the disk.
fn npy(path: &Path, rows: u64, bytes: u64) -> Done {
    let mut file = File::create(path)?;
    file.write_all(&npy_header(rows))?;
    Ok(file.set_len(128 + bytes)?)
}

/// An archive of such an array, so many bytes of which are packed to a thousandth of that.
fn npz(path: &Path, rows: u64, bytes: u64) -> Done {
    let mut archive = zip::ZipWriter::new(File::create(path)?);
    let packed =
        zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    archive.start_file("imu.npy", packed)?;
    archive.write_all(&npy_header(rows))?;
    std::io::copy(&mut std::io::repeat(0).take(bytes), &mut archive)?;
    archive.finish()?;
    Ok(())
}

/// A MATLAB array called imu, of seven columns and as many rows as its header can say.
fn mat(path: &Path) -> Done {
    let mut array = Vec::new();
    let mut element = |kind: u32, size: u32, bytes: &[u8]| {
        array.extend(kind.to_le_bytes());
        array.extend(size.to_le_bytes());
        array.extend(bytes);
        array.resize(array.len().next_multiple_of(8), 0);
    };
    element(6, 8, &[6, 0, 0, 0, 0, 0, 0, 0]);
    element(5, 8, &[&i32::MAX.to_le_bytes()[..], &7_i32.to_le_bytes()].concat());
    element(1, 3, b"imu");
    element(9, u32::MAX - 7, &[0; 64]);
    let mut bytes = vec![b' '; 124];
    bytes.extend(b"\x00\x01IM");
    bytes.extend(14_u32.to_le_bytes());
    bytes.extend((array.len() as u32).to_le_bytes());
    bytes.extend(array);
    Ok(fs::write(path, bytes)?)
}

/// A sound HDF5 file whose array of 30 rows says it had thousands of millions.
fn hdf5(path: &Path) -> Done {
    let mut bytes = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/small-plain.h5"))?;
    let shape = |rows: u64| [rows.to_le_bytes(), 7_u64.to_le_bytes()].concat();
    let places: Vec<usize> =
        (0..bytes.len() - 16).filter(|place| bytes[*place..].starts_with(&shape(30))).collect();
    assert!(!places.is_empty());
    for place in places {
        bytes[place..place + 16].copy_from_slice(&shape(3_000_000_000));
    }
    Ok(fs::write(path, bytes)?)
}

/// What is wrong with how the program refuses the only table of a folder.
fn complaint(folder: &Path, expected: &[&str]) -> Result<Option<String>, Box<dyn std::error::Error>> {
    fs::write(folder.join("log.toml"), DESCRIPTION)?;
    let output = Command::new("bash")
        .args(["-c", &format!("ulimit -v {SPACE} && exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_sinscal")])
        .args(["calibrate", "log", "--filter", "36d-p", "--out", "results"])
        .env("RAYON_NUM_THREADS", "1")
        .env("MALLOC_ARENA_MAX", "1")
        .current_dir(folder)
        .output()?;
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    let said = expected.iter().all(|part| message.contains(part));
    let clean =
        output.status.code() == Some(1) && output.stdout.is_empty() && !folder.join("results").exists();
    Ok((!said || !clean).then(|| format!("{expected:?}: {}\n{message}", output.status)))
}

#[test]
fn what_announces_more_than_there_is_room_for_is_refused() -> Done {
    let sound = [data(80, 80, 10), vec![0; 80]].concat();
    let swollen = [data(MOST, 4, 10), vec![0; 4]].concat();
    let dictionary = [header(2, 80, 80, 7, &[MOST, 0]), vec![0; 80], sound.clone()].concat();
    let damaged = [vec![0x7f; 40], sound.clone()].concat();
    type Make = Box<dyn Fn(&Path) -> Done>;
    let chunk =
        |pages: Vec<u8>, codec: Compression, rows: i64, length: Option<i64>| -> (&'static str, Make) {
            let length = length.unwrap_or(pages.len() as i64);
            ("log.parquet", Box::new(move |path| parquet(path, &pages, codec, rows, length)))
        };
    let plain = Compression::UNCOMPRESSED;
    let cases: [((&str, Make), &[&str]); 10] = [
        (
            chunk(swollen, Compression::SNAPPY, 10, None),
            &["log.parquet, column `time_s`", "unpacks to 2047 MiB, and up to 32 MiB are read"],
        ),
        (
            chunk(dictionary, plain, 10, None),
            &["column `time_s`", "a dictionary says it holds 2147483647 numbers in 80 bytes"],
        ),
        (
            chunk(sound.clone(), plain, 5_000_000_000, None),
            &["log.parquet: is damaged", "it holds 10 rows, 5000000000 were announced"],
        ),
        (
            chunk(sound, plain, 10, Some(1 << 40)),
            &["column `time_s`", "its pages would lie beyond the end of the file"],
        ),
        (chunk(damaged, plain, 10, None), &["column `time_s`", "the header of a page is damaged"]),
        (
            ("log.npy", Box::new(|path| npy(path, 3_000_000_000, 0))),
            &["log.npy: holds 3000000000 rows, 156.5 GiB of numbers", "up to 2 GiB"],
        ),
        (
            ("log.npy", Box::new(|path| npy(path, 30_000_000, 30_000_000 * 56))),
            &["log.npy, variable `array`: does not fit into the memory of this machine", "Parquet or CSV"],
        ),
        (
            ("log.npz", Box::new(|path| npz(path, 30_000_000, 50_000_000))),
            &["log.npz, variable `imu`: cannot be read", "damaged or cut off"],
        ),
        (("log.mat", Box::new(mat)), &["log.mat: holds 2147483647 rows", "up to 2 GiB"]),
        (("log.h5", Box::new(hdf5)), &["log.h5", "numbers, it says, more than there can be in the file"]),
    ];
    let mut complaints = Vec::new();
    for ((name, make), expected) in &cases {
        let folder = tempfile::tempdir()?;
        make(&folder.path().join(name))?;
        complaints.extend(complaint(folder.path(), expected)?);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    Ok(())
}
