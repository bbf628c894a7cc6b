//! What plots written as SVG have in common.

/// Colours of lines and dots: Okabe and Ito's, told apart by most eyes; then again from the first.
pub const COLOURS: [&str; 8] = ["#000000", "#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#b8a800"];

/// The beginning of a picture on white, SVG units. `</svg>` ends it.
pub fn svg_head(width: f64, height: f64) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    )
}

/// Text that means itself in XML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The whole decades around decimal logarithms, at least one; those that are not finite have no place.
pub fn decades(logs: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) =
        logs.filter(|v| v.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low <= high { (low.floor(), high.ceil().max(low.floor() + 1.0)) } else { (0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_hold_what_is_shown_and_are_never_empty() {
        assert_eq!(decades([0.3, 2.1, f64::INFINITY].into_iter()), (0.0, 3.0));
        assert_eq!(decades([2.0].into_iter()), (2.0, 3.0));
        assert_eq!(decades([f64::NAN].into_iter()), (0.0, 1.0));
    }
}
