//! Results on standard output and in files.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use logs::Log;
use miette::{Result, miette};
use same_file::Handle;
use tempfile::NamedTempFile;

use crate::say;

/// A link leads to a link at most so often, as systems have it.
const MOST_LINKS: usize = 40;
/// How the name of a file that is not whole yet begins and ends.
const PART: (&str, &str) = (".sinscal-", ".part");

/// Files of this program that are not whole yet.
static PARTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn parts() -> MutexGuard<'static, Vec<PathBuf>> {
    PARTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes away all files that are not whole yet. None is begun or moved to its place as long as the guard is held.
pub(crate) fn abandon() -> MutexGuard<'static, Vec<PathBuf>> {
    let parts = parts();
    for part in parts.iter() {
        // what cannot be removed does no harm
        let _ = fs::remove_file(part);
    }
    parts
}

/// Takes away what programs that were killed left in a folder. Whoever is at work on a file holds its lock.
pub(crate) fn sweep(folder: &Path) {
    // nobody begins a file meanwhile
    let Ok(alone) = File::open(folder) else { return };
    if alone.try_lock().is_err() {
        return;
    }
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let left = name.to_str().is_some_and(|name| name.starts_with(PART.0) && name.ends_with(PART.1));
        let abandoned =
            |path: &Path| File::options().write(true).open(path)?.try_lock().map_err(io::Error::from);
        if left && abandoned(&entry.path()).is_ok() {
            // what cannot be removed does no harm
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Writes to standard output. A reader that has gone away has seen enough: that is no failure.
pub(crate) fn print(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(miette!("standard output cannot be written: {error}"))
        }
        _ => Ok(()),
    }
}

/// Refuses a file that could not be written at the end of a long run; takes away what killed programs left beside it.
pub(crate) fn check_file(path: &Path) -> Result<()> {
    if path.is_dir() {
        return Err(miette!("{}: is a folder, a file was expected", path.display()));
    }
    if path.exists() && !path.is_file() {
        // who reads from a pipe must not see it closed before anything was written
        return Ok(());
    }
    let Place::File(file) = Place::of(path).map_err(|error| failed(path, &error))? else { return Ok(()) };
    let folder = folder_of(&file);
    if !folder.is_dir() {
        return Err(miette!("{}: the folder {} is not there", path.display(), folder.display()));
    }
    sweep(folder);
    Ok(())
}

/// Refuses a folder that could not be made at the end of a long run.
pub(crate) fn check_folder(path: &Path) -> Result<()> {
    let existing = path.ancestors().find(|folder| folder.exists());
    match existing {
        Some(folder) if !folder.is_dir() => {
            Err(miette!("{}: {} is a file, a folder was expected", path.display(), folder.display()))
        }
        _ => Ok(()),
    }
}

/// Where a result goes.
enum Place {
    /// A file, which appears whole: where a link leads, if the result was sent to a link.
    File(PathBuf),
    /// A device or a pipe, which is written to.
    Stream(File),
    /// What standard output or standard error were sent to: written through them, so that what they say later comes after it.
    Output(io::Stdout),
    Errors(io::Stderr),
}

impl Place {
    /// Opens what is no file.
    fn of(path: &Path) -> io::Result<Self> {
        if path.exists() && !path.is_file() {
            return File::options().write(true).open(path).map(Self::Stream);
        }
        if let Ok(there) = Handle::from_path(path) {
            if Handle::stdout().is_ok_and(|output| output == there) {
                return Ok(Self::Output(io::stdout()));
            }
            if Handle::stderr().is_ok_and(|errors| errors == there) {
                return Ok(Self::Errors(io::stderr()));
            }
        }
        let mut file = path.to_owned();
        for _ in 0..MOST_LINKS {
            match fs::read_link(&file) {
                Ok(next) => file = folder_of(&file).join(next),
                Err(_) => return Ok(Self::File(file)),
            }
        }
        Err(io::Error::other("too many links lead from one to the next"))
    }
}

/// Files that a command reads. Nothing that it writes may take their place, whatever name, link or second name it goes by.
#[derive(Default)]
pub(crate) struct Sources(Vec<PathBuf>);

impl Sources {
    /// Adds a file. A device or a pipe is none, and neither is what is not there.
    pub(crate) fn add(&mut self, path: &Path) {
        if path.is_file() {
            self.0.push(path.to_owned());
        }
    }

    /// Refuses a result that would take the place of one of them.
    fn check(&self, path: &Path) -> Result<()> {
        let Ok(there) = Handle::from_path(path) else { return Ok(()) };
        if self.0.iter().any(|source| Handle::from_path(source).is_ok_and(|source| source == there)) {
            return Err(miette!(
                help = "name another file for the result",
                "{}: is read by this command, and would be lost if the result took its place",
                path.display()
            ));
        }
        Ok(())
    }
}

/// Files that appear together once all of them are written, or not at all.
#[derive(Default)]
pub(crate) struct Files {
    sources: Sources,
    written: Vec<(NamedTempFile, PathBuf)>,
    /// Folders made on the way, outermost first.
    made: Vec<PathBuf>,
    done: bool,
}

impl Files {
    /// None yet, and never one of those that are read.
    pub(crate) fn beside(sources: Sources) -> Self {
        Self { sources, written: Vec::new(), made: Vec::new(), done: false }
    }

    /// Refuses a file that could not be written at the end of a long run; takes away what killed programs left beside it.
    pub(crate) fn check(&self, path: &Path) -> Result<()> {
        check_file(path)?;
        self.sources.check(path)
    }

    /// Makes a folder and those above it, where missing, and takes away what killed programs left there.
    pub(crate) fn folder(&mut self, path: &Path) -> Result<()> {
        let missing: Vec<&Path> = path
            .ancestors()
            .take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists())
            .collect();
        for folder in missing.into_iter().rev() {
            match fs::create_dir(folder) {
                Ok(()) => self.made.push(folder.to_owned()),
                // another program made it in the meantime
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => {}
                Err(error) => return Err(failed(folder, &error)),
            }
        }
        sweep(path);
        Ok(())
    }

    /// Writes a file beside its final place.
    pub(crate) fn write(
        &mut self,
        path: &Path,
        fill: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> Result<()> {
        let mut fill = Some(fill);
        self.write_by(path, &mut |stream| fill.take().map_or(Ok(()), |fill| fill(stream)))
    }

    /// Compiled once, whatever fills the file.
    fn write_by(
        &mut self,
        path: &Path,
        fill: &mut dyn FnMut(&mut (dyn Write + Send)) -> io::Result<()>,
    ) -> Result<()> {
        self.sources.check(path)?;
        let mut through = |stream: &mut (dyn Write + Send)| {
            fill(stream).and_then(|()| stream.flush()).map_err(|error| failed(path, &error))
        };
        let place = match Place::of(path).map_err(|error| failed(path, &error))? {
            Place::Stream(mut stream) => return through(&mut stream),
            Place::Output(mut output) => return through(&mut output),
            Place::Errors(mut errors) => return through(&mut errors),
            Place::File(place) => place,
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(PART.0).suffix(PART.1);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // What a file gets that is simply created: the umask still applies.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let folder = folder_of(&place);
        let beginning = File::open(folder).and_then(|folder| folder.lock_shared().map(|()| folder));
        let mut parts = parts();
        let mut file = builder.tempfile_in(folder).map_err(|error| failed(path, &error))?;
        parts.push(file.path().to_owned());
        drop(parts);
        // what cannot be locked is not swept either
        let _ = file.as_file().lock();
        drop(beginning);
        let mut buffered = io::BufWriter::new(file.as_file_mut());
        through(&mut buffered)?;
        drop(buffered);
        file.as_file().sync_all().map_err(|error| failed(path, &error))?;
        self.written.push((file, place));
        Ok(())
    }

    /// Moves all files to their places. Two programs that write to one folder do so one after the other.
    pub(crate) fn commit(mut self) -> Result<()> {
        let _locks = self.lock();
        let mut parts = parts();
        for (file, path) in self.written.drain(..) {
            parts.retain(|part| part != file.path());
            file.persist(&path).map_err(|error| failed(&path, &error.error))?;
            say::detail(|| format!("wrote {}", path.display()));
        }
        self.done = true;
        Ok(())
    }

    /// Moves files to their places where there are none yet; what another program put there stays.
    pub(crate) fn commit_new(mut self) -> Result<()> {
        let _locks = self.lock();
        let mut parts = parts();
        for (file, path) in self.written.drain(..) {
            parts.retain(|part| part != file.path());
            match file.persist_noclobber(&path) {
                Err(error) if error.error.kind() != io::ErrorKind::AlreadyExists => {
                    return Err(failed(&path, &error.error));
                }
                _ => {}
            }
        }
        self.done = true;
        Ok(())
    }

    /// Locks the folders of the files until the locks are dropped, or the program is killed. Where the system cannot lock a
    /// folder, each file is still whole.
    fn lock(&self) -> Vec<File> {
        let mut folders: Vec<&Path> = self.written.iter().map(|(_, path)| folder_of(path)).collect();
        // always in the same order, so that two programs never wait for each other
        folders.sort_unstable();
        folders.dedup();
        let locked = |folder| File::open(folder).and_then(|folder| folder.lock().map(|()| folder)).ok();
        folders.into_iter().filter_map(locked).collect()
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        if !self.done {
            self.written.clear();
            for folder in self.made.iter().rev() {
                // Only an empty folder goes; whatever else came to stand in it stays.
                let _ = fs::remove_dir(folder);
            }
        }
    }
}

/// Where the results of a subcommand go.
pub(crate) struct Target<'a> {
    /// A file for the JSON.
    json: Option<&'a Path>,
    /// JSON to standard output.
    to_stdout: bool,
    out: Option<&'a Path>,
    sources: Sources,
}

impl<'a> Target<'a> {
    /// Refuses places that could not be written at the end of a long run.
    pub(crate) fn new(json: Option<&'a Path>, out: Option<&'a Path>) -> Result<Self> {
        let to_stdout = json.is_some_and(|path| path.as_os_str() == "-");
        let json = json.filter(|_| !to_stdout);
        if let Some(path) = json {
            check_file(path)?;
        }
        if let Some(path) = out {
            check_folder(path)?;
        }
        Ok(Self { json, to_stdout, out, sources: Sources::default() })
    }

    /// Takes note of a file that the command reads; refuses it as a place for results, before any work is done where the place is
    /// known by then.
    pub(crate) fn reads(&mut self, path: &Path) -> Result<()> {
        self.sources.add(path);
        self.json.map_or(Ok(()), |json| self.sources.check(json))
    }

    /// The same of whatever a log of this name, with or without ending, may be read from before it is opened.
    pub(crate) fn reads_named(&mut self, log: &Path) -> Result<()> {
        self.reads(log)?;
        for ending in
            ["toml", "parquet", "csv", "mat", "h5", "hdf5", "npz", "npy", "mcap", "bag", "ulg", "ulog"]
        {
            let mut name = log.as_os_str().to_owned();
            name.push(format!(".{ending}"));
            self.reads(Path::new(&name))?;
            self.reads(&log.with_extension(ending))?;
        }
        Ok(())
    }

    /// The same of all that belongs to a log.
    pub(crate) fn reads_log(&mut self, log: &Log) -> Result<()> {
        log.files().iter().try_for_each(|file| self.reads(file))?;
        self.reads(&log.table().with_extension("truth.json"))
    }

    /// Writes `NAME.json` and `NAME.txt` where asked, with `more` files in the folder, and prints what was asked for.
    pub(crate) fn write(
        self,
        name: &str,
        json: &str,
        text: &str,
        verdict: &str,
        more: impl FnOnce(&mut Files, &Path) -> Result<()>,
    ) -> Result<()> {
        let mut files = Files::beside(self.sources);
        if let Some(path) = self.json {
            files.write(path, |file| file.write_all(json.as_bytes()))?;
        }
        if let Some(folder) = self.out {
            files.folder(folder)?;
            files.write(&folder.join(format!("{name}.json")), |file| file.write_all(json.as_bytes()))?;
            files.write(&folder.join(format!("{name}.txt")), |file| file.write_all(text.as_bytes()))?;
            more(&mut files, folder)?;
        }
        files.commit()?;
        if self.to_stdout {
            say::remark(verdict);
            print(json)
        } else {
            print(&say::harmless(text, false))
        }
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn failed(path: &Path, error: &io::Error) -> miette::Report {
    // What stands around the system's own error names the temporary file.
    let cause = error.get_ref().and_then(|inner| inner.source()).map(ToString::to_string);
    miette!("{}: cannot be written: {}", path.display(), cause.unwrap_or_else(|| error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_left_of_a_failure() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let out = folder.path().join("a/b");
        let mut files = Files::default();
        files.folder(&out)?;
        files.write(&out.join("one"), |file| file.write_all(b"1"))?;
        let second = files.write(&out.join("two"), |_| Err(io::Error::other("disk full")));
        assert!(second.is_err_and(|error| error.to_string().contains("disk full")));
        drop(files);
        assert_eq!(fs::read_dir(folder.path())?.count(), 0);

        let mut files = Files::default();
        files.folder(&out)?;
        files.write(&out.join("one"), |file| file.write_all(b"1"))?;
        files.commit()?;
        assert_eq!(fs::read_to_string(out.join("one"))?, "1");
        assert_eq!(fs::read_dir(&out)?.count(), 1);
        Ok(())
    }

    #[test]
    fn programs_that_make_one_folder_at_once_do_not_stop_each_other() -> Result<(), Box<dyn std::error::Error>>
    {
        let place = tempfile::tempdir()?;
        for round in 0..50 {
            let out = place.path().join(round.to_string()).join("a/b");
            let start = std::sync::Barrier::new(4);
            let make = || {
                let mut files = Files::default();
                start.wait();
                files.folder(&out)?;
                files.commit()
            };
            std::thread::scope(|scope| {
                let all = [(); 4].map(|()| scope.spawn(make));
                all.into_iter().all(|one| one.join().is_ok_and(|made| made.is_ok()))
            })
            .then_some(())
            .ok_or("one was stopped")?;
        }
        Ok(())
    }
}
