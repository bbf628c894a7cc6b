//! Frame ranges: `N`, `A-B`, `A-BxS`, joined by commas; negative numbers; descending when A > B; a frame named twice
//! counts once, where it first stands.
//!
//! `A-B:S` is refused: it means "one frame in S" to some schedulers and "all frames, in a staggered order" to others.

use super::SceneError;

/// Frames per second where the job does not say.
pub(super) const DEFAULT_FPS: f64 = 24.0;

/// Longest accepted shot, frames: eleven hours at 24 fps. Beyond it a range is a slip of the pen.
const MAX_FRAMES: usize = 1_000_000;

/// How near below a whole frame the last key may lie and still count as that frame, frames. Key times are f32 seconds;
/// half a spacing of f32 at frame 100,000 is 0.004 frames.
const LAST_KEY_SLACK_FRAMES: f64 = 0.01;

/// One moment of the shot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTime {
    /// As a user counts; frame 1 is at t = 0.
    pub frame: i64,
    /// Seconds from the start of the animation: (frame - 1) / fps.
    pub time_s: f64,
}

/// Seconds from the start of the animation of a (fractional) frame number.
pub(super) fn time_s(frame: f64, fps: f64) -> f64 {
    (frame - 1.0) / fps
}

/// Frames 1 to the last one that starts no later than `last_s`.
pub(super) fn whole_animation(last_s: f64, fps: f64) -> Result<Vec<i64>, SceneError> {
    let last = 1.0 + (last_s * fps + LAST_KEY_SLACK_FRAMES).floor();
    if last > MAX_FRAMES as f64 {
        let problem = format!("the animation lasts {last} frames, more than {MAX_FRAMES}; name the ones to plan");
        return Err(SceneError::FrameRange { range: String::new(), problem });
    }
    Ok((1..=(last as i64).max(1)).collect())
}

/// Frames of a written range, in its order, each once.
///
/// # Errors
/// [`SceneError::FrameRange`] for anything but the grammar above, a step below 1, or more than a million frames.
pub fn parse_range(range: &str) -> Result<Vec<i64>, SceneError> {
    let refuse = |problem: String| SceneError::FrameRange { range: range.to_owned(), problem };
    let mut frames = Vec::new();
    for item in range.split(',') {
        let item = item.trim();
        if item.is_empty() {
            return Err(refuse("an empty item; write 5, 1-240, 1-240x2 or several of these with commas".into()));
        }
        if let Some((span, step)) = item.split_once(':') {
            return Err(refuse(format!(
                "\"{item}\" means one frame in {step} to some schedulers, and all of {span} in a staggered order to \
                 others; write {span}x{step} for the former, {span} for the latter"
            )));
        }
        let (first, last, step) = parse_item(item).ok_or_else(|| {
            refuse(format!(
                "\"{item}\" is not a frame, A-B or A-BxS with a step S of 1 or more, as in -5, 10-1, 1-240x2"
            ))
        })?;
        let count = first.abs_diff(last) / step;
        if frames.len() as u64 + count >= MAX_FRAMES as u64 {
            return Err(refuse(format!("more than {MAX_FRAMES} frames; split the shot")));
        }
        let direction = if first <= last { 1 } else { -1 };
        frames.extend((0..=count).map(|k| first + direction * (k * step) as i64));
    }
    let mut seen = std::collections::HashSet::new();
    frames.retain(|frame| seen.insert(*frame));
    Ok(frames)
}

/// First, last and step of one item; `None` when it is not of the grammar.
fn parse_item(item: &str) -> Option<(i64, i64, u64)> {
    let (span, step) = match item.split_once('x') {
        Some((span, step)) => (span, Some(parse_number(step, false)? as u64)),
        None => (item, None),
    };
    // The dash of the span is the first one that follows a digit.
    let dash = span.char_indices().skip(1).find(|&(_, c)| c == '-').map(|(at, _)| at);
    let (first, last) = match dash {
        Some(at) => (parse_number(&span[..at], true)?, parse_number(&span[at + 1..], true)?),
        None if step.is_none() => {
            let frame = parse_number(span, true)?;
            (frame, frame)
        }
        None => return None,
    };
    let step = step.unwrap_or(1);
    (step > 0).then_some((first, last, step))
}

/// Decimal digits with an optional minus sign, small enough that differences and times are exact.
fn parse_number(text: &str, signed: bool) -> Option<i64> {
    /// 2^53: frame numbers pass through f64 on their way to seconds.
    const LIMIT: i64 = 1 << 53;
    let text = text.trim();
    let digits = if signed { text.strip_prefix('-').unwrap_or(text) } else { text };
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    text.parse().ok().filter(|n: &i64| n.abs() <= LIMIT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read_as_written() {
        let cases: &[(&str, &[i64])] = &[
            ("5", &[5]),
            ("-5", &[-5]),
            ("0", &[0]),
            ("1-4", &[1, 2, 3, 4]),
            ("1-10x3", &[1, 4, 7, 10]),
            ("1-9x3", &[1, 4, 7]),
            ("10-1x4", &[10, 6, 2]),
            ("3-1", &[3, 2, 1]),
            ("-2-1", &[-2, -1, 0, 1]),
            ("-1--3", &[-1, -2, -3]),
            ("7-7", &[7]),
            ("7-7x100", &[7]),
            (" 1 - 3 , 2-5x1, 4 ", &[1, 2, 3, 4, 5]),
            ("9,1-3,9", &[9, 1, 2, 3]),
        ];
        for (range, want) in cases {
            assert_eq!(parse_range(range).unwrap(), *want, "{range}");
        }
    }

    #[test]
    fn other_texts_are_refused() {
        for range in [
            "",
            ",",
            "1,",
            "a",
            "1-",
            "--",
            "-",
            "1-2-3",
            "1-10x0",
            "1-10x-2",
            "1-10x",
            "5x2",
            "x2",
            "1..3",
            "1.5",
            "1-3xx2",
            "+4",
            "1-3 4",
            "99999999999999999999",
            "-9007199254740993",
            "1-2000000",
            "é-5",
            "1-3x9223372036854775807",
        ] {
            assert!(matches!(parse_range(range), Err(SceneError::FrameRange { .. })), "{range}");
        }
        let colon = parse_range("1-10:2").unwrap_err().to_string();
        assert!(colon.contains("one frame in 2") && colon.contains("staggered") && colon.contains("1-10x2"), "{colon}");
    }

    #[test]
    fn the_whole_animation_reaches_its_last_key() {
        let last = f64::from(89.0f32 / 24.0);
        assert_eq!(whole_animation(last, 24.0).unwrap().last(), Some(&90));
        assert_eq!(whole_animation(0.0, 24.0).unwrap(), [1]);
        assert_eq!(whole_animation(1.02, 24.0).unwrap().len(), 25);
        assert!(whole_animation(1e30, 24.0).is_err());
    }
}
