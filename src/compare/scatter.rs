//! Measured against predicted wrong pixels, one dot a light and method, both axes logarithmic, as SVG.

use super::Comparison;
use crate::picture::{COLOURS, decades, svg_head};

/// Side of the plotting square and the room around it, SVG units.
const SIDE: f64 = 560.0;
const MARGIN: f64 = 70.0;
/// Width of the legend.
const LEGEND: f64 = 190.0;

/// The picture. Lights with a zero on either axis have no place on it and are counted in its title.
pub fn scatter(comparison: &Comparison) -> String {
    let points: Vec<(usize, f64, f64)> = comparison
        .methods
        .iter()
        .enumerate()
        .flat_map(|(k, m)| m.per_light.iter().filter_map(move |r| r.measured.as_ref().map(|m| (k, m))))
        .filter_map(|(k, m)| Some((k, m.predicted?, m.misclassified as f64)))
        .collect();
    let shown: Vec<&(usize, f64, f64)> = points.iter().filter(|p| p.1 > 0.0 && p.2 > 0.0).collect();
    let (low, high) = decades(shown.iter().flat_map(|p| [p.1.log10(), p.2.log10()]));
    let place = |log: f64| (log - low) / (high - low) * SIDE;
    let x = |log: f64| MARGIN + place(log);
    let y = |log: f64| MARGIN + SIDE - place(log);

    let (width, height) = (SIDE + 2.0 * MARGIN + LEGEND, SIDE + 2.0 * MARGIN);
    let mut svg = svg_head(width, height);
    let mut line = |text: String| svg += &(text + "\n");
    let hidden = points.len() - shown.len();
    let left_out = if hidden > 0 { format!(", {hidden} with a zero left out") } else { String::new() };
    line(format!(
        "<text x=\"{MARGIN}\" y=\"30\" font-size=\"16\">Wrong pixels: {} points{left_out}</text>",
        shown.len()
    ));
    for decade in low as i32..=high as i32 {
        let (at_x, at_y) = (x(f64::from(decade)), y(f64::from(decade)));
        let (top, bottom, right) = (MARGIN, MARGIN + SIDE, MARGIN + SIDE);
        line(format!("<path d=\"M{at_x:.1} {top}V{bottom}M{MARGIN} {at_y:.1}H{right}\" stroke=\"#ddd\"/>"));
        let value = 10_f64.powi(decade);
        line(format!("<text x=\"{at_x:.1}\" y=\"{}\" text-anchor=\"middle\">{value}</text>", bottom + 18.0));
        line(format!("<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{value}</text>", MARGIN - 6.0, at_y + 4.0));
    }
    line(format!(
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#888\" stroke-dasharray=\"5 4\"/>",
        x(low),
        y(low),
        x(high),
        y(high)
    ));
    for (k, predicted, measured) in &shown {
        let (at_x, at_y) = (x(predicted.log10()), y(measured.log10()));
        let colour = COLOURS[k % COLOURS.len()];
        line(format!("<circle cx=\"{at_x:.1}\" cy=\"{at_y:.1}\" r=\"2.5\" fill=\"{colour}\" fill-opacity=\"0.6\"/>"));
    }
    let middle = MARGIN + SIDE / 2.0;
    line(format!("<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">predicted</text>", height - 20.0));
    line(format!("<text transform=\"translate(18 {middle}) rotate(-90)\" text-anchor=\"middle\">measured</text>"));
    for (k, method) in comparison.methods.iter().enumerate() {
        let at_y = MARGIN + 12.0 + 20.0 * k as f64;
        let left = MARGIN + SIDE + 24.0;
        line(format!("<circle cx=\"{left}\" cy=\"{at_y}\" r=\"5\" fill=\"{}\"/>", COLOURS[k % COLOURS.len()]));
        line(format!("<text x=\"{}\" y=\"{}\">{}</text>", left + 12.0, at_y + 4.0, method.method));
    }
    svg += "</svg>\n";
    svg
}
