//! A table with something drawn in it (a forest plot, bars, a map) as SVG, and its texts as CSV.

use std::fmt::Write as _;
use std::io::{self, Write};

use super::{Cell, Interval, Table};

/// Height of a row, and of a line of the head.
const ROW: f64 = 20.0;
/// Room about everything.
const EDGE: f64 = 12.0;
/// Room between columns.
const GAP: f64 = 14.0;
/// Width of a letter at the size of the text.
const LETTER: f64 = 6.6;
/// Widths of what is drawn.
const AXIS: f64 = 300.0;
const BAR: f64 = 150.0;
/// A column's head is broken into lines of about so many letters.
const HEAD: usize = 16;

const STYLE: &str = "text{font:12px sans-serif;fill:#16191d}.s{fill:#59616b}.l{stroke:#c9ced4}.p{fill:#dfe3e8}.e{fill:#0072b2}\
                     .w{stroke:#0072b2;stroke-width:2}.t{stroke:#d55e00;stroke-width:2}.m{stroke:#59616b;stroke-dasharray:1 3}";

/// Width of a column.
fn width(table: &Table, column: usize) -> f64 {
    let letters = |text: &str| LETTER * text.chars().count() as f64;
    let head = lines(&table.head[column]).iter().map(|line| letters(line)).fold(0.0, f64::max);
    let cells = table.rows.iter().filter_map(|row| row.get(column)).map(|cell| match cell {
        Cell::Text(text) | Cell::Number(text) => letters(text),
        Cell::Heat(_, text) => letters(text).max(50.0),
        Cell::Bar(_, text) => BAR + 8.0 + letters(text),
        Cell::Interval(_) => AXIS,
    });
    cells.fold(head, f64::max)
}

fn lines(text: &str) -> Vec<String> {
    textwrap::wrap(text, HEAD.max(text.chars().count().div_ceil(3))).into_iter().map(Into::into).collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The drawing. Writing to a string does not fail.
pub(super) fn svg(table: &Table) -> String {
    let widths: Vec<f64> = (0..table.head.len()).map(|column| width(table, column)).collect();
    let head = table.head.iter().map(|name| lines(name).len()).max().unwrap_or(1) as f64;
    let whole = widths.iter().map(|width| width + GAP).sum::<f64>() - GAP + 2.0 * EDGE;
    let caption = textwrap::wrap(&table.caption, ((whole - 2.0 * EDGE) / LETTER) as usize);
    let top = EDGE + ROW * (caption.len() as f64 + head) + 6.0;
    let height = top + ROW * table.rows.len() as f64 + EDGE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {whole:.0} {height:.0}\" width=\"{whole:.0}\" height=\"{height:.0}\">\n\
         <style>{STYLE}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    let text = |svg: &mut String, x: f64, y: f64, class: &str, anchor: &str, text: &str| {
        let text = escaped(text);
        let _ = writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" class=\"{class}\" text-anchor=\"{anchor}\">{text}</text>"
        );
    };
    for (i, line) in caption.iter().enumerate() {
        text(&mut svg, EDGE, EDGE + ROW * (i as f64 + 0.7), "s", "start", line);
    }
    let mut left = EDGE;
    for (column, width) in widths.iter().enumerate() {
        let cells = || table.rows.iter().filter_map(|row| row.get(column));
        let right = cells().next().is_some_and(|cell| matches!(cell, Cell::Number(_)));
        let (x, anchor) = if right { (left + width, "end") } else { (left, "start") };
        let names = lines(&table.head[column]);
        for (i, line) in names.iter().enumerate() {
            let y = top - 6.0 - ROW * (names.len() - i) as f64 + 0.7 * ROW;
            text(&mut svg, x, y, "s", anchor, line);
        }
        for (i, cell) in cells().enumerate() {
            let y = top + ROW * i as f64;
            match cell {
                Cell::Text(words) => text(&mut svg, left, y + 0.7 * ROW, "", "start", words),
                Cell::Number(figure) => text(&mut svg, left + width, y + 0.7 * ROW, "", "end", figure),
                Cell::Bar(part, words) => {
                    let length = BAR * part.clamp(0.0, 1.0);
                    rectangle(&mut svg, [left, y + 5.0, BAR, 10.0], "p");
                    rectangle(&mut svg, [left, y + 5.0, length, 10.0], "e");
                    text(&mut svg, left + BAR + 8.0, y + 0.7 * ROW, "", "start", words);
                }
                Cell::Heat(part, words) => {
                    let part = part.clamp(0.0, 1.0);
                    let _ = writeln!(
                        svg,
                        "<rect x=\"{left:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" class=\"e\" opacity=\"{part:.3}\"/>",
                        y + 1.0,
                        width + GAP - 2.0,
                        ROW - 2.0
                    );
                    let ink = if part > 0.9 { "\" style=\"fill:#ffffff" } else { "" };
                    text(&mut svg, left + (width + GAP) / 2.0, y + 0.7 * ROW, ink, "middle", words);
                }
                Cell::Interval(interval) => draw(&mut svg, interval, left, *width, y),
            }
        }
        left += width + GAP;
    }
    let _ = writeln!(
        svg,
        "<line x1=\"{EDGE}\" x2=\"{:.1}\" y1=\"{top:.1}\" y2=\"{top:.1}\" class=\"l\"/>\n</svg>",
        whole - EDGE
    );
    svg
}

fn rectangle(svg: &mut String, [x, y, width, height]: [f64; 4], class: &str) {
    let _ = writeln!(
        svg,
        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" class=\"{class}\"/>"
    );
}

/// An estimate on its axis from `left`, `width` long.
fn draw(svg: &mut String, interval: &Interval, left: f64, width: f64, y: f64) {
    let at = |place: f64| left + width * place.clamp(0.0, 1.0);
    let middle = y + ROW / 2.0;
    let (from, to) = (at(interval.prior.0), at(interval.prior.1));
    rectangle(svg, [from, y + 3.0, to - from, ROW - 6.0], "p");
    let mut line = |from: (f64, f64), to: (f64, f64), class: &str| {
        let ((x1, y1), (x2, y2)) = (from, to);
        let _ = writeln!(
            svg,
            "<line x1=\"{x1:.1}\" x2=\"{x2:.1}\" y1=\"{y1:.1}\" y2=\"{y2:.1}\" class=\"{class}\"/>"
        );
    };
    if let Some(mark) = interval.mark {
        line((at(mark), y), (at(mark), y + ROW), "m");
    }
    line((at(interval.interval.0), middle), (at(interval.interval.1), middle), "w");
    if let Some(truth) = interval.truth {
        line((at(truth), y + 1.0), (at(truth), y + ROW - 1.0), "t");
    }
    let _ = writeln!(
        svg,
        "<circle cx=\"{:.1}\" cy=\"{middle:.1}\" r=\"3.5\" class=\"e\"/>",
        at(interval.estimate)
    );
}

/// What the table says, as comma-separated text.
pub(super) fn csv(table: &Table) -> Vec<u8> {
    let mut out = Vec::new();
    // writing to memory does not fail
    let _ = write_csv(table, &mut out);
    out
}

fn write_csv(table: &Table, out: &mut dyn Write) -> io::Result<()> {
    let field = |text: &str| {
        if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
    };
    let line = |fields: Vec<String>| fields.join(",");
    writeln!(out, "{}", line(table.head.iter().map(|name| field(name)).collect()))?;
    for row in &table.rows {
        let texts = row.iter().map(|cell| match cell {
            Cell::Text(text) | Cell::Number(text) | Cell::Bar(_, text) | Cell::Heat(_, text) => field(text),
            Cell::Interval(interval) => field(&interval.text),
        });
        writeln!(out, "{}", line(texts.collect()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_table_draws_stands_in_the_svg() {
        let interval = Interval {
            prior: (0.25, 0.75),
            interval: (0.4, 0.6),
            estimate: 0.5,
            truth: Some(0.55),
            mark: Some(0.5),
            text: "0.1, of <1>".into(),
        };
        let rows = vec![vec![
            Cell::Text("a & b".into()),
            Cell::Interval(interval),
            Cell::Heat(0.9, "17".into()),
            Cell::Bar(0.5, "half".into()),
            Cell::Number("3".into()),
        ]];
        let table = Table::new("what it is", &["name", "-1 to +1", "map", "bar", "figure"], rows);
        let drawn = svg(&table);
        for piece in [
            "a &amp; b",
            "<circle",
            "class=\"t\"",
            "opacity=\"0.900\"",
            "half",
            "what it is",
            "-1 to +1",
            "</svg>",
        ] {
            assert!(drawn.contains(piece), "{piece}: {drawn}");
        }
        let texts = csv(&table);
        let texts = String::from_utf8(texts).expect("text");
        assert_eq!(texts, "name,-1 to +1,map,bar,figure\na & b,\"0.1, of <1>\",17,half,3\n");
    }
}
