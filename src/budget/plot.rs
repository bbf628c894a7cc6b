//! Wrong pixels against texels, both axes logarithmic, as SVG.

use super::Point;
use crate::picture::{COLOURS, decades, escaped, svg_head};

/// The plotting area and the room around it, SVG units.
const SIZE: [f64; 2] = [640.0, 480.0];
const MARGIN: f64 = 70.0;
/// Width of the legend.
const LEGEND: f64 = 190.0;
/// Where no pixel is wrong: the axis has no zero.
const LEAST_WRONG: f64 = 0.5;

/// A curve of the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// In the legend.
    pub name: String,
    /// Joined by a line, ascending in texels.
    pub curve: Vec<Point>,
    /// Dots.
    pub measured: Vec<Point>,
}

/// The picture.
pub fn plot(title: &str, lines: &[Line]) -> String {
    let shown = |p: &Point| [p.texels.log10(), p.wrong.max(LEAST_WRONG).log10()];
    let all: Vec<[f64; 2]> = lines.iter().flat_map(|l| l.curve.iter().chain(&l.measured)).map(shown).collect();
    let range = |axis: usize| decades(all.iter().map(|p| p[axis]));
    let ranges = [range(0), range(1)];
    let at = |[x, y]: [f64; 2]| {
        let part = |v: f64, axis: usize| (v - ranges[axis].0) / (ranges[axis].1 - ranges[axis].0) * SIZE[axis];
        [MARGIN + part(x, 0), MARGIN + SIZE[1] - part(y, 1)]
    };
    let (width, height) = (SIZE[0] + 2.0 * MARGIN + LEGEND, SIZE[1] + 2.0 * MARGIN);
    let mut svg = svg_head(width, height);
    let mut line = |text: String| svg += &(text + "\n");
    line(format!("<text x=\"{MARGIN}\" y=\"30\" font-size=\"16\">{}</text>", escaped(title)));
    let (left, right, top, bottom) = (MARGIN, MARGIN + SIZE[0], MARGIN, MARGIN + SIZE[1]);
    for decade in ranges[0].0 as i32..=ranges[0].1 as i32 {
        let [x, _] = at([f64::from(decade), 0.0]);
        line(format!("<path d=\"M{x:.1} {top}V{bottom}\" stroke=\"#ddd\"/>"));
        line(format!("<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>", bottom + 18.0, power(decade)));
    }
    for decade in ranges[1].0 as i32..=ranges[1].1 as i32 {
        let [_, y] = at([0.0, f64::from(decade)]);
        line(format!("<path d=\"M{left} {y:.1}H{right}\" stroke=\"#ddd\"/>"));
        line(format!("<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>", left - 6.0, y + 4.0, power(decade)));
    }
    for (k, of) in lines.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let points: Vec<String> =
            of.curve.iter().map(|p| at(shown(p))).map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        line(format!("<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\"/>", points.join(" ")));
        for [x, y] in of.measured.iter().map(|p| at(shown(p))) {
            line(format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.5\" fill=\"{colour}\" fill-opacity=\"0.6\"/>"));
        }
        let (x, y) = (right + 24.0, top + 12.0 + 20.0 * k as f64);
        line(format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"5\" fill=\"{colour}\"/>"));
        line(format!("<text x=\"{}\" y=\"{}\">{}</text>", x + 12.0, y + 4.0, escaped(&of.name)));
    }
    let middle = top + SIZE[1] / 2.0;
    line(format!(
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">texels drawn</text>",
        left + SIZE[0] / 2.0,
        height - 20.0
    ));
    line(format!("<text transform=\"translate(18 {middle}) rotate(-90)\" text-anchor=\"middle\">wrong pixels</text>"));
    svg += "</svg>\n";
    svg
}

fn power(decade: i32) -> String {
    if (-1..=4).contains(&decade) { 10_f64.powi(decade).to_string() } else { format!("1e{decade}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped_and_zeros_have_a_place() {
        let point = |texels, wrong| Point { texels, wrong };
        let curve = vec![point(100.0, 40.0), point(1000.0, 0.0)];
        let svg = plot("a < b", &[Line { name: "sun & moon".into(), curve, measured: vec![point(100.0, 41.0)] }]);
        assert!(svg.contains("a &lt; b") && svg.contains("sun &amp; moon") && svg.ends_with("</svg>\n"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert!(!plot("", &[]).contains("NaN"));
    }
}
