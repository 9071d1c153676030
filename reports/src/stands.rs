//! Pictures of a unit as it stands, one beside the other.

use std::fmt::Write as _;

use crate::Item;

/// Size of a picture, and how many stand in a line.
const SIZE: f64 = 132.0;
const COLUMNS: usize = 6;
/// Half the edges of the housing along x, y, z of the body: no two alike.
const HALF: [f64; 3] = [0.34, 0.5, 0.22];
/// Lengths on paper of one along north, which goes up and to the right.
const NORTH: (f64, f64) = (0.32, 0.34);
/// Pixels of one.
const SCALE: f64 = 58.0;
/// Colours of the axes, told apart with any kind of colour vision.
const COLOURS: [&str; 3] = ["#d55e00", "#009e73", "#0072b2"];
const NAMES: [&str; 3] = ["x", "y", "z"];

/// How a unit stands.
#[derive(Clone, Debug)]
pub struct Stand {
    /// What is written below.
    pub label: String,
    /// Where its axes x, y, z point: east, north, up.
    pub axes: [[f64; 3]; 3],
}

/// A drawing without data behind it.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Name of its file beside the page.
    pub(super) file: &'static str,
    /// What it shows, in words.
    pub(super) caption: String,
    pub(super) svg: String,
}

impl From<Drawing> for Item {
    fn from(drawing: Drawing) -> Self {
        Self::Drawing(drawing)
    }
}

/// Where a point east, north, up lies on paper, right and down.
fn on_paper([east, north, up]: [f64; 3]) -> (f64, f64) {
    (SCALE * (east + NORTH.0 * north), -SCALE * (up + NORTH.1 * north))
}

/// A sum of the axes.
fn along(axes: &[[f64; 3]; 3], by: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|k| (0..3).map(|axis| axes[axis][k] * by[axis]).sum())
}

impl Drawing {
    /// A unit in each of its stands, seen from the south and above. The housing is a flat box, longest along y; its axes stand out of it.
    pub fn of_stands(file: &'static str, caption: impl Into<String>, stands: &[Stand]) -> Self {
        let lines = stands.len().div_ceil(COLUMNS);
        let (width, height) = (SIZE * COLUMNS.min(stands.len()) as f64, (SIZE + 18.0) * lines as f64);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
             height=\"{height:.0}\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        );
        for (i, stand) in stands.iter().enumerate() {
            let x = SIZE * ((i % COLUMNS) as f64 + 0.5);
            let y = (SIZE + 18.0) * (i / COLUMNS) as f64 + 0.5 * SIZE;
            // writing to a string does not fail
            let _ = writeln!(svg, "<g transform=\"translate({x:.1} {y:.1})\">");
            draw(&mut svg, stand);
            svg += "</g>\n";
        }
        svg += "</svg>\n";
        Self { file, caption: caption.into(), svg }
    }
}

fn draw(svg: &mut String, stand: &Stand) {
    // towards the eye, as far as on_paper knows: south and up
    let towards = |v: [f64; 3]| v[2] * NORTH.1 - v[1] - v[0] * NORTH.0;
    let mut faces: Vec<(f64, usize, f64)> = (0..3)
        .flat_map(|axis| [-1.0, 1.0].map(|side| (side * towards(stand.axes[axis]), axis, side)))
        .filter(|(seen, ..)| *seen > 0.0)
        .collect();
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    // axes that go away from the eye are behind the housing
    (0..3).filter(|axis| towards(stand.axes[*axis]) < 0.0).for_each(|axis| arrow(svg, stand, axis));
    for (seen, axis, side) in faces {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let corner = |a: f64, b: f64| {
            let mut by = [0.0; 3];
            (by[axis], by[u], by[v]) = (side * HALF[axis], a * HALF[u], b * HALF[v]);
            let (x, y) = on_paper(along(&stand.axes, by));
            format!("{x:.1},{y:.1}")
        };
        let points = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)].join(" ");
        let grey = 205 + (40.0 * seen.min(1.0)) as u32;
        let _ = writeln!(
            svg,
            "<polygon points=\"{points}\" fill=\"rgb({grey},{grey},{grey})\" stroke=\"#59616b\"/>"
        );
    }
    (0..3).filter(|axis| towards(stand.axes[*axis]) >= 0.0).for_each(|axis| arrow(svg, stand, axis));
    let label = stand.label.replace('&', "&amp;").replace('<', "&lt;");
    let _ = writeln!(
        svg,
        "<text y=\"{:.0}\" text-anchor=\"middle\" fill=\"#16191d\">{label}</text>",
        0.5 * SIZE + 10.0
    );
}

/// An axis, from the face of the housing outwards.
fn arrow(svg: &mut String, stand: &Stand, axis: usize) {
    let at = |length: f64| {
        let mut by = [0.0; 3];
        by[axis] = length;
        on_paper(along(&stand.axes, by))
    };
    let ((x1, y1), (x2, y2), (x3, y3)) = (at(HALF[axis]), at(0.85), at(0.98));
    let (colour, name) = (COLOURS[axis], NAMES[axis]);
    let _ = writeln!(
        svg,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{colour}\" stroke-width=\"3\"/>\n\
         <text x=\"{x3:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-weight=\"bold\" fill=\"{colour}\">{name}</text>",
        y3 + 4.0
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_points_up_is_above_and_what_points_east_is_to_the_right() {
        let level =
            Stand { label: "1 < 2".into(), axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };
        let (x, y) = on_paper(level.axes[2]);
        assert!(x == 0.0 && y < 0.0);
        assert!(on_paper(level.axes[0]).0 > 0.0);
        let drawing = Drawing::of_stands("stands", "", &[level.clone(), level]);
        // of a box three faces are seen
        assert_eq!(drawing.svg.matches("<polygon").count(), 6);
        assert_eq!(drawing.svg.matches("<line").count(), 6);
        assert!(drawing.svg.contains("1 &lt; 2"));
    }
}
