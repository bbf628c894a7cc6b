//! A comparison as text.

use super::{Comparison, MethodSummary, Ratio, Summary};

/// The figures as tables of plain text, columns aligned.
pub fn table(comparison: &Comparison, summary: &Summary) -> String {
    let what = match (comparison.texels, comparison.epsilon) {
        (Some(texels), _) => format!("{texels} texels a light"),
        (_, epsilon) => format!("texels for a bound of {}", epsilon.unwrap_or(0.0)),
    };
    let mut text = format!(
        "{} lights ({} with every method, {} without a visible shadow), {} pixels, {what}\n\n",
        comparison.lights.len(),
        summary.common,
        summary.skipped,
        comparison.pixels
    );
    let reference = &summary.reference;
    if comparison.epsilon.is_some() {
        text += &grid(&texels_rows(summary, reference));
        text += &choices(comparison);
        return text;
    }
    text += &grid(&main_rows(summary, reference));
    text += &choices(comparison);
    for m in &summary.methods {
        if let Some(samples) = m.samples {
            text += &format!("\n{}: exact, at the cost of {samples:.0} samples a light in place of texels\n", m.method);
        }
    }
    text += "\nMean wrong pixels over the worst tenth of the lights by each method\n\n";
    text += &grid(&worst_rows(summary));
    text += "\nWrong pixels measured against predicted: slope through the origin, Pearson's r, r of the logarithms\n\n";
    text += &grid(&prediction_rows(summary));
    text
}

/// How often `auto` and `best` came to each method, in the order in which they first did.
fn choices(comparison: &Comparison) -> String {
    let mut text = String::new();
    for method in &comparison.methods {
        let mut counts: Vec<(&str, usize)> = Vec::new();
        for chosen in method.per_light.iter().filter_map(|row| row.chosen.as_deref()) {
            match counts.iter_mut().find(|(name, _)| *name == chosen) {
                Some((_, count)) => *count += 1,
                None => counts.push((chosen, 1)),
            }
        }
        if !counts.is_empty() {
            let listed: Vec<String> = counts.iter().map(|(name, count)| format!("{name} {count} times")).collect();
            text += &format!("\n{} came to {}\n", method.method, listed.join(", "));
        }
    }
    text
}

fn main_rows(summary: &Summary, reference: &str) -> Vec<Vec<String>> {
    let head = [
        "method",
        "wrong",
        "more",
        "edge",
        "by bias",
        "uncertain",
        &format!("/ {reference} [95 %]"),
        "median",
        "edge / [95 %]",
        "n/a",
        "fit s",
        "s/light",
    ];
    let row = |m: &MethodSummary| {
        vec![
            m.method.clone(),
            m.misclassified.to_string(),
            m.percent_more.map_or("-".into(), |p| format!("{p:+.1} %")),
            m.edge.to_string(),
            m.self_shadow.to_string(),
            m.uncertain.to_string(),
            with_interval(&m.ratio),
            number(m.ratio.quartiles.map(|q| q[1]), 3),
            with_interval(&m.edge_ratio),
            m.inapplicable.to_string(),
            format!("{:.3}", m.solve_seconds),
            format!("{:.3}", m.seconds),
        ]
    };
    std::iter::once(head.map(str::to_owned).to_vec()).chain(summary.methods.iter().map(row)).collect()
}

fn texels_rows(summary: &Summary, reference: &str) -> Vec<Vec<String>> {
    let head = [
        "method",
        "texels: quartile",
        "median",
        "quartile",
        &format!("texels / {reference} [95 %]"),
        "quartile",
        "median",
        "quartile",
        "not met",
        "n/a",
        "s/light",
    ];
    let row = |m: &MethodSummary| {
        let quartile = |k: usize| number(m.ratio.quartiles.map(|q| q[k]), 2);
        let texels = |k: usize| number(m.texels.map(|q| q[k]), 0);
        vec![
            m.method.clone(),
            texels(0),
            texels(1),
            texels(2),
            with_interval(&m.ratio),
            quartile(0),
            quartile(1),
            quartile(2),
            m.not_met.to_string(),
            m.inapplicable.to_string(),
            format!("{:.3}", m.seconds),
        ]
    };
    std::iter::once(head.map(str::to_owned).to_vec()).chain(summary.methods.iter().map(row)).collect()
}

fn worst_rows(summary: &Summary) -> Vec<Vec<String>> {
    let mut rows = vec![vec!["worst by".to_owned()]];
    rows[0].extend(summary.methods.iter().map(|m| m.method.clone()));
    for worst in &summary.worst {
        let mut row = vec![worst.by.clone()];
        row.extend(worst.misclassified.iter().map(|v| format!("{v:.0}")));
        rows.push(row);
    }
    rows
}

fn prediction_rows(summary: &Summary) -> Vec<Vec<String>> {
    let head = ["method", "saturating", "r", "r log", "unsaturated", "r", "r log"];
    let row = |m: &MethodSummary| {
        let mut row = vec![m.method.clone()];
        for c in [m.predicted, m.unsaturated] {
            row.extend([number(c.slope, 3), number(c.r, 3), number(c.r_log, 3)]);
        }
        row
    };
    std::iter::once(head.map(str::to_owned).to_vec()).chain(summary.methods.iter().map(row)).collect()
}

fn with_interval(ratio: &Ratio) -> String {
    match (ratio.of_sums, ratio.interval) {
        (Some(of_sums), Some([low, high])) => format!("{of_sums:.3} [{low:.3}, {high:.3}]"),
        (of_sums, _) => number(of_sums, 3),
    }
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_owned(), |v| format!("{v:.digits$}"))
}

/// Columns as wide as their widest cell, two spaces apart; the first one aligned left, the others right.
pub(crate) fn grid(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |k: usize| rows.iter().filter_map(|r| r.get(k)).map(|c| c.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (k, cell) in row.iter().enumerate() {
            let width = widths[k];
            line += &if k == 0 { format!("{cell:<width$}") } else { format!("  {cell:>width$}") };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let rows = [["a", "1"], ["long", "23"]].map(|r| r.map(str::to_owned).to_vec());
        assert_eq!(grid(&rows), "a      1\nlong  23\n");
    }
}
