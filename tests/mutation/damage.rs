//! Damage to bytes.

/// A linear congruential generator (Knuth's MMIX constants): the same damage every time.
pub(crate) struct Damage(pub(crate) u64);

impl Damage {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound.max(1)
    }

    /// One of some cases with one to four things done to it; `likely` are words that its format knows.
    pub(crate) fn apply(&mut self, cases: &[Vec<u8>], likely: &[&str]) -> Vec<u8> {
        let mut bytes = cases[self.below(cases.len())].clone();
        for _ in 0..=self.below(4) {
            let (at, length) = (self.below(bytes.len() + 1), 1 + self.below(16));
            let end = (at + length).min(bytes.len());
            match self.below(8) {
                0 if at < bytes.len() => bytes[at] = self.below(256) as u8,
                1 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
                2 => bytes.truncate(at),
                3 => drop(bytes.drain(at..end)),
                4 => {
                    let again = bytes[at..end].to_vec();
                    bytes.splice(at..at, again);
                }
                5 => {
                    let other = &cases[self.below(cases.len())];
                    let from = self.below(other.len());
                    let to = (from + 64).min(other.len());
                    bytes.splice(at..end, other[from..to].iter().copied());
                }
                6 => self.replace_number(&mut bytes, at, likely),
                _ => {
                    let word = likely[self.below(likely.len())];
                    bytes.splice(at..at, word.bytes());
                }
            }
        }
        bytes
    }

    /// The number at or after a place by a likely word.
    fn replace_number(&mut self, bytes: &mut Vec<u8>, at: usize, likely: &[&str]) {
        let is_part = |byte: &u8| byte.is_ascii_digit() || b".-".contains(byte);
        let Some(begin) = bytes.iter().skip(at).position(is_part).map(|k| at + k) else { return };
        let end = bytes[begin..].iter().position(|byte| !is_part(byte)).map_or(bytes.len(), |k| begin + k);
        let word = likely[self.below(likely.len())];
        bytes.splice(begin..end, word.bytes());
    }
}

/// A message without its numbers and quotations: what kind of outcome it is. Of several lines the last one says it.
pub(crate) fn skeleton(outcome: &Result<(), String>) -> String {
    let Err(text) = outcome else { return "read".to_owned() };
    let line = text.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default();
    let mut skeleton = String::new();
    let (mut quoted, mut escaped) = (false, false);
    for c in line.chars() {
        match c {
            '"' | '`' if !escaped => quoted = !quoted,
            'a'..='z' | 'A'..='Z' | ' ' if !quoted => skeleton.push(c),
            _ => {}
        }
        escaped = c == '\\' && !escaped;
    }
    // The first word is the folder's path; what the input itself says comes late in a message.
    skeleton.split_whitespace().skip(1).take(5).collect::<Vec<_>>().join(" ")
}
