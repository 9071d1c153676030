//! Files that are no logs, or not this program's, or that tools write differently.

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use arrow_array::types::Int32Type;
use arrow_array::{
    ArrayRef, BooleanArray, Decimal128Array, DictionaryArray, Float16Array, Float64Array, Int64Array,
    LargeStringArray, ListArray, RecordBatch, StructArray, TimestampMicrosecondArray, UInt8Array,
};
use arrow_schema::{DataType, Field};
use parquet::arrow::ArrowWriter;

use crate::broken_inputs::{Break, check};
use crate::support::{DESCRIPTION, Done, Table};
use Break::{Bytes, Csv, Files, Rows};

/// Rewrites a line of a table counted from 0, the header.
fn line(text: &str, number: usize, change: impl Fn(&str) -> String) -> Vec<u8> {
    let lines = text.lines().enumerate();
    let lines = lines.map(|(at, line)| if at == number { change(line) } else { line.to_owned() });
    (lines.collect::<Vec<_>>().join("\n") + "\n").into()
}

#[test]
fn text_as_tools_write_it() -> Done {
    check(vec![
        (
            Csv(|text| {
                let rows = text.split_once('\n').map_or("", |(_, rows)| rows);
                rows.replace(',', ";").replace('.', ",").into()
            }),
            &["line 1 holds numbers, the names of the columns were expected"],
        ),
        (
            Csv(|text| text.split_once('\n').map_or("", |(_, rows)| rows).replace(',', "\t").into()),
            &["line 1 holds numbers"],
        ),
        (
            Csv(|text| line(&text, 0, |header| header.replace("dvel_y", "dvel_x"))),
            &["column `dvel_x`: stands there twice", "column `dvel_y`: is missing"],
        ),
        (Csv(|text| line(&text, 0, |header| format!("{header},"))), &["column 27 has no name"]),
        (Csv(|text| line(&text, 0, |header| header.replace('_', " "))), &["none of its columns", "time_s"]),
        (
            Csv(|text| line(&text, 0, |header| header.replace("time_s", "time"))),
            &["column `time`: is not a column", "did you mean `time_s`?"],
        ),
        (Csv(|text| line(&text, 9, |row| row.replace('.', ","))), &["row 9: has", "written with a point"]),
        (Csv(|text| line(&text, 9, |row| format!("{row},"))), &["row 9: has 27 fields, the header has 26"]),
        (
            Csv(|text| line(&text, 9, |_| "the operator stopped here".into())),
            &[
                "line 10, row 9: `the operator stopped here` has 1 field, the header has 26",
                "fields are missing",
            ],
        ),
        (
            Csv(|text| line(&text, 9, |_| "# paused".into())),
            &["line 10, row 9: `# paused`", "comments are not read"],
        ),
        (
            Csv(|text| text.replace('\n', "\n\n").replacen("30.5", "?", 1).into()),
            &["line 3, row 1, column `temp_y`: `?` is not a number"],
        ),
        (
            Csv(|text| line(&text, 9, |row| row.replace("30.5", "0x1e"))),
            &["line 10, row 9, column `temp_y`: `0x1e` is not a number", "a plain number such as -1.5e-3"],
        ),
        (
            Csv(|text| line(&text, 9, |row| row.replace("30.5", "30.5 C"))),
            &["`30.5 C` is not a number", "no unit"],
        ),
        (
            Csv(|text| line(&text, 9, |row| row.replacen("0.18", "1'000.18", 1))),
            &["row 9, column `time_s`: `1'000.18` is not a number", "plain numbers"],
        ),
        (
            Csv(|text| line(&text, 9, |row| row.replacen("0.18", "\"1,000.18\"", 1))),
            &["row 9, column `time_s`: `1,000.18` is not a number", "as plain numbers such as 12.34"],
        ),
        (
            Csv(|text| line(&text, 9, |row| row.replacen("0.18", "\"0.18", 1))),
            &["line 10, row 9: has a quote that does not end"],
        ),
        (
            Csv(|text| line(&text, 0, |header| header.replace("dvel_x", "dvel_x [m/h]"))),
            &["column `dvel_x [m/h]`: `m/h` is not a unit of it", "did you mean `m/s`?"],
        ),
        (
            Csv(|text| line(&text, 9, |row| row.replace("30.5", "\x1b[31m"))),
            &["row 9, column `temp_y`: `\u{fffd}[31m` is not a number"],
        ),
        (
            Csv(|text| {
                let (header, rows) = text.split_once('\n').unwrap_or_default();
                format!("{header}\n{}", rows.replace('.', ",")).into()
            }),
            &["line 2, row 1: has", "decimal commas?"],
        ),
        (Csv(|text| text.replace('\n', "\r").into()), &["log.csv: ends its lines as old Macs did"]),
        (
            Csv(|text| text.replace('\n', "\r").repeat(20).into()),
            &["log.csv: no line end within 64 KiB, but CR"],
        ),
        (
            Csv(|text| {
                let (start, end) = text.split_once("temp_y").unwrap_or_default();
                [start.as_bytes(), b"temp_y \xb0C", end.as_bytes()].concat()
            }),
            &["log.csv: line 1 is not UTF-8 text after `temp_y `", "save it as UTF-8"],
        ),
        (
            Csv(|text| {
                let columns: Vec<String> = (0..60).map(|column| format!(",odd{column}")).collect();
                line(&text, 0, |header| header.to_owned() + &columns.concat())
            }),
            &["column `odd0`: is not a column", "and 40 more faults like these"],
        ),
        (
            Csv(|text| line(&text, 9, |row| row.replace("30.5", "--"))),
            &["row 9, column `temp_y`: `--` is not"],
        ),
        (Csv(|text| line(&text, 9, |row| row.replace("30.5", "1e999"))), &["row 9, column `temp_y`: is inf"]),
        (
            Csv(|text| line(&text, 9, |row| row.replacen("0.18", "00:61:00.18", 1))),
            &["row 9, column `time_s`: `00:61:00.18` is not a number", "times of a day such as 22:13:20.005"],
        ),
        (Csv(|text| [text.as_bytes(), b"\xe9\xe8,1,2\n"].concat()), &["row 401: is not text", "UTF-8"]),
        (
            Csv(|text| [text.as_bytes(), b"\0\0\0\0\0\0\0\0"].concat()),
            &["row 401: `\u{fffd}", "has 1 field, the header has 26"],
        ),
        (
            Csv(|text| format!("{text}{text}").into()),
            &["line 402, row 401", "`time_s` is not a number", "were two files joined?"],
        ),
        (
            Csv(|text| {
                let header = text.lines().next().unwrap_or_default();
                format!("{header}\n{}\n", text.lines().nth(1).unwrap_or_default()).into()
            }),
            &["log.csv: has a single row: nothing can be estimated from it"],
        ),
        (Csv(|text| text.lines().next().unwrap_or_default().into()), &["log.csv: has no rows"]),
        (Csv(|_| "\n\n\n".into()), &["log.csv: is empty"]),
        (Csv(|_| "\u{feff}".into()), &["log.csv"]),
        (Csv(|_| b"\x1f\x8b\x08\0\0\0\0\0\0\0".into()), &["log.csv: is packed by gzip", "unpack it"]),
        (
            Csv(|_| b"PK\x03\x04\x14\0\x06\0".into()),
            &["log.csv: is a zip archive, as spreadsheets are", "export"],
        ),
        (
            Csv(|_| b"\x89HDF\r\n\x1a\n".into()),
            &["log.csv: is an HDF5 file, its ending says CSV", "call it .h5"],
        ),
        (Csv(|_| b"<!DOCTYPE html><html><body>Sign in</body></html>".into()), &["none of its columns"]),
        (Csv(|_| b"{\"time_s\": [0.02], \"dtheta_x\": [0]}".into()), &["none of its columns"]),
    ])
}

/// The same table as other programs write it: its estimates are the same to the last digit.
#[test]
fn text_in_other_dialects_is_read() -> Done {
    let estimates = |text: &str| -> Result<String, Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
        fs::write(folder.path().join("log.csv"), text)?;
        let run = Command::new(env!("CARGO_BIN_EXE_sinscal"))
            .args(["calibrate", "log", "--filter", "36d-p", "--json", "-"])
            .current_dir(folder.path())
            .output()?;
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let json: serde_json::Value = serde_json::from_slice(&run.stdout)?;
        Ok(json["parameters"].to_string())
    };
    let text = Table::at_rest(400).csv();
    let plain = estimates(&text)?;
    let units = "\ns,rad,rad,rad,m/s,m/s,m/s,C,C,C,C,C,C,,,,,,,,,,,,,\n";
    for other in [
        text.replace(',', "\t"),
        text.replace(',', "|"),
        text.replace(',', ";"),
        text.replace(',', "  "),
        text.replace(',', ";").replace('.', ","),
        format!("# a comment, with words\n{text}"),
        format!("# {text}"),
        format!("\u{feff}sep=,\n{text}"),
        format!("Fs,50\nserial,12\n\n{text}"),
        text.replacen('\n', units, 1),
        text.replace("dvel_x", "dvel_x [m/s]").replace("dvel_y", "\"dvel_y (m s^-1)\""),
    ] {
        assert_eq!(estimates(&other)?, plain, "{}", other.lines().take(3).collect::<Vec<_>>().join("\n"));
    }
    Ok(())
}

/// Not worth a word: empty lines at the end, and no line end there.
#[test]
fn harmless_ends_are_read() -> Done {
    for end in ["\n\n\n", "\r\n \r\n", ""] {
        let folder = tempfile::tempdir()?;
        fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
        let text = Table::at_rest(400).csv();
        fs::write(folder.path().join("log.csv"), text.trim_end().to_owned() + end)?;
        let run = Command::new(env!("CARGO_BIN_EXE_sinscal"))
            .args(["calibrate", "log", "--filter", "36d-p", "--json", "-"])
            .current_dir(folder.path())
            .output()?;
        assert!(run.status.success(), "{end:?}: {}", String::from_utf8_lossy(&run.stderr));
        assert!(String::from_utf8_lossy(&run.stdout).contains("\"samples\": 400"), "{end:?}");
    }
    Ok(())
}

#[test]
fn rows_that_say_nothing() -> Done {
    check(vec![
        (Rows(|t| t.drop_rows(2..=400)), &["has a single row: nothing can be estimated from it"]),
        (
            Rows(|t| {
                ["vel", "pos", "quat"].iter().for_each(|of| t.map(&format!("ref_{of}_*"), |_, _| f64::NAN))
            }),
            &["no update was made", "no row has such a reference"],
        ),
        (Rows(|t| t.map("time_s", |_, _| 0.02)), &["row 2, column `time_s`: 0.02 s repeats"]),
        (Rows(|t| t.map("time_s", |_, time| -time)), &["row 2, column `time_s`: -0.04 s follows -0.02 s"]),
        (Rows(|t| t.map("dvel_z", |_, _| f64::NAN)), &["row 1, column `dvel_z`: is NaN", "up to row 400"]),
        (Rows(|t| t.set("dtheta_x", 400, f64::NEG_INFINITY)), &["row 400, column `dtheta_x`: is -inf"]),
        (Rows(|t| t.set("ref_vel_e", 12, 3e8)), &["row 12, column `ref_vel_e`: is 300000000"]),
        (Rows(|t| t.set("ref_pos_n", 12, 3.55e6)), &["row 12, column `ref_pos_n`: is 3550000"]),
        (Rows(|t| t.set("temp_x", 12, -273.15)), &["row 12, column `temp_x`: is -273.15"]),
    ])
}

/// A Parquet file with one column replaced.
fn column(folder: &Path, name: &str, array: ArrayRef) -> io::Result<()> {
    let table = Table::at_rest(400);
    let columns = table.columns.iter().map(|(column, values)| {
        let usual: ArrayRef = Arc::new(Float64Array::from(values.clone()));
        (column.clone(), if column == name { Arc::clone(&array) } else { usual })
    });
    let failed = |error: &dyn std::fmt::Display| io::Error::other(error.to_string());
    let batch = RecordBatch::try_from_iter(columns).map_err(|error| failed(&error))?;
    fs::remove_file(folder.join("log.csv"))?;
    let file = File::create(folder.join("log.parquet"))?;
    let mut writer = ArrowWriter::try_new(file, batch.schema(), None).map_err(|error| failed(&error))?;
    writer.write(&batch).map_err(|error| failed(&error))?;
    writer.close().map_err(|error| failed(&error)).map(drop)
}

fn words() -> impl Iterator<Item = &'static str> {
    std::iter::repeat_n("0.1", 400)
}

#[test]
fn parquet_of_other_types() -> Done {
    check(vec![
        (
            Files(|dir| column(dir, "dvel_x", Arc::new(Decimal128Array::from(vec![1; 400])))),
            &["log.parquet, column `dvel_x`: holds values of type Decimal", "write it as float64"],
        ),
        (
            Files(|dir| column(dir, "dvel_x", Arc::new(LargeStringArray::from_iter_values(words())))),
            &["column `dvel_x`: holds text, numbers were expected"],
        ),
        (
            Files(|dir| {
                let dictionary: DictionaryArray<Int32Type> = words().collect();
                column(dir, "dvel_x", Arc::new(dictionary))
            }),
            &["column `dvel_x`: holds text"],
        ),
        (
            Files(|dir| column(dir, "dvel_x", Arc::new(BooleanArray::from(vec![true; 400])))),
            &["column `dvel_x`: holds true/false values"],
        ),
        (
            Files(|dir| column(dir, "time_s", Arc::new(TimestampMicrosecondArray::from(vec![1; 400])))),
            &["column `time_s`: holds dates", "times are seconds, as numbers"],
        ),
        (
            Files(|dir| {
                let list = ListArray::from_iter_primitive::<Int32Type, _, _>(vec![Some(vec![Some(1)]); 400]);
                column(dir, "dvel_x", Arc::new(list))
            }),
            &["column `dvel_x`: holds nested values"],
        ),
        (
            Files(|dir| {
                let field = Arc::new(Field::new("x", DataType::Float64, false));
                let inner: ArrayRef = Arc::new(Float64Array::from(vec![0.0; 400]));
                column(dir, "dvel_x", Arc::new(StructArray::from(vec![(field, inner)])))
            }),
            &["column `dvel_x`: holds nested values"],
        ),
        (
            Files(|dir| column(dir, "dvel_x", Arc::new(Float16Array::new_null(400)))),
            &["column `dvel_x`: holds values of type Float16"],
        ),
        (
            Files(|dir| column(dir, "dvel_x", Arc::new(Float64Array::new_null(400)))),
            &["row 1, column `dvel_x`: is NaN, a velocity increment in m/s was expected"],
        ),
        // whole numbers are numbers, but these are no times
        (
            Files(|dir| column(dir, "time_s", Arc::new(Int64Array::from_iter_values(1..=400)))),
            &["column `time_s`", "(1.000 Hz)"],
        ),
        (
            Files(|dir| column(dir, "dvel_z", Arc::new(UInt8Array::from(vec![200; 400])))),
            &["column `dvel_z`: 200 in 0.02 s"],
        ),
        (Rows(|t| t.columns.iter_mut().for_each(|(_, values)| values.clear())), &["has no rows"]),
        (Bytes(|bytes| [b"PARE", &bytes[4..]].concat()), &["log.parquet: is an encrypted Parquet file"]),
        (Bytes(|_| b"ARROW1\0\0abcdefgh".into()), &["is not a Parquet file"]),
        (Bytes(|_| b"\x89HDF\r\n\x1a\n00000000".into()), &["is not a Parquet file"]),
        (Bytes(|bytes| bytes[4..].into()), &["is not a Parquet file"]),
        (Bytes(|bytes| [bytes, vec![0; 16]].concat()), &["is cut off"]),
    ])
}

#[cfg(unix)]
#[test]
fn things_that_are_no_files() -> Done {
    use std::os::unix::fs::symlink;
    fn instead(dir: &Path, name: &str, target: &str) -> io::Result<()> {
        fs::remove_file(dir.join(name))?;
        symlink(target, dir.join(name))
    }
    fn pipe(dir: &Path, name: &str) -> io::Result<()> {
        fs::remove_file(dir.join(name))?;
        let made = Command::new("mkfifo").arg(dir.join(name)).status()?;
        if made.success() { Ok(()) } else { Err(io::Error::other("no mkfifo")) }
    }
    check(vec![
        (
            Files(|dir| instead(dir, "log.csv", "log.csv")),
            &["log.csv: cannot be read: Too many levels of symbolic"],
        ),
        (Files(|dir| instead(dir, "log.toml", "log.toml")), &["log.toml: cannot be read: Too many levels"]),
        (Files(|dir| instead(dir, "log.csv", "nothing.csv")), &["log.csv: is a link to nothing"]),
        (Files(|dir| instead(dir, "log.csv", "/dev/zero")), &["log.csv: is not a regular file"]),
        (Files(|dir| instead(dir, "log.toml", "/dev/zero")), &["log.toml: is not a regular file"]),
        (Files(|dir| instead(dir, "log.csv", "/dev/null")), &["log.csv: is not a regular file"]),
        (Files(|dir| instead(dir, "log.csv", "/")), &["log.csv: is not a regular file"]),
        (Files(|dir| pipe(dir, "log.csv")), &["log.csv: is not a regular file"]),
        (Files(|dir| pipe(dir, "log.toml")), &["log.toml: is not a regular file"]),
    ])
}
