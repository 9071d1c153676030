//! The report: what a subcommand found, as one HTML file that a reviewer reads from top to bottom.
//!
//! Every subcommand makes a [`Report`] of the same few things: words, lists, tables, curves. One template shows them all. The
//! file needs nothing else: styles, script, plotting library and data are in it, and no address is ever asked.

pub(crate) mod diagnosis;
mod html;
pub(crate) mod inputs;
pub(crate) mod origin;
pub(crate) mod parts;
mod picture;

use std::path::Path;

use miette::Result;

use crate::draw::Figure;
use crate::output::Files;

/// Folder of the figures beside a report.
const FIGURES: &str = "figures";

/// What a subcommand found.
pub(crate) struct Report {
    pub(crate) title: String,
    /// The finding in a sentence.
    pub(crate) verdict: String,
    pub(crate) tone: Tone,
    /// Key figures: what they are, and their value.
    pub(crate) facts: Vec<(String, String)>,
    pub(crate) sections: Vec<Section>,
    /// Where it comes from: configuration, seed, version, input, command line.
    pub(crate) origin: Vec<(String, String)>,
    /// Files that were read, in full: name and text.
    pub(crate) attachments: Vec<(String, String)>,
}

/// Whether the verdict is good news.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tone {
    Good,
    Bad,
    Neutral,
}

/// A part of a report.
pub(crate) struct Section {
    pub(crate) title: String,
    pub(crate) items: Vec<Item>,
}

/// One thing in a section.
pub(crate) enum Item {
    Text(String),
    List(Vec<String>),
    Table(Table),
    Curves(Figure),
    /// Source code or a configuration file.
    Code(String),
}

/// A table; a forest plot, bars and a map are tables with such cells.
pub(crate) struct Table {
    /// Name of its files beside the page, where something is drawn in it.
    file: Option<&'static str>,
    pub(crate) caption: String,
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<Cell>>,
}

/// One cell of a table. Places on its axis and parts are from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    Text(String),
    Number(String),
    /// A bar of so much of the full length, and what it stands for.
    Bar(f64, String),
    /// A field of a map, the darker the more, and what it stands for.
    Heat(f64, String),
    /// An estimate on the axis of a forest plot.
    Interval(Interval),
}

/// An estimate on the axis of a forest plot, and how it is told to those who do not see it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) prior: (f64, f64),
    pub(crate) interval: (f64, f64),
    pub(crate) estimate: f64,
    pub(crate) truth: Option<f64>,
    /// A line across all rows, such as where nothing is.
    pub(crate) mark: Option<f64>,
    pub(crate) text: String,
}

impl Section {
    pub(crate) fn new(title: impl Into<String>, items: Vec<Item>) -> Self {
        Self { title: title.into(), items }
    }
}

impl Item {
    pub(crate) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

impl Table {
    pub(crate) fn new(caption: impl Into<String>, head: &[&str], rows: Vec<Vec<Cell>>) -> Self {
        let head = head.iter().map(|name| (*name).to_owned()).collect();
        Self { file: None, caption: caption.into(), head, rows }
    }

    /// The same with `FILE.svg` and `FILE.csv` beside the page.
    pub(crate) fn drawn_as(self, file: &'static str) -> Self {
        Self { file: Some(file), ..self }
    }

    /// Writes its files to a folder.
    fn write(&self, file: &str, files: &mut Files, folder: &Path) -> Result<()> {
        let svg = picture::svg(self);
        files.write(&folder.join(format!("{file}.svg")), |out| out.write_all(svg.as_bytes()))?;
        files.write(&folder.join(format!("{file}.csv")), |out| picture::csv(self, out))
    }
}

impl From<Table> for Item {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

impl From<Figure> for Item {
    fn from(figure: Figure) -> Self {
        Self::Curves(figure)
    }
}

/// A cell of text.
pub(crate) fn text(text: impl Into<String>) -> Cell {
    Cell::Text(text.into())
}

/// A cell of a number.
pub(crate) fn number(text: impl Into<String>) -> Cell {
    Cell::Number(text.into())
}

impl Report {
    /// Writes the page alone.
    pub(crate) fn write_page(&self, files: &mut Files, path: &Path) -> Result<()> {
        let html = html::render(self)?;
        files.write(path, |file| file.write_all(html.as_bytes()))
    }

    /// Writes `report.html` to a folder, and what is drawn in it as SVG and CSV to `figures/`.
    pub(crate) fn write(&self, files: &mut Files, folder: &Path) -> Result<()> {
        self.write_page(files, &folder.join("report.html"))?;
        let folder = folder.join(FIGURES);
        for item in self.sections.iter().flat_map(|section| &section.items) {
            match item {
                Item::Curves(figure) => {
                    files.folder(&folder)?;
                    figure.write(files, &folder)?;
                }
                Item::Table(table) => {
                    if let Some(file) = table.file {
                        files.folder(&folder)?;
                        table.write(file, files, &folder)?;
                    }
                }
                Item::Text(_) | Item::List(_) | Item::Code(_) => {}
            }
        }
        Ok(())
    }
}
