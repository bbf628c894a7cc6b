//! Time against excess texels, one mark a point, as SVG: both axes logarithmic, the front as stairs.

use super::sweep::{PRESETS, name};
use super::{PointResult, Trade};
use crate::job::Preset;
use crate::picture::{COLOURS, svg_head};

/// The plotting area and the room around it, SVG units.
const SIZE: [f64; 2] = [760.0, 440.0];
const MARGIN: [f64; 2] = [84.0, 56.0];
/// Excess texels that the price axis may name, percent.
const NAMED: [f64; 15] =
    [-50.0, -30.0, -20.0, -10.0, 0.0, 10.0, 25.0, 50.0, 100.0, 200.0, 400.0, 900.0, 1900.0, 4900.0, 9900.0];
/// Times that the time axis may name, within a decade.
const STEPS: [f64; 3] = [1.0, 2.0, 5.0];
/// Free room beside the outermost marks, part of the span.
const BORDER: f64 = 0.06;

/// The picture.
pub fn plot(trade: &Trade) -> String {
    let frame = Frame {
        x: Axis::over(trade.points.iter().map(|p| p.seconds * 1e3), SIZE[0]),
        y: Axis::over(trade.points.iter().map(price), SIZE[1]),
    };
    let (width, height) = (SIZE[0] + MARGIN[0] + 40.0, SIZE[1] + 2.0 * MARGIN[1]);
    let head = svg_head(width, height);
    let mut lines = frame.grid();
    lines.extend(frame.stairs(trade));
    lines.extend(trade.points.iter().filter(|p| p.point.preset.is_none()).map(|p| frame.mark(p)));
    lines.extend(trade.points.iter().filter(|p| p.point.preset.is_some()).map(|p| frame.preset(p)));
    lines.extend(words(trade, height));
    head + &lines.join("\n") + "\n</svg>\n"
}

/// Right and bottom end of the plotting area.
const END: [f64; 2] = [MARGIN[0] + SIZE[0], MARGIN[1] + SIZE[1]];

/// Where milliseconds and prices lie.
struct Frame {
    x: Axis,
    y: Axis,
}

impl Frame {
    fn at(&self, p: &PointResult) -> [f64; 2] {
        [MARGIN[0] + self.x.place(p.seconds * 1e3), END[1] - self.y.place(price(p))]
    }

    /// Lines at round times and prices, and their names.
    fn grid(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for ms in (-3..7).flat_map(|decade| STEPS.map(|step| step * 10_f64.powi(decade))) {
            let Some(at) = self.x.within(ms).map(|at| MARGIN[0] + at) else { continue };
            lines.push(format!("<path d=\"M{at:.1} {}V{}\" stroke=\"#ddd\"/>", MARGIN[1], END[1]));
            lines.push(format!(
                "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                END[1] + 18.0,
                short(ms)
            ));
        }
        for percent in NAMED {
            let Some(at) = self.y.within(1.0 + percent / 100.0).map(|at| END[1] - at) else { continue };
            lines.push(format!("<path d=\"M{} {at:.1}H{}\" stroke=\"#ddd\"/>", MARGIN[0], END[0]));
            lines.push(format!(
                "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{percent:+} %</text>",
                MARGIN[0] - 6.0,
                at + 4.0
            ));
        }
        lines
    }

    /// The front: a stair of what is not measured and one of what is.
    fn stairs(&self, trade: &Trade) -> Vec<String> {
        let on_front = |p: &&PointResult| trade.front.contains(&p.point.name);
        let mut front: Vec<&PointResult> = trade.points.iter().filter(on_front).collect();
        front.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let stair = |measured: bool, dashes: &str| {
            let corners: Vec<[f64; 2]> = front.iter().filter(|p| p.measures == measured).map(|p| self.at(p)).collect();
            let from = corners.first()?[0];
            let steps: String = corners.iter().map(|[x, y]| format!("H{x:.1}V{y:.1}")).collect();
            Some(format!(
                "<path d=\"M{from:.1} {}{steps}H{}\" fill=\"none\" stroke=\"#888\" stroke-width=\"1.5\" \
                 stroke-dasharray=\"{dashes}\"/>",
                MARGIN[1], END[0]
            ))
        };
        [stair(false, "5 4"), stair(true, "none")].into_iter().flatten().collect()
    }

    fn mark(&self, p: &PointResult) -> String {
        let [x, y] = self.at(p);
        let style = style(p, colour_of(p));
        format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" {style}><title>{}</title></circle>", title(p))
    }

    /// A preset: a diamond, with its name below, where cheaper points are few; of neighbours the names run apart.
    fn preset(&self, p: &PointResult) -> String {
        let [x, y] = self.at(p);
        let diamond = format!("M{:.1} {y:.1}l8 -8l8 8l-8 8z", x - 8.0);
        let (anchor, beside) = if p.point.preset == Some(Preset::Standard) { ("end", 8.0) } else { ("start", -8.0) };
        let place = format!("x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\"", x + beside, y + 24.0);
        format!(
            "<path d=\"{diamond}\" {}><title>{}</title></path>\n<text {place} font-weight=\"bold\">{}</text>",
            style(p, "#000"),
            title(p),
            p.point.name
        )
    }
}

/// Title, legend and the names of the axes.
fn words(trade: &Trade, height: f64) -> Vec<String> {
    let mut lines = vec![format!(
        "<text x=\"{}\" y=\"24\" font-size=\"16\">Time against texels: {} operating points, {} lights</text>",
        MARGIN[0],
        trade.points.len(),
        trade.cases.len()
    )];
    // Fast and cheap is where no point is.
    let (left, top) = (MARGIN[0] + 20.0, END[1] - 72.0);
    for (k, preset) in PRESETS.iter().enumerate() {
        let y = top + 18.0 * k as f64;
        let (colour, name) = (colour(*preset), name(*preset));
        lines.push(format!("<circle cx=\"{left}\" cy=\"{}\" r=\"4\" fill=\"{colour}\"/>", y - 4.0));
        lines.push(format!("<text x=\"{}\" y=\"{y}\">around {name}</text>", left + 10.0));
    }
    lines.push(format!("<text x=\"{}\" y=\"{}\">hollow, dashed: not measured</text>", left - 4.0, top + 54.0));
    let middle = [MARGIN[0] + SIZE[0] / 2.0, MARGIN[1] + SIZE[1] / 2.0];
    let threads = if trade.threads == 1 { "1 thread".to_owned() } else { format!("{} threads", trade.threads) };
    lines.push(format!(
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">milliseconds for each light of a frame, {threads}</text>",
        middle[0],
        height - 14.0
    ));
    lines.push(format!(
        "<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">texels more than the thorough preset</text>",
        middle[1]
    ));
    lines
}

/// Price over the thorough preset's.
fn price(p: &PointResult) -> f64 {
    1.0 + p.excess_texels
}

/// The colour of a preset and of the points around it.
fn colour(preset: Preset) -> &'static str {
    match preset {
        Preset::Draft => COLOURS[2],
        Preset::Standard => COLOURS[1],
        Preset::Thorough => COLOURS[3],
    }
}

/// The colour of the preset that a point varies.
fn colour_of(p: &PointResult) -> &'static str {
    let base = PRESETS.into_iter().find(|preset| p.point.name.starts_with(&name(*preset)));
    colour(base.unwrap_or_default())
}

/// Filled where the point measures, else hollow.
fn style(p: &PointResult, stroke: &str) -> String {
    let fill = if p.measures { colour_of(p) } else { "white" };
    format!("fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"1.5\"")
}

fn title(p: &PointResult) -> String {
    format!("{}: {} ms, {:+.1} % texels", p.point.name, short(p.seconds * 1e3), p.excess_texels * 100.0)
}

/// A time in few digits.
fn short(ms: f64) -> String {
    if ms >= 10.0 { format!("{ms:.0}") } else { format!("{ms}").chars().take(5).collect() }
}

/// A logarithmic axis.
struct Axis {
    /// Natural logarithms of its ends.
    from: f64,
    to: f64,
    /// SVG units.
    length: f64,
}

impl Axis {
    /// Over positive values, with some room.
    fn over(values: impl Iterator<Item = f64>, length: f64) -> Axis {
        let logs = values.filter(|v| *v > 0.0).map(f64::ln);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let border = ((high - low) * BORDER).max(BORDER);
        Axis { from: low - border, to: high + border, length }
    }

    /// Where a value lies, SVG units from the axis' beginning.
    fn place(&self, value: f64) -> f64 {
        (value.max(f64::MIN_POSITIVE).ln() - self.from) / (self.to - self.from) * self.length
    }

    /// The same, for values on the axis.
    fn within(&self, value: f64) -> Option<f64> {
        Some(self.place(value)).filter(|at| (0.0..=self.length).contains(at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_hold_their_values_and_grow_with_them() {
        let axis = Axis::over([3.0, 40.0, 0.5].into_iter(), 100.0);
        let at: Vec<f64> = [0.5, 3.0, 40.0].iter().map(|v| axis.within(*v).unwrap()).collect();
        assert!(at.is_sorted() && at[0] > 0.0 && at[2] < 100.0);
        assert_eq!(axis.within(0.01), None);
        let one = Axis::over([2.0].into_iter(), 100.0);
        assert!((one.place(2.0) - 50.0).abs() < 1e-9);
        assert!(Axis::over(std::iter::empty(), 100.0).place(1.0).is_finite());
    }

    #[test]
    fn times_are_short() {
        assert_eq!([0.5, 2.0, 1234.5].map(short), ["0.5", "2", "1234"]);
    }
}
