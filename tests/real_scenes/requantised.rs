//! Binary glTF files as a quantising encoder leaves them: the step of their positions, and a plain file quantised to the
//! same step on grids of other zeros.
//!
//! A quantised mesh has one step on all axes and the zero of its grid in its middle. Where another zero would put the
//! vertices is as good an answer; how far such answers lie apart is what quantising to this step explains.

use lixel::math::Prng;
use serde_json::Value;
use std::fs;
use std::ops::Range;
use std::path::Path;

/// Bytes of a file's header and of a chunk's.
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
/// The type of stored positions: signed 16 bits, normalised, so that 32767 stands for 1.
const SHORT: u64 = 5122;
const SHORT_MAX: f64 = 32767.0;
/// Magnitude bits of that type.
const SHORT_BITS: u32 = 15;

/// A binary glTF file.
pub(crate) struct Glb {
    json: Value,
    bytes: Vec<u8>,
    /// Where its buffer begins.
    buffer: usize,
}

/// How a mesh's positions are stored: as whole numbers of steps from the middle of the mesh, of fewer bits than are stored;
/// what is stored has their high bits again as its low ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quantised {
    middle_m: [f64; 3],
    /// What the largest value stands for, metres.
    scale_m: f64,
    /// Magnitude bits kept.
    bits: u32,
}

impl Quantised {
    /// Distance of neighbouring values, metres.
    pub(crate) fn step_m(self) -> f64 {
        self.scale_m / self.most()
    }

    /// The largest number of steps.
    fn most(self) -> f64 {
        f64::from((1_u32 << self.bits) - 1)
    }

    /// A coordinate, stored on a grid whose zero lies aside by a part of a step, and read again.
    fn stored_m(self, axis: usize, plain_m: f64, zero: f64) -> f64 {
        let steps = ((plain_m - self.middle_m[axis]) / self.step_m() - zero).round() + zero;
        let low_bits = SHORT_BITS - self.bits;
        let again = (steps / f64::from(1_u32 << (self.bits - low_bits))).trunc();
        self.middle_m[axis] + (steps * f64::from(1_u32 << low_bits) + again) / SHORT_MAX * self.scale_m
    }
}

impl Glb {
    pub(crate) fn read(file: &Path) -> Glb {
        let bytes = fs::read(file).unwrap();
        let length = u32::from_le_bytes(bytes[HEADER..HEADER + 4].try_into().unwrap()) as usize;
        let text = HEADER + CHUNK_HEADER..HEADER + CHUNK_HEADER + length;
        let json = serde_json::from_slice(&bytes[text.clone()]).unwrap();
        Glb { json, bytes, buffer: text.end + CHUNK_HEADER }
    }

    /// The position accessor of each mesh, which has one primitive.
    fn positions(&self) -> impl Iterator<Item = &Value> {
        self.json["meshes"].as_array().unwrap().iter().map(|mesh| {
            let accessor = mesh["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap();
            &self.json["accessors"][accessor as usize]
        })
    }

    /// Where the coordinates of an accessor lie, each of so many bytes.
    fn coordinates(&self, accessor: &Value, size: usize) -> Vec<Range<usize>> {
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let number = |value: &Value, or: usize| value.as_u64().map_or(or, |n| n as usize);
        let begin = self.buffer + number(&view["byteOffset"], 0) + number(&accessor["byteOffset"], 0);
        let stride = number(&view["byteStride"], 3 * size);
        let starts = (0..number(&accessor["count"], 0)).map(|k| begin + k * stride);
        starts.flat_map(|at| (0..3).map(move |axis| at + axis * size..at + (axis + 1) * size)).collect()
    }

    /// How the positions of each mesh are quantised: the bits kept are the fewest of which all stored values can be made.
    pub(crate) fn quantised(&self) -> Vec<Quantised> {
        let of = |(mesh, accessor): (usize, &Value)| {
            let places = self.coordinates(accessor, 2);
            let short = |place: &Range<usize>| i16::from_le_bytes(self.bytes[place.clone()].try_into().unwrap());
            let stored: Vec<u16> = places.iter().map(|place| short(place).unsigned_abs()).collect();
            let made = |bits: u32| {
                let low_bits = SHORT_BITS - bits;
                let of_kept = |kept: u16| kept << low_bits | kept >> (bits - low_bits);
                stored.iter().all(|value| of_kept(value >> low_bits) == *value)
            };
            let bits = (SHORT_BITS.div_ceil(2)..SHORT_BITS).find(|bits| made(*bits)).unwrap_or(SHORT_BITS);
            assert_eq!(
                (accessor["componentType"].as_u64(), accessor["normalized"].as_bool()),
                (Some(SHORT), Some(true))
            );
            let nodes = self.json["nodes"].as_array().unwrap();
            let node = nodes.iter().find(|node| node["mesh"].as_u64() == Some(mesh as u64)).unwrap();
            let number = |key: &str, axis: usize| node[key][axis].as_f64().unwrap();
            Quantised { middle_m: [0, 1, 2].map(|k| number("translation", k)), scale_m: number("scale", 0), bits }
        };
        self.positions().enumerate().map(of).collect()
    }

    /// Writes a plain file with the positions of every mesh stored as given, on grids whose zeros a seed draws; without one
    /// on those of the mesh's own. Coordinates that are equal stay so.
    pub(crate) fn write_requantised(&self, meshes: &[Quantised], seed: Option<u64>, file: &Path) {
        let mut bytes = self.bytes.clone();
        for (mesh, (accessor, quantised)) in self.positions().zip(meshes).enumerate() {
            let zeros = seed.map_or([0.0; 3], |seed| {
                let mut stream = Prng::new(seed, mesh as u64);
                std::array::from_fn(|_| stream.unit())
            });
            for (k, place) in self.coordinates(accessor, 4).into_iter().enumerate() {
                let plain = f32::from_le_bytes(bytes[place.clone()].try_into().unwrap());
                let stored = quantised.stored_m(k % 3, f64::from(plain), zeros[k % 3]);
                bytes[place].copy_from_slice(&(stored as f32).to_le_bytes());
            }
        }
        fs::write(file, bytes).unwrap();
    }
}
