//! Numbers of a film as OpenEXR: one part, its channels named `layer.channel` as the format's users expect.

use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};
use std::io::{self, Cursor};

/// A plane of numbers, row by row from the top.
#[derive(Clone, Debug)]
pub struct Channel {
    /// `layer.channel`, ASCII, unique in its file.
    pub name: String,
    /// `width * height` values.
    pub values: Vec<f32>,
}

/// The bytes of an OpenEXR file, losslessly compressed.
///
/// # Errors
/// A channel of another length or an ambiguous or foreign name; else what the encoder says.
pub fn write_exr(width: u32, height: u32, channels: Vec<Channel>) -> io::Result<Vec<u8>> {
    write(width, height, channels, LayerAttributes::default())
}

/// The camera of an image as a header has it: matrices for row vectors, row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraAttributes {
    /// `worldToCamera`.
    pub world_to_camera: [f32; 16],
    /// `worldToNDC`.
    pub world_to_ndc: [f32; 16],
    /// `near`, in the unit of the matrices.
    pub near: f32,
}

/// The same with a camera in its header.
///
/// # Errors
/// As [`write_exr`].
pub fn write_exr_of_camera(
    width: u32,
    height: u32,
    channels: Vec<Channel>,
    camera: &CameraAttributes,
) -> io::Result<Vec<u8>> {
    let attributes = LayerAttributes {
        world_to_camera: Some(camera.world_to_camera),
        world_to_normalized_device: Some(camera.world_to_ndc),
        near_clip_plane: Some(camera.near),
        ..LayerAttributes::default()
    };
    write(width, height, channels, attributes)
}

fn write(width: u32, height: u32, channels: Vec<Channel>, attributes: LayerAttributes) -> io::Result<Vec<u8>> {
    let pixels = width as usize * height as usize;
    let wrong = |c: &Channel| c.values.len() != pixels || c.name.is_empty() || !c.name.is_ascii();
    if let Some(channel) = channels.iter().find(|c| wrong(c)) {
        let text = format!("channel `{}` of {} values for {pixels} pixels", channel.name, channel.values.len());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
    }
    let list = channels
        .into_iter()
        .map(|channel| AnyChannel::new(channel.name.as_str(), FlatSamples::F32(channel.values)))
        .collect();
    let size = (width as usize, height as usize);
    let layer = Layer::new(size, attributes, Encoding::SMALL_FAST_LOSSLESS, AnyChannels::sort(list));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).map_err(|e| io::Error::other(e.to_string()))?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_read_back_by_name() {
        let channel = |name: &str, values: [f32; 6]| Channel { name: name.to_owned(), values: values.to_vec() };
        let z = [1.0, f32::INFINITY, -0.5, 1e-30, 5.0, 6.0];
        let bytes = write_exr(3, 2, vec![channel("Z", z), channel("shadow.sun", [0.0; 6])]).unwrap();
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("a.exr");
        std::fs::write(&file, bytes).unwrap();
        let image = exr::prelude::read_first_flat_layer_from_file(file).unwrap();
        let list = &image.layer_data.channel_data.list;
        let names: Vec<String> = list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["Z", "shadow.sun"]);
        assert_eq!(list[0].sample_data.values_as_f32().collect::<Vec<_>>(), z);
        assert!(write_exr(3, 3, vec![channel("Z", z)]).is_err());
    }
}
