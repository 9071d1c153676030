//! From a report to HTML. The template escapes every text; data for the script stand in it as JSON without `<`.

use minijinja::{Environment, Value, context};

use super::typeset::{equation, symbols};
use super::{Cell, Error, Interval, Item, Report, Table, Tone};

const TEMPLATE: &str = include_str!("../assets/report.html");
const STYLE: &str = include_str!("../assets/report.css");
const SCRIPT: &str = include_str!("../assets/report.js");
const PLOTS: &str = include_str!("../assets/uplot/uPlot.iife.min.js");
const PLOTS_STYLE: &str = include_str!("../assets/uplot/uPlot.min.css");
const PLOTS_LICENCE: &str = include_str!("../assets/uplot/LICENSE");

/// The whole document.
pub(super) fn render(report: &Report) -> Result<String, Error> {
    let mut figures = Vec::new();
    let sections: Vec<Value> = report
        .sections
        .iter()
        .enumerate()
        .map(|(i, section)| {
            let items: Vec<Value> = section.items.iter().map(|item| value(item, &mut figures)).collect();
            context! {
                id => format!("section-{}", i + 1), title => symbols(&section.title), folded => section.folded, items,
            }
        })
        .collect();
    let data = serde_json::to_string(&figures)?.replace('<', "\\u003c");
    let tone = match report.tone {
        Tone::Good => "good",
        Tone::Bad => "bad",
        Tone::Neutral => "neutral",
    };
    let mut lines = report.verdict.lines().map(symbols);
    let facts: Vec<(String, String)> =
        report.facts.iter().map(|(name, value)| (symbols(name), symbols(value))).collect();
    let mut templates = Environment::new();
    // the name's ending switches escaping on
    templates.add_template("report.html", TEMPLATE)?;
    let template = templates.get_template("report.html")?;
    Ok(template.render(context! {
        title => report.title, verdict => lines.next(), explanation => lines.collect::<Vec<String>>(), tone, facts,
        sections,
        origin => report.origin, attachments => report.attachments,
        style => Value::from_safe_string(STYLE.into()),
        plots_style => Value::from_safe_string(PLOTS_STYLE.into()),
        script => Value::from_safe_string(SCRIPT.into()),
        plots => Value::from_safe_string(PLOTS.into()),
        licence => Value::from_safe_string(PLOTS_LICENCE.into()),
        data => Value::from_safe_string(data),
    })?)
}

/// An item as the template sees it; data of curves are put aside.
fn value(item: &Item, figures: &mut Vec<serde_json::Value>) -> Value {
    match item {
        Item::Text(text) => context! { kind => "text", text => symbols(text) },
        Item::List(lines) => {
            context! { kind => "list", lines => lines.iter().map(|line| symbols(line)).collect::<Vec<_>>() }
        }
        Item::Equation(text) => {
            context! { kind => "equation", text, set => Value::from_safe_string(equation(text)) }
        }
        Item::Code(text) => context! { kind => "code", text },
        Item::Table(table) => table_value(table),
        // made by this crate, with every text in it escaped
        Item::Drawing(drawing) => {
            let svg = Value::from_safe_string(drawing.svg.clone());
            context! { kind => "drawing", caption => drawing.caption, svg }
        }
        Item::Curves(figure) | Item::LogLog(figure) => {
            figures.push(figure.data(matches!(item, Item::LogLog(_))));
            context! { kind => "curves", title => symbols(&figure.title), file => figure.file, at => figures.len() - 1 }
        }
    }
}

fn table_value(table: &Table) -> Value {
    // a column of numbers has its head over its numbers
    let numeric = |i: usize| matches!(table.rows.first().and_then(|row| row.get(i)), Some(Cell::Number(_)));
    let head: Vec<Value> = table
        .head
        .iter()
        .enumerate()
        .map(|(i, name)| context! { name => symbols(name), numeric => numeric(i) })
        .collect();
    let rows: Vec<Vec<Value>> = table.rows.iter().map(|row| row.iter().map(cell).collect()).collect();
    // on a phone the rows of a wide table become cards; a map keeps its shape
    let any = |is: fn(&Cell) -> bool| table.rows.iter().flatten().any(is);
    let (map, axis) =
        (any(|cell| matches!(cell, Cell::Heat(..))), any(|cell| matches!(cell, Cell::Interval(_))));
    let cards = (table.head.len() > 3 || axis) && !map;
    context! { kind => "table", caption => symbols(&table.caption), cards, head, rows }
}

fn cell(cell: &Cell) -> Value {
    let percent = |part: f64| format!("{:.2}", 100.0 * part.clamp(0.0, 1.0));
    match cell {
        Cell::Text(text) => context! { kind => "text", text => symbols(text) },
        Cell::Number(text) => context! { kind => "number", text => symbols(text) },
        Cell::Bar(part, text) => context! { kind => "bar", part => percent(*part), text => symbols(text) },
        Cell::Heat(part, text) => {
            context! { kind => "heat", part => percent(*part), strong => *part > 0.6, full => *part > 0.9, text => symbols(text) }
        }
        Cell::Interval(Interval { prior, interval, estimate, truth, mark, text }) => context! {
            kind => "interval", text => symbols(text),
            prior => [percent(prior.0), percent(prior.1 - prior.0)],
            interval => [percent(interval.0), percent(interval.1 - interval.0)],
            estimate => percent(*estimate),
            truth => truth.map(percent),
            mark => mark.map(percent),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Section;
    use crate::draw::{Curve, Figure, Style};

    fn report(text: &str) -> Report {
        let figure = Figure {
            file: "one".into(),
            title: text.into(),
            axes: ["time, s", "ppm"],
            curves: vec![
                Curve::new(text, Style::Full, vec![(0.0, 1.0), (1.0, f64::NAN)]).with_band(vec![1.0, 0.5]),
            ],
        };
        let table = Table::new(
            text,
            &[text],
            vec![vec![Cell::Text(text.into())], vec![Cell::Heat(0.7, text.into())]],
        );
        Report {
            title: text.into(),
            verdict: text.into(),
            tone: Tone::Good,
            facts: vec![(text.into(), text.into())],
            sections: vec![Section::new(
                text,
                vec![
                    Item::text(text),
                    Item::List(vec![text.into()]),
                    Item::Code(text.into()),
                    table.into(),
                    figure.into(),
                ],
            )],
            origin: vec![(text.into(), text.into())],
            attachments: vec![(text.into(), text.into())],
        }
    }

    #[test]
    fn no_text_becomes_markup() -> Result<(), Error> {
        let html = render(&report("</script><img src=x onerror=alert(1)>&\"'"))?;
        assert!(!html.contains("<img"), "unescaped text");
        let scripts = |html: &str| html.matches("</script>").count();
        assert_eq!(scripts(&html), scripts(&render(&report("plain"))?));
        Ok(())
    }

    #[test]
    fn nothing_is_fetched() -> Result<(), Error> {
        let html = render(&report("plain"))?;
        for fetches in ["src=", "@import", "url(", "fetch(", "XMLHttpRequest", "<link rel=\"stylesheet\""] {
            assert!(!html.contains(fetches), "{fetches}");
        }
        assert!(html.contains("Content-Security-Policy") && html.contains("Leon Sorokin"));
        Ok(())
    }

    #[test]
    fn the_same_report_is_the_same_file() -> Result<(), Error> {
        assert_eq!(render(&report("plain"))?, render(&report("plain"))?);
        Ok(())
    }
}
