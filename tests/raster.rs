//! Rules of rasterisation, against a plain reading of them and against ray casting.

use glam::{DMat4, DVec3, DVec4, Vec3};
use lixel::raster::{Bias, Canvas, DepthMap, FAR, RasterError, draw};
use lixel::scene::{Geometry, Triangle};

/// A linear congruential generator: tests must not change with a crate.
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

fn still(triangles: &[Triangle]) -> Geometry<'_> {
    Geometry::plain(triangles, &[])
}

#[expect(clippy::unwrap_used, reason = "a map that cannot be drawn fails the test")]
fn drawn(triangles: &[Triangle], clip_from_scene: &DMat4, width: u32, height: u32) -> DepthMap {
    draw(still(triangles), clip_from_scene, width, height, Bias::NONE).unwrap()
}

/// Clip space from texels: x, y in texels from the bottom left, z the window depth.
fn clip_from_texels(width: u32, height: u32) -> DMat4 {
    DMat4::from_translation(DVec3::splat(-1.0))
        * DMat4::from_scale(DVec3::new(2.0 / f64::from(width), 2.0 / f64::from(height), 2.0))
}

/// A perspective light at the origin looking along -z, 90 degrees wide.
fn clip_perspective(near: f64, far: f64) -> DMat4 {
    DMat4::from_cols(
        DVec4::new(1.0, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 1.0, 0.0, 0.0),
        DVec4::new(0.0, 0.0, (far + near) / (near - far), -1.0),
        DVec4::new(0.0, 0.0, 2.0 * far * near / (near - far), 0.0),
    )
}

/// The rules, written down without haste: one triangle inside the clip volume, window coordinates.
fn reference(v: [DVec3; 3], width: u32, height: u32, bias: Bias) -> Vec<f32> {
    let snap = |t: f64| (t * 256.0).round_ties_even() as i64;
    let mut p = v.map(|v| (snap(v.x), snap(v.y)));
    let cross = |a: (i64, i64), b: (i64, i64), c: (i64, i64)| (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0);
    if cross(p[0], p[1], p[2]) < 0 {
        p.swap(1, 2);
    }
    let (e, f) = (v[1] - v[0], v[2] - v[0]);
    let n = e.cross(f);
    let (z_u, z_v) = (-n.x / n.z, -n.y / n.z);
    let offset = bias.constant + (bias.slope * z_u.abs().max(z_v.abs())).min(bias.clamp);
    let (least, most) = (v[0].z.min(v[1].z).min(v[2].z), v[0].z.max(v[1].z).max(v[2].z));
    let mut depth = vec![FAR; (width * height) as usize];
    for y in 0..height {
        for x in 0..width {
            let centre = (i64::from(x) * 256 + 128, i64::from(y) * 256 + 128);
            let inside = cross(p[0], p[1], p[2]) != 0
                && (0..3).all(|i| {
                    let (a, b) = (p[i], p[(i + 1) % 3]);
                    let top_left = b.1 < a.1 || (b.1 == a.1 && b.0 < a.0);
                    let side = cross(a, b, centre);
                    side > 0 || (side == 0 && top_left)
                });
            if inside {
                let z = v[0].z + z_u * (f64::from(x) + 0.5 - v[0].x) + z_v * (f64::from(y) + 0.5 - v[0].y);
                depth[(y * width + x) as usize] = (z.clamp(least, most) + offset).clamp(0.0, 1.0) as f32;
            }
        }
    }
    depth
}

fn vertex(x: f64, y: f64, z: f64) -> Vec3 {
    DVec3::new(x, y, z).as_vec3()
}

#[test]
fn single_triangles_follow_the_rules() {
    let mut random = Random(1);
    let bias = Bias { constant: 1e-3, slope: 0.7, clamp: 0.05 };
    for case in 0..3000 {
        let (width, height) = [(64, 48), (5, 9), (200, 33), (8, 8), (1, 70)][case % 5];
        // From a texel's worth to far beyond the map, a third of them on half texels, where ties are decided.
        let scale = [1.5, 12.0, 90.0, 4000.0][case / 5 % 4];
        let (cx, cy) = (random.within(0.0, f64::from(width)), random.within(0.0, f64::from(height)));
        let triangle = [(); 3].map(|()| {
            let (mut x, mut y) = (cx + random.within(-scale, scale), cy + random.within(-scale, scale));
            if case % 3 == 0 {
                (x, y) = ((2.0 * x).round() / 2.0, (2.0 * y).round() / 2.0);
            }
            vertex(x, y, random.within(0.1, 0.9))
        });
        let map = draw(still(&[triangle]), &clip_from_texels(width, height), width, height, bias).unwrap();
        let wanted = reference(triangle.map(|v| v.as_dvec3()), width, height, bias);
        for (i, (&got, &wanted)) in map.depth.iter().zip(&wanted).enumerate() {
            // Two ways of writing a plane differ by rounding, which slivers magnify.
            assert_eq!(got == FAR, wanted == FAR, "case {case}, texel {i}: {got} for {wanted}, {triangle:?}");
            assert!((got - wanted).abs() < 2e-6, "case {case}, texel {i}: {got} for {wanted}, {triangle:?}");
        }
    }
}

/// A grid over more than the map whose inner vertices are jittered, each quad split along a random diagonal.
fn jittered_grid(random: &mut Random, cells: usize, low: f64, high: f64, z: impl Fn(f64, f64) -> f64) -> Vec<Triangle> {
    let step = (high - low) / cells as f64;
    let mut vertices = Vec::new();
    for j in 0..=cells {
        for i in 0..=cells {
            let x = low + step * (i as f64 + random.within(-0.3, 0.3));
            let y = low + step * (j as f64 + random.within(-0.3, 0.3));
            vertices.push(vertex(x, y, z(x, y)));
        }
    }
    let mut triangles = Vec::new();
    for j in 0..cells {
        for i in 0..cells {
            let a = j * (cells + 1) + i;
            let quad = [a, a + 1, a + cells + 2, a + cells + 1].map(|k| vertices[k]);
            let [a, b, c, d] = quad;
            triangles.extend(if random.unit() < 0.5 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [d, b, c]] });
        }
    }
    triangles
}

#[test]
fn a_mesh_covers_every_texel_exactly_once() {
    let mut random = Random(2);
    for (cells, size) in [(3, 61), (24, 61), (150, 61), (40, 240)] {
        let triangles = jittered_grid(&mut random, cells, -0.5 * f64::from(size), 1.5 * f64::from(size), |_, _| 0.5);
        let mut covered = vec![0; (size * size) as usize];
        for triangle in &triangles {
            let map = drawn(std::slice::from_ref(triangle), &clip_from_texels(size, size), size, size);
            for (count, &depth) in covered.iter_mut().zip(&map.depth) {
                *count += u32::from(depth != FAR);
            }
        }
        assert!(covered.iter().all(|&count| count == 1), "{cells} cells on {size} texels");
    }
}

#[test]
fn clipped_meshes_do_not_crack() {
    // A ground that passes below, beside and behind the light: near, far and guard-band clipping all at once.
    let mut random = Random(3);
    let ground: Vec<Triangle> = jittered_grid(&mut random, 60, -40.0, 40.0, |_, _| 0.0)
        .iter()
        .map(|t| t.map(|v| Vec3::new(v.x, -1.0, v.y)))
        .collect();
    let (near, far, size) = (0.25, 30.0, 300);
    let map = drawn(&ground, &clip_perspective(near, far), size, size);
    let mut hits = 0;
    for row in 0..size {
        for column in 0..size {
            let ndc_y = (f64::from(row) + 0.5) / f64::from(size) * 2.0 - 1.0;
            let got = f64::from(map.depth[(row * size + column) as usize]);
            // The ray (ndc_x, ndc_y, -1) meets y = -1 at the distance -1/ndc_y along the axis.
            let distance = -1.0 / ndc_y;
            if ndc_y < 0.0 && distance < far * 0.999 {
                let window = 0.5 * ((far + near) - 2.0 * far * near / distance) / (far - near) + 0.5;
                assert!((got - window).abs() < 1e-6, "texel ({column}, {row}): {got} for {window}");
                hits += 1;
            } else if ndc_y >= 0.0 || distance > far * 1.001 {
                assert_eq!(got, f64::from(FAR), "texel ({column}, {row})");
            }
        }
    }
    assert!(hits > 40_000, "{hits}");
}

#[test]
fn a_clipped_triangle_keeps_the_slope_of_its_plane() {
    // y = -1 around the light: window depth is 0.5 + 0.5 (f + n + 2 f n ndc_y) / (f - n), affine in the row.
    let ground = [vertex(-500.0, -1.0, 800.0), vertex(-700.0, -1.0, -900.0), vertex(1000.0, -1.0, -100.0)];
    let (near, far, size, slope) = (0.5, 20.0, 64, 3.0);
    let bias = Bias { constant: 0.0, slope, clamp: f64::INFINITY };
    let map = draw(still(&[ground]), &clip_perspective(near, far), size, size, bias).unwrap();
    let per_row = far * near / (far - near) * 2.0 / f64::from(size);
    // From row 27 on, depth and bias add up to more than 1.
    for row in 0..27 {
        let ndc_y = (f64::from(row) + 0.5) / f64::from(size) * 2.0 - 1.0;
        let window = 0.5 + 0.5 * (far + near + 2.0 * far * near * ndc_y) / (far - near);
        let got = f64::from(map.depth[(row * size + 30) as usize]);
        assert!(
            (got - (window + slope * per_row)).abs() < 1e-6,
            "row {row}: {got} for {window} and {slope} * {per_row}"
        );
    }
}

#[test]
fn nothing_nearer_than_the_near_plane_is_drawn() {
    let wall = |z: f64| [vertex(-9.0, -9.0, z), vertex(9.0, -9.0, z), vertex(0.0, 9.0, z)];
    let clip = clip_perspective(1.0, 10.0);
    for (z, seen) in [(-0.99, false), (-1.01, true), (-9.9, true), (-10.1, false), (5.0, false)] {
        let map = drawn(&[wall(z)], &clip, 16, 16);
        assert_eq!(map.depth.iter().any(|&d| d != FAR), seen, "wall at {z}");
    }
}

#[test]
fn a_triangle_through_the_light_itself_is_harmless() {
    let map = drawn(
        &[[vertex(0.0, 0.0, 0.0), vertex(1.0, 0.0, -4.0), vertex(0.0, 1.0, -4.0)]],
        &clip_perspective(1.0, 10.0),
        32,
        32,
    );
    assert!(map.depth.iter().all(|d| (0.0..=1.0).contains(d)));
}

#[test]
fn both_faces_are_drawn_and_the_nearest_wins() {
    let at = |z: f64| [vertex(-10.0, -10.0, z), vertex(50.0, -10.0, z), vertex(-10.0, 50.0, z)];
    let [a, b, c] = at(0.25);
    for triangles in [[at(0.5), [a, b, c]], [[a, c, b], at(0.5)]] {
        let map = drawn(&triangles, &clip_from_texels(16, 16), 16, 16);
        assert!(map.depth.iter().all(|&d| d == 0.25));
    }
}

#[test]
fn slope_bias_counts_texels_and_is_clamped() {
    // Depth rises by 1/64 per texel along x and half as much along y.
    let plane = |x: f64, y: f64| vertex(x, y, 0.25 + (x + 0.5 * y) / 64.0);
    let triangle = [plane(-8.0, -8.0), plane(40.0, -8.0), plane(-8.0, 40.0)];
    let depth = |bias| draw(still(&[triangle]), &clip_from_texels(16, 16), 16, 16, bias).unwrap().depth[0];
    let centre = (0.25 + 0.75 / 64.0) as f32;
    let near = |got: f32, wanted: f32| assert!((got - wanted).abs() < 1e-6, "{got} for {wanted}");
    near(depth(Bias::NONE), centre);
    near(depth(Bias { constant: 0.01, slope: 2.0, clamp: f64::INFINITY }), centre + 0.01 + 2.0 / 64.0);
    near(depth(Bias { constant: 0.01, slope: 2.0, clamp: 0.005 }), centre + 0.015);
    near(depth(Bias { constant: 5.0, slope: 0.0, clamp: 0.0 }), 1.0);
}

#[test]
fn slivers_stay_within_their_own_depths() {
    let mut random = Random(4);
    for _ in 0..2000 {
        let (x, y) = (random.within(0.0, 32.0), random.within(0.0, 32.0));
        let tiny = random.within(-14.0, -2.0);
        let triangle =
            [vertex(x, y, 0.4), vertex(x + 20.0, y + 11.0, 0.5), vertex(x + 10.0 + 10_f64.powf(tiny), y + 5.5, 0.6)];
        let map = drawn(&[triangle], &clip_from_texels(64, 64), 64, 64);
        assert!(map.depth.iter().all(|&d| d == FAR || (0.4..=0.6).contains(&d)));
    }
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let mut random = Random(5);
    let triangles = jittered_grid(&mut random, 90, -3.0, 3.0, |x, y| -3.0 + (3.0 * x).sin() * (2.0 * y).cos());
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| drawn(&triangles, &clip_perspective(1.0, 6.0), 333, 517))
    };
    let one = with(1);
    assert!(one.depth.iter().any(|&d| d != FAR));
    assert_eq!(one, with(2));
    assert_eq!(one, with(5));
}

#[test]
fn only_kept_triangles_are_drawn_and_counted() {
    let mut random = Random(6);
    let triangles = jittered_grid(&mut random, 30, 0.0, 64.0, |x, _| 0.3 + x / 200.0);
    let (still, moving) = triangles.split_at(700);
    let clip = clip_from_texels(64, 64);
    let odd = |i: u32| i % 2 == 1;
    let mut canvas = Canvas::default();
    let counts = canvas.draw(Geometry::plain(still, moving), &clip, 64, 64, Bias::NONE, odd).unwrap();
    let odd_only: Vec<Triangle> = triangles.iter().skip(1).step_by(2).copied().collect();
    assert_eq!(canvas.map, drawn(&odd_only, &clip, 64, 64));
    assert_eq!(counts.kept, 900);
    assert!(counts.drawn > 800 && counts.drawn <= 900, "{counts:?}");
}

#[test]
fn a_canvas_forgets_what_it_drew() {
    let triangles = jittered_grid(&mut Random(7), 40, -5.0, 90.0, |x, y| 0.3 + x / 400.0 + y / 900.0);
    let mut canvas = Canvas::default();
    for (width, height) in [(80, 60), (31, 77), (200, 100), (80, 60)] {
        let clip = clip_from_texels(width, height);
        canvas.draw(still(&triangles), &clip, width, height, Bias::NONE, |_| true).unwrap();
        assert_eq!(canvas.map, drawn(&triangles, &clip, width, height));
    }
    let before = canvas.map.clone();
    assert!(canvas.draw(still(&triangles), &DMat4::IDENTITY, 0, 9, Bias::NONE, |_| true).is_err());
    assert_eq!(canvas.map, before);
    for geometry in [still(&triangles), still(&[])] {
        let counts = canvas.draw(geometry, &DMat4::IDENTITY, 80, 60, Bias::NONE, |_| false).unwrap();
        assert_eq!((counts.kept, counts.drawn), (0, 0));
        assert!(canvas.map.depth.iter().all(|&d| d == FAR));
    }
}

#[test]
fn extreme_shapes_of_maps_can_be_drawn() {
    let everything = [vertex(-3.0, -1.0, -2.0), vertex(9.0, -1.0, -2.0), vertex(-3.0, 9.0, -2.0)];
    let clip = DMat4::from_scale(DVec3::new(1.0, 1.0, 0.1));
    for (width, height) in [(1, 1), (7, 3), (16384, 1), (1, 16384), (16384, 40)] {
        let map = drawn(&[everything], &clip, width, height);
        assert_eq!(map.depth.len(), (width * height) as usize);
        assert!(map.depth.iter().all(|&d| (d - 0.4).abs() < 1e-6), "{width} x {height}");
    }
}

#[test]
fn what_is_no_number_is_not_drawn() {
    let mut bad = vec![[Vec3::NAN, Vec3::ZERO, Vec3::ONE], [Vec3::INFINITY, Vec3::ZERO, Vec3::ONE]];
    bad.push([Vec3::MAX, Vec3::MIN, Vec3::X]);
    for clip in [DMat4::IDENTITY, clip_perspective(0.1, 10.0), DMat4::ZERO, DMat4::from_scale(DVec3::splat(f64::MAX))] {
        let map = drawn(&bad, &clip, 32, 32);
        assert!(map.depth.iter().all(|d| (0.0..=1.0).contains(d)));
    }
}

#[test]
fn illegal_requests_are_named() {
    let clip = DMat4::IDENTITY;
    let size = |w, h| draw(still(&[]), &clip, w, h, Bias::NONE).unwrap_err();
    assert_eq!(size(0, 4), RasterError::Size { width: 0, height: 4 });
    assert_eq!(size(4, 16385), RasterError::Size { width: 4, height: 16385 });
    let mut broken = clip;
    broken.z_axis.y = f64::INFINITY;
    let error = draw(still(&[]), &broken, 4, 4, Bias::NONE).unwrap_err();
    assert_eq!(error, RasterError::Matrix { row: 1, column: 2, value: f64::INFINITY });
    assert!(error.to_string().contains("row 1, column 2"));
    let bias = Bias { slope: f64::NAN, ..Bias::NONE };
    assert!(matches!(draw(still(&[]), &clip, 4, 4, bias), Err(RasterError::Bias { .. })));
    assert!(drawn(&[], &clip, 4, 4).depth.iter().all(|&d| d == FAR));
}
