//! How far drawn shadow edges lie from exact ones on the film, pixels.
//!
//! An edge element is a pair of neighbouring receivers, side by side or one above the other, with different answers. Each
//! drawn element is measured to the nearest exact one and each exact one to the nearest drawn one, so that neither a
//! shadow drawn too much nor one left out goes unseen. Distances are exact: Felzenszwalb and Huttenlocher, "Distance
//! transforms of sampled functions", 2012, on the grid of pixels.

use super::Receivers;
use crate::scene::Film;
use rayon::prelude::*;

/// Answers on a film: 0 = no receiver, 1 = lit, 2 = shadowed.
type Answers = Vec<u8>;

/// The distance, pixels, within which `quantile` of all edge elements find one of the other kind; 0 without elements. The
/// film's diagonal when one kind is missing.
pub fn edge_distance(receivers: &Receivers, wrong: &[u32], film: Film, quantile: f64) -> f64 {
    let mut exact: Answers = vec![0; film.pixels()];
    for (pixel, shadowed) in receivers.pixels.iter().zip(&receivers.shadowed) {
        exact[*pixel as usize] = 1 + u8::from(*shadowed);
    }
    let mut drawn = exact.clone();
    for i in wrong {
        let pixel = receivers.pixels[*i as usize] as usize;
        drawn[pixel] = 3 - drawn[pixel];
    }
    let (exact, drawn) = (elements(&exact, film), elements(&drawn, film));
    let diagonal = f64::from(film.width).hypot(f64::from(film.height));
    let mut distances: Vec<f64> = match (exact.is_empty(), drawn.is_empty()) {
        (true, true) => return 0.0,
        (false, false) => {
            let (to_exact, to_drawn) = (squared_distances(&exact, film), squared_distances(&drawn, film));
            let there = drawn.iter().map(|p| to_exact[*p as usize]);
            there.chain(exact.iter().map(|p| to_drawn[*p as usize])).map(f64::sqrt).collect()
        }
        _ => return diagonal,
    };
    distances.sort_by(f64::total_cmp);
    let rank = (quantile * distances.len() as f64).ceil() as usize;
    distances[rank.clamp(1, distances.len()) - 1]
}

/// The first pixel of each edge element, ascending, each once.
fn elements(answers: &Answers, film: Film) -> Vec<u32> {
    let (width, height) = (film.width as usize, film.height as usize);
    let differs = |a: usize, b: usize| answers[a] != 0 && answers[b] != 0 && answers[a] != answers[b];
    (0..film.pixels())
        .filter(|&i| {
            let right = i % width + 1 < width && differs(i, i + 1);
            right || (i / width + 1 < height && differs(i, i + width))
        })
        .map(|i| i as u32)
        .collect()
}

/// Squared distance, pixels², of every pixel to the nearest of some pixels.
fn squared_distances(pixels: &[u32], film: Film) -> Vec<f64> {
    let (width, height) = (film.width as usize, film.height as usize);
    let mut rows = vec![f64::INFINITY; film.pixels()];
    for pixel in pixels {
        rows[*pixel as usize] = 0.0;
    }
    rows.par_chunks_mut(width).for_each(lower_envelope);
    let mut columns = vec![0.0; film.pixels()];
    columns.par_chunks_mut(height).enumerate().for_each(|(x, column)| {
        for (y, value) in column.iter_mut().enumerate() {
            *value = rows[y * width + x];
        }
        lower_envelope(column);
    });
    (0..film.pixels()).map(|i| columns[i % width * height + i / width]).collect()
}

/// Replaces f by min over j of f(j) + (i - j)²: the lower envelope of parabolas.
fn lower_envelope(f: &mut [f64]) {
    let mut hull: Vec<(usize, f64, f64)> = Vec::with_capacity(f.len()); // apex, height, from where it is lowest
    for (i, &height) in f.iter().enumerate() {
        if height.is_infinite() {
            continue;
        }
        let mut from = f64::NEG_INFINITY;
        while let Some(&(j, h, start)) = hull.last() {
            let (a, b) = (i as f64, j as f64);
            let meet = ((height + a * a) - (h + b * b)) / (2.0 * (a - b));
            if meet > start {
                from = meet;
                break;
            }
            hull.pop();
        }
        hull.push((i, height, from));
    }
    let mut k = 0;
    for (i, value) in f.iter_mut().enumerate() {
        while k + 1 < hull.len() && hull[k + 1].2 < i as f64 {
            k += 1;
        }
        if let Some((apex, height, _)) = hull.get(k) {
            *value = height + (i as f64 - *apex as f64).powi(2);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_equal_a_plain_search() {
        let film = Film { width: 23, height: 17 };
        let pixels: Vec<u32> = (0..film.pixels() as u32).filter(|i| (i * 7919) % 61 == 3).collect();
        let found = squared_distances(&pixels, film);
        for (i, value) in found.iter().enumerate() {
            let at = |p: usize| ((p % 23) as f64, (p / 23) as f64);
            let plain = pixels
                .iter()
                .map(|p| (at(i).0 - at(*p as usize).0).powi(2) + (at(i).1 - at(*p as usize).1).powi(2))
                .fold(f64::INFINITY, f64::min);
            assert_eq!(*value, plain);
        }
    }

    /// A vertical edge at x = 10, drawn at x = 14.
    #[test]
    fn a_shifted_edge_is_as_far_as_its_shift() {
        let film = Film { width: 32, height: 8 };
        let mut receivers = Receivers::default();
        let mut wrong = Vec::new();
        for i in 0..film.pixels() as u32 {
            receivers.pixels.push(i);
            receivers.positions.push(glam::DVec3::ZERO);
            receivers.shadowed.push(i % 32 < 10);
            if (10..14).contains(&(i % 32)) {
                wrong.push(i);
            }
        }
        assert_eq!(edge_distance(&receivers, &wrong, film, 0.99), 4.0);
        assert_eq!(edge_distance(&receivers, &[], film, 0.99), 0.0);
        let all: Vec<u32> = (0..film.pixels() as u32).filter(|i| i % 32 < 10).collect();
        assert!(edge_distance(&receivers, &all, film, 0.99) > 32.0);
    }
}
