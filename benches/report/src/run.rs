//! Running commands, and reading what they print.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Why a part is left as it is.
pub(crate) enum Error {
    /// There is no such tool.
    Missing(&'static str),
    Failed(String),
}

impl From<String> for Error {
    fn from(why: String) -> Self {
        Self::Failed(why)
    }
}

impl From<&str> for Error {
    fn from(why: &str) -> Self {
        Self::Failed(why.to_owned())
    }
}

impl From<std::io::Error> for Error {
    fn from(why: std::io::Error) -> Self {
        Self::Failed(why.to_string())
    }
}

/// Where things are.
pub(crate) struct Place {
    root: PathBuf,
    target: PathBuf,
}

impl Place {
    /// The workspace this was built in, and its target folder or that of `CARGO_TARGET_DIR`.
    pub(crate) fn new() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let root = root.canonicalize().unwrap_or(root);
        let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
        let target = std::path::absolute(&target).unwrap_or(target);
        Self { root, target }
    }

    /// A path in the workspace.
    pub(crate) fn file(&self, path: &str) -> PathBuf {
        self.root.join(path)
    }

    pub(crate) fn document(&self) -> PathBuf {
        self.file("docs/PERFORMANCE.md")
    }

    /// A target folder: the usual one where `name` is empty, otherwise one of its own in there.
    pub(crate) fn target(&self, name: &str) -> PathBuf {
        if name.is_empty() { self.target.clone() } else { self.target.join(name) }
    }

    /// A command that runs in the workspace, for its default target folder; its errors are shown as they come.
    pub(crate) fn command(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root).env("CARGO_TARGET_DIR", &self.target).stderr(Stdio::inherit());
        command
    }

    /// What cargo prints with these words.
    pub(crate) fn cargo(&self, words: &str) -> Result<String, Error> {
        output(self.command("cargo").args(words.split(' ')))
    }

    /// The same in a target folder of its own, for the processor at hand if `native`.
    pub(crate) fn cargo_in(&self, folder: &str, native: bool, words: &str) -> Result<String, Error> {
        let mut command = self.command("cargo");
        command.args(words.split(' ')).env("CARGO_TARGET_DIR", self.target(folder));
        if native {
            command.env("RUSTFLAGS", "-C target-cpu=native");
        }
        output(&mut command)
    }
}

/// Says that a part needs a tool.
pub(crate) fn require(tool: &'static str) -> Result<(), Error> {
    let found = Command::new(tool).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    found.map(|_| ()).map_err(|_| Error::Missing(tool))
}

/// What a command prints; an error where it fails.
pub(crate) fn output(command: &mut Command) -> Result<String, Error> {
    let output = command.output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    if output.status.success() {
        return Ok(text.into_owned());
    }
    let program = command.get_program().display();
    Err(format!("{program} ends with {} after this:\n{}", output.status, text.trim_end()).into())
}

/// Writes a file by way of a temporary one beside it.
pub(crate) fn replace(path: &Path, content: &str) -> Result<(), Error> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let temporary = path.with_extension("new");
    std::fs::write(&temporary, content)?;
    Ok(std::fs::rename(temporary, path)?)
}

/// Lines `name  number us` of a benchmark run with `--least`.
pub(crate) struct Times(Vec<(String, f64)>);

impl Times {
    pub(crate) fn read(text: &str) -> Self {
        let line = |line: &str| {
            let (name, number) = line.strip_suffix(" us")?.trim_end().rsplit_once(' ')?;
            Some((name.trim().to_owned(), number.parse().ok()?))
        };
        Self(text.lines().filter_map(line).collect())
    }

    /// All of them, in the order they came.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.0.iter().map(|(name, time)| (name.as_str(), *time))
    }

    /// That of a name, us.
    pub(crate) fn of(&self, name: &str) -> Result<f64, Error> {
        let found = self.iter().find(|(known, _)| *known == name).map(|(_, time)| time);
        found.ok_or_else(|| format!("no time of \"{name}\"").into())
    }
}

/// The numbers in a text, in order.
pub(crate) fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| !(c.is_ascii_digit() || ".e-".contains(c)))
        .filter_map(|word| word.parse().ok())
        .collect()
}

/// A Markdown table: its first row, and the others.
pub(crate) fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | ")).replace("|  |", "| |");
    let mut text = line(head.to_vec());
    text += &format!("|{}\n", "---|".repeat(head.len()));
    for row in rows {
        text += &line(row.iter().map(String::as_str).collect());
    }
    text
}

/// A time in us with as many places as say something.
pub(crate) fn short(time: f64) -> String {
    let places = if time < 1.0 {
        3
    } else if time < 10.0 {
        2
    } else {
        1
    };
    format!("{time:.places$}")
}

/// A whole number in groups of three.
pub(crate) fn grouped(number: f64) -> String {
    let digits = format!("{number:.0}");
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join(" ")
}
