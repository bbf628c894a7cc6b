//! Streams of meshoptimizer's own encoder (npm package 1.3.0: `encodeVertexBufferLevel` of level 3, `encodeIndexBuffer`,
//! `encodeIndexSequence`) and what its decoder makes of its filters.

use super::*;

const ATTRIBUTES_0: &str = "a01f004a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4affff00004a4a4a4a4a4a4a4a150002000800\
    200080020000001f000a1e32465a6e8296aabed2e6faf1ddc9b5a18d7965513d29150112263a4e62ffff0000768a9eb2c6daeefd\
    15000082228a2aaaaaeaee0000040404000000001f00deb98ec941a66e699e064e0981992e565ec60eb6c12611e91e793189fee6\
    51ffff00002921467136be59911f0058f87266a838fbf18b1fc6f361b16dc0081db18a6ffa27caeb05ef1d8940d6ffff00002e69\
    d3f712561c751f0000e3bafaaf831853daf0062e1427299696229c74f69ad9cd59543b6c290e3effff00005256755b0e74ec361f\
    00444666b0a4d06fecc1c558567ecc813deeb64ba1390f7e5fd73f673bfa5c7effff000050b3d05229f13b5300001f0040404040\
    2020c0404040402020c0404040402020c0404040402020c0404040ffff0000402020c04040404015008102040810204081020000\
    0000000000000000000000000000000000000000040302016c59883c0000803f";
const ATTRIBUTES_1: &str = "a17baaff69004a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a4a000a1e32465a6e\
    8296aabed2e6fa0e22364a5e72869aaec2d6eafe12263a4e62768a9eb2c6daee021400c00101555556aaaaab00000300deb98ec9\
    41a66e699e064e0981992e565ec60eb6c12611e91e793189fee6512921467136be59910058f87266a838fbf18b1fc6f361b16dc0\
    081db18a6ffa27caeb05ef1d8940d62e69d3f712561c750000e3bafaaf831853daf0062e1427299696229c74f69ad9cd59543b6c\
    290e3e5256755b0e74ec3600444666b0a4d06fecc1c558567ecc813deeb64ba1390f7e5fd73f673bfa5c7e50b3d05229f13b5300\
    9048070707072412070707078900070707192edfbb7e06fe03fa06fe03fa62f13f262f13f262fefafefadfbb0000fe03fa06fe00\
    00000000000000040302016c59883c0000803f01000042";
const TRIANGLES: &str =
    "e1f0101010ff101fff1f1efffeff5fff12010106ffb40163322fda6300ff6401605b007687566778a9866589689801690000";
const INDICES: &str = "d100040404a11f04050405ac8b118f1f17c0bcbf0700000000";

/// Per filter and stride: as encoded, as decoded.
const FILTERS: [(Filter, usize, &str, &str); 6] = [
    (Filter::Octahedral, 4, "7f3c7f81d3727f7fadee7f8118d17f7f", "5f00ab81ed75d27f89e6258128b25c7f"),
    (
        Filter::Octahedral,
        8,
        "ff07ca03ff07018032fd2707ff07ff7fbffae4feff0701807f0111fdff07ff7f",
        "1c5f000057aa0180c3ec617649d3ff7f2f88b3e63d2501807327a6b20a5eff7f",
    ),
    (
        Filter::Quaternion,
        8,
        "0000ec048e04fc0713fae800e604fd07cef8dd02f903fd071b0253064605fc07",
        "10670000b6378e3372374d5dedbc420af72cb8518fae69206e54d5179547b13b",
    ),
    (
        Filter::Exponential,
        12,
        "00000014000000144125001400000000c6cfff0000000000",
        "0000000000000000000415500000000000e840c600000000",
    ),
    (Filter::Color, 4, "7f007f8d880437ac9108f0cc990ca7ec", "00fe001b55bf4d58a9819998fe40e6d8"),
    (
        Filter::Color,
        8,
        "ff010000ff01330221021100dd00b30244022200bcff3303660233009afeb303",
        "0000bfff0000c6195555afbfd34cd659aaaa2080a699e699ffff104079e6f6d9",
    ),
];

fn bytes(hex: &str) -> Vec<u8> {
    hex.as_bytes().chunks(2).map(|pair| u8::from_str_radix(str::from_utf8(pair).unwrap(), 16).unwrap()).collect()
}

fn layout(mode: Mode, count: usize, stride: usize) -> Layout {
    Layout { mode, filter: Filter::None, count, stride }
}

/// 40 elements: a ramp, a parabola, constants, noise, floats of a short cycle. The encoder took a mode of its own for each.
fn elements() -> Vec<u8> {
    let mut noise = 1_u32;
    let mut out = Vec::new();
    for k in 0..40_u32 {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        out.extend(((k * 37) as u16).to_le_bytes());
        out.extend(((k * k * 5) as u16).to_le_bytes());
        out.extend(0x0102_0304_u32.to_le_bytes());
        out.extend(noise.to_le_bytes());
        out.extend((1.0 + (k % 7) as f32 * 0.25).to_le_bytes());
    }
    out
}

#[test]
fn attributes_of_both_versions() {
    for stream in [ATTRIBUTES_0, ATTRIBUTES_1] {
        assert_eq!(decode(&bytes(stream), layout(Mode::Attributes, 40, 16)).unwrap(), elements());
    }
}

#[test]
fn triangles_and_indices() {
    let want = [
        0, 1, 2, 2, 1, 3, 3, 1, 4, 4, 1, 5, 9, 8, 7, 7, 8, 6, 6, 8, 10, 100, 50, 75, 75, 50, 51, 51, 50, 52, 2, 3, 9,
        0, 1, 2, 52, 51, 99, 1, 0, 53,
    ];
    assert_eq!(indices::triangles(&bytes(TRIANGLES), want.len()).unwrap(), want);
    let want = [0, 1, 2, 3, 1000, 4, 1001, 5, 1002, 70000, 6, 0, 4_000_000];
    assert_eq!(indices::sequence(&bytes(INDICES), want.len()).unwrap(), want);
    let short = decode(&bytes(INDICES), layout(Mode::Indices, want.len(), 2)).unwrap();
    assert_eq!(short[18..20], (70000_u32 as u16).to_le_bytes(), "two bytes wrap around");
}

/// Within one unit, as the specification asks; the exponential filter exactly.
#[test]
fn filters_are_undone() {
    for (filter, stride, encoded, want) in FILTERS {
        let (mut got, want) = (bytes(encoded), bytes(want));
        filters::undo(filter, stride, &mut got);
        if filter == Filter::Exponential {
            assert_eq!(got, want);
            continue;
        }
        let numbers = |b: &[u8]| -> Vec<i32> {
            if stride == 4 {
                b.iter().map(|&b| i32::from(b)).collect()
            } else {
                b.as_chunks().0.iter().map(|&pair| i32::from(u16::from_le_bytes(pair))).collect()
            }
        };
        let top = if stride == 4 { 0x100 } else { 0x10000 };
        for (k, (got, want)) in numbers(&got).into_iter().zip(numbers(&want)).enumerate() {
            let off = (got - want).rem_euclid(top);
            assert!(off <= 1 || off == top - 1, "{filter:?}, number {k}: {got} for {want}");
        }
    }
}

#[test]
fn layouts_that_make_no_sense_are_refused() {
    let refused = |mode, filter, stride| {
        matches!(decode(&[0xa0; 64], Layout { mode, filter, count: 1, stride }), Err(Flaw::Layout { .. }))
    };
    assert!(refused(Mode::Attributes, Filter::None, 0) && refused(Mode::Attributes, Filter::None, 260));
    assert!(refused(Mode::Attributes, Filter::Quaternion, 4) && refused(Mode::Triangles, Filter::None, 3));
    assert!(refused(Mode::Indices, Filter::Color, 4));
}

/// Cut off, lengthened, with another count or with a byte changed: an error or some bytes of the declared length, never a
/// panic, and no allocation that the stream does not account for.
#[test]
fn damaged_streams_end() {
    let cases = [
        (ATTRIBUTES_0, Mode::Attributes, 40, 16),
        (ATTRIBUTES_1, Mode::Attributes, 40, 16),
        (TRIANGLES, Mode::Triangles, 42, 4),
        (INDICES, Mode::Indices, 13, 4),
    ];
    for (stream, mode, count, stride) in cases {
        let whole = bytes(stream);
        for length in 0..whole.len() {
            assert!(decode(&whole[..length], layout(mode, count, stride)).is_err(), "{mode:?} of {length} bytes");
        }
        for count in [usize::MAX / 3 * 3, usize::MAX, 1 << 40, count + 300] {
            assert!(decode(&whole, layout(mode, count, stride)).is_err(), "{mode:?} with {count}");
        }
        for at in 0..whole.len() {
            for value in [0x00, 0x0f, 0x7f, 0x80, 0xf0, 0xfe, 0xff] {
                let mut damaged = whole.clone();
                damaged[at] = value;
                if let Ok(out) = decode(&damaged, layout(mode, count, stride)) {
                    assert_eq!(out.len(), count * stride);
                }
            }
        }
    }
    assert_eq!(decode(&[], layout(Mode::Attributes, 0, 4)), Err(Flaw::CutOff(0)));
    assert_eq!(decode(&[0xa7; 64], layout(Mode::Attributes, 0, 4)), Err(Flaw::Header(0xa7)));
}
