//! A trade as text: the front, and where the presets lie.

use super::sweep::name;
use super::{PointResult, Trade};
use crate::compare::grid;

/// The front from the fastest point on, with the presets among it, and the presets' distance from it.
pub fn table(trade: &Trade) -> String {
    let met = trade.cases.iter().filter(|c| c.thorough_met).count();
    let mut text = format!(
        "{} points on {} lights of frames ({met} met by the thorough preset), {} pixels, epsilon {}; {} threads, median of {}\n\n",
        trade.points.len(),
        trade.cases.len(),
        trade.pixels,
        trade.epsilon,
        trade.threads,
        trade.repeat
    );
    let on_front = |p: &PointResult| trade.front.contains(&p.point.name);
    let mut shown: Vec<&PointResult> =
        trade.points.iter().filter(|p| on_front(p) || p.point.preset.is_some()).collect();
    shown.sort_by(|a, b| a.seconds.total_cmp(&b.seconds).then_with(|| a.point.name.cmp(&b.point.name)));
    let head = ["", "point", "ms/light", "excess texels", "excess wrong", "says met", "truly", "measured"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(shown.into_iter().map(|p| {
        vec![
            if on_front(p) { "front" } else { "" }.to_owned(),
            p.point.name.clone(),
            format!("{:.1}", p.seconds * 1e3),
            percent(p.excess_texels),
            percent(p.excess_misclassified),
            p.said_met.to_string(),
            p.truly_met.to_string(),
            if p.measures { "yes" } else { "no" }.to_owned(),
        ]
    }));
    text += &grid(&rows);
    text += "\nPresets: texels over the cheapest point that takes no longer, time over the fastest that needs no more\n\
             (of points that measure, where the preset does)\n\n";
    let head = ["preset", "ms/light", "excess texels", "over front", "time over front", "cheapest point no slower"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(trade.presets.iter().map(|p| {
        vec![
            name(p.preset),
            format!("{:.1}", p.seconds * 1e3),
            percent(p.excess_texels),
            percent(p.excess_over_front),
            percent(p.time_over_front),
            p.front_point.clone(),
        ]
    }));
    text + &grid(&rows)
}

/// A part as percent, with its sign.
fn percent(part: f64) -> String {
    format!("{:+.1} %", part * 100.0)
}
