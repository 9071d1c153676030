//! The report: what a subcommand found, as one HTML file that a reviewer reads from top to bottom.
//!
//! Every subcommand makes a [`Report`] of the same few things: words, lists, tables, curves. One template shows them all. The
//! file needs nothing else: styles, script, plotting library and data are in it, and no address is ever asked.

pub mod diagnosis;
mod draw;
pub mod figures;
mod html;
mod inputs;
pub mod parts;
mod picture;
mod stands;
mod typeset;

pub use draw::{Curve, Figure, Style};
pub use inputs::Inputs;
pub use stands::{Drawing, Stand};

/// A page that cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The template does not take the data.
    #[error("the page: {0}")]
    Template(#[from] minijinja::Error),
    /// The figures' data cannot be told.
    #[error("the page's data: {0}")]
    Data(#[from] serde_json::Error),
}

/// Folder of the figures beside a report.
const FIGURES: &str = "figures";

/// What a subcommand found.
pub struct Report {
    /// What it is about.
    pub title: String,
    /// The finding in a sentence; what else must be said at once follows in further lines.
    pub verdict: String,
    /// Whether the verdict is good news.
    pub tone: Tone,
    /// Three to five key figures: what they are, and their value with its unit.
    pub facts: Vec<(String, String)>,
    /// The parts, in the order a reviewer reads: first what decides, then detail, which is folded.
    pub sections: Vec<Section>,
    /// Where it comes from: configuration, seed, version, input, command line.
    pub origin: Vec<(String, String)>,
    /// Files that were read, in full: name and text.
    pub attachments: Vec<(String, String)>,
}

/// Whether the verdict is good news.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// Good news.
    Good,
    /// Bad news.
    Bad,
    /// Neither.
    Neutral,
}

/// A part of a report.
pub struct Section {
    /// What it is about.
    pub title: String,
    /// Whether a reader has to open it.
    folded: bool,
    /// What stands in it, in order.
    pub items: Vec<Item>,
}

/// One thing in a section.
pub enum Item {
    /// A paragraph.
    Text(String),
    /// Points, one under the other.
    List(Vec<String>),
    /// A table, and what is drawn in it.
    Table(Table),
    /// Curves over a common axis.
    Curves(Figure),
    /// The same with logarithmic axes.
    LogLog(Figure),
    /// A drawing.
    Drawing(Drawing),
    /// Source code or a configuration file.
    Code(String),
    /// An equation in plain text, such as `d_f_i = k_i f_i^2`, which is set.
    Equation(String),
}

/// A table; a forest plot, bars and a map are tables with such cells.
pub struct Table {
    /// Name of its files beside the page, where something is drawn in it.
    file: Option<&'static str>,
    /// What it shows, in words.
    pub caption: String,
    /// Names of the columns.
    pub head: Vec<String>,
    /// The cells, row after row.
    pub rows: Vec<Vec<Cell>>,
}

/// One cell of a table. Places on its axis and parts are from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number, to the right.
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
pub struct Interval {
    /// The prior, from and to.
    pub prior: (f64, f64),
    /// The interval, from and to.
    pub interval: (f64, f64),
    /// The estimate.
    pub estimate: f64,
    /// The truth, where it is known.
    pub truth: Option<f64>,
    /// A line across all rows, such as where nothing is.
    pub mark: Option<f64>,
    /// What those are told who do not see it.
    pub text: String,
}

impl Section {
    /// A part called `title`.
    pub fn new(title: impl Into<String>, items: Vec<Item>) -> Self {
        Self { title: title.into(), folded: false, items }
    }

    /// The same as a detail that a reader opens. It is not printed unless it is open.
    #[must_use]
    pub fn folded(self) -> Self {
        Self { folded: true, ..self }
    }
}

impl Item {
    /// A paragraph.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

impl Table {
    /// A table of rows under the names of their columns.
    pub fn new(caption: impl Into<String>, head: &[&str], rows: Vec<Vec<Cell>>) -> Self {
        let head = head.iter().map(|name| (*name).to_owned()).collect();
        Self { file: None, caption: caption.into(), head, rows }
    }

    /// The same with `FILE.svg` and `FILE.csv` beside the page.
    pub fn drawn_as(self, file: &'static str) -> Self {
        Self { file: Some(file), ..self }
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
pub fn text(text: impl Into<String>) -> Cell {
    Cell::Text(text.into())
}

/// A cell of a number.
pub fn number(text: impl Into<String>) -> Cell {
    Cell::Number(text.into())
}

impl Report {
    /// The page: one HTML document.
    ///
    /// # Errors
    /// When it cannot be made, which is a fault of this crate.
    pub fn page(&self) -> Result<String, Error> {
        html::render(self)
    }

    /// Everything that belongs in the report's folder: names and contents of `report.html`, and of what is drawn in it as SVG and CSV
    /// in `figures/`.
    ///
    /// # Errors
    /// As [`page`](Self::page).
    pub fn files(&self) -> Result<Vec<(String, Vec<u8>)>, Error> {
        let mut files = vec![("report.html".to_owned(), self.page()?.into_bytes())];
        let mut put = |name: &str, svg: String, csv: Vec<u8>| {
            files.push((format!("{FIGURES}/{name}.svg"), svg.into_bytes()));
            files.push((format!("{FIGURES}/{name}.csv"), csv));
        };
        for item in self.sections.iter().flat_map(|section| &section.items) {
            match item {
                Item::Curves(figure) => put(&figure.file, figure.svg(false), figure.csv()),
                Item::LogLog(figure) => put(&figure.file, figure.svg(true), figure.csv()),
                Item::Table(table) => {
                    if let Some(file) = table.file {
                        put(file, picture::svg(table), picture::csv(table));
                    }
                }
                Item::Drawing(_) | Item::Text(_) | Item::List(_) | Item::Code(_) | Item::Equation(_) => {}
            }
        }
        for item in self.sections.iter().flat_map(|section| &section.items) {
            if let Item::Drawing(Drawing { file, svg, .. }) = item {
                files.push((format!("{FIGURES}/{file}.svg"), svg.clone().into_bytes()));
            }
        }
        Ok(files)
    }

    /// Adds where it comes from: a setting and its value.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<String>) -> Self {
        self.origin.push((name.into(), value.into()));
        self
    }
}
