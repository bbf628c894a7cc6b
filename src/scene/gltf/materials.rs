//! Materials → what of a primitive's triangles casts: all, none, or what an alpha mask leaves (glTF 2.0, section 3.9.4).
//!
//! MASK: baseColorTexture's alpha × baseColorFactor's × COLOR_0's, against alphaCutoff. BLEND: by the job's rule. Images are
//! opened only where a mask needs them; JPEG has no alpha and is not opened at all. Textures come through KHR_texture_transform
//! (which moves the coordinates) and EXT_texture_webp; KHR_texture_basisu is refused where a mask needs it.

use super::accessor::Source;
use super::buffers::read_uri;
use super::document::{Material, Texture, TextureInfo, entry};
use crate::scene::image::{self, Opacity};
use crate::scene::mask::{AlphaImage, Mask, Wrap};
use crate::scene::model::place;
use crate::scene::{BlendRule, SceneError};
use glam::{DMat2, DVec2};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// alphaCutoff where a material gives none.
const DEFAULT_CUTOFF: f64 = 0.5;

/// What casts of a primitive.
#[derive(Clone, Debug)]
pub(super) enum Cover {
    /// Everything.
    Opaque,
    /// Nothing: no light is stopped, nothing is seen.
    Nothing,
    /// What a mask leaves.
    Masked(MaskedCover),
}

/// A mask and how it lies on a primitive.
#[derive(Clone, Copy, Debug)]
pub(super) struct MaskedCover {
    /// Index of the model's mask.
    pub mask: u32,
    /// Set of texture coordinates; `None` without a texture.
    pub coordinates: Option<usize>,
    /// Texture coordinates = `turn` × those of the file + `offset`.
    pub turn: DMat2,
    /// As `turn`.
    pub offset: DVec2,
}

/// Materials resolved so far.
pub(super) struct Materials<'a> {
    source: Source<'a>,
    blend: BlendRule,
    covers: BTreeMap<usize, Cover>,
    images: BTreeMap<usize, Arc<AlphaImage>>,
}

impl<'a> Materials<'a> {
    /// None resolved yet.
    pub(super) fn new(source: Source<'a>, blend: BlendRule) -> Self {
        Materials { source, blend, covers: BTreeMap::new(), images: BTreeMap::new() }
    }

    /// The material with an index, and what it covers. New masks are appended to `masks`, image files to `inputs`.
    ///
    /// # Errors
    /// [`SceneError::Malformed`] for bad references and images that do not decode; [`SceneError::Unsupported`] for a mask in
    /// a format that is not read; [`SceneError::Read`].
    pub(super) fn cover(
        &mut self,
        index: usize,
        asked_by: &str,
        masks: &mut Vec<Mask>,
        inputs: &mut Vec<PathBuf>,
    ) -> Result<(&'a Material, Cover), SceneError> {
        let document = self.source.document;
        let material = entry(self.source.path, asked_by, "material", &document.materials, index)?;
        if let Some(cover) = self.covers.get(&index) {
            return Ok((material, cover.clone()));
        }
        let at = place("material", index, material.name.as_deref());
        let cutoff = match (material.alpha_mode.as_deref(), self.blend) {
            (None | Some("OPAQUE"), _) | (Some("BLEND"), BlendRule::Opaque) => None,
            (Some("BLEND"), BlendRule::Ignore) => {
                self.covers.insert(index, Cover::Nothing);
                return Ok((material, Cover::Nothing));
            }
            (Some("BLEND"), BlendRule::Threshold(alpha)) => Some(alpha),
            (Some("MASK"), _) => Some(material.alpha_cutoff.unwrap_or(DEFAULT_CUTOFF)),
            (Some(other), _) => return Err(self.source.fail(&at, format!("alphaMode {other:?} is unknown"))),
        };
        let cover = match cutoff {
            None => Cover::Opaque,
            Some(cutoff) => self.masked(&at, material, cutoff, masks, inputs)?,
        };
        self.covers.insert(index, cover.clone());
        Ok((material, cover))
    }

    fn masked(
        &mut self,
        at: &str,
        material: &Material,
        cutoff: f64,
        masks: &mut Vec<Mask>,
        inputs: &mut Vec<PathBuf>,
    ) -> Result<Cover, SceneError> {
        let (factor, info) = material.base_color();
        let mut mask = Mask { image: None, wrap: [Wrap::Repeat; 2], linear: true, factor, cutoff };
        let mut cover =
            MaskedCover { mask: masks.len() as u32, coordinates: None, turn: DMat2::IDENTITY, offset: DVec2::ZERO };
        if let Some(info) = info {
            let texture = entry(self.source.path, at, "texture", &self.source.document.textures, info.index)?;
            mask.image = self.image(at, texture, inputs)?;
            (mask.wrap, mask.linear) = self.sampling(at, texture)?;
            (cover.turn, cover.offset) = info.transform();
            cover.coordinates = mask.image.is_some().then(|| info.coordinates());
        }
        masks.push(mask);
        Ok(Cover::Masked(cover))
    }

    /// Wrapping, and whether texels are weighed linearly: by the magnification filter, linear where there is none.
    fn sampling(&self, at: &str, texture: &Texture) -> Result<([Wrap; 2], bool), SceneError> {
        let Some(sampler) = texture.sampler else { return Ok(([Wrap::Repeat; 2], true)) };
        let sampler = entry(self.source.path, at, "sampler", &self.source.document.samplers, sampler)?;
        let wrap = |mode: Option<u64>| match mode {
            None | Some(10497) => Ok(Wrap::Repeat),
            Some(33071) => Ok(Wrap::Clamp),
            Some(33648) => Ok(Wrap::Mirror),
            Some(other) => Err(self.source.fail(at, format!("its sampler has the unknown wrap mode {other}"))),
        };
        match sampler.mag_filter {
            None | Some(9728 | 9729) => {
                Ok(([wrap(sampler.wrap_s)?, wrap(sampler.wrap_t)?], sampler.mag_filter != Some(9728)))
            }
            Some(other) => Err(self.source.fail(at, format!("its sampler has the unknown magFilter {other}"))),
        }
    }

    /// The alpha of a texture; `None` for an image without.
    fn image(
        &mut self,
        at: &str,
        texture: &Texture,
        inputs: &mut Vec<PathBuf>,
    ) -> Result<Option<Arc<AlphaImage>>, SceneError> {
        let source = self.source;
        let Some(index) = texture.image() else {
            let feature =
                if texture.extensions.basisu.is_some() { "KHR_texture_basisu" } else { "textures without image" };
            return Err(SceneError::Unsupported {
                path: source.path.to_owned(),
                features: vec![format!("{feature} at {at} (its mask needs a PNG, JPEG or WebP image)")],
            });
        };
        if let Some(known) = self.images.get(&index) {
            return Ok(Some(Arc::clone(known)));
        }
        let image = entry(source.path, at, "image", &source.document.images, index)?;
        let place = place("image", index, image.name.as_deref());
        let external;
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                external = read_uri(source.path, &place, uri, source.reach, inputs)?;
                &external
            }
            (None, Some(view)) => source.view(view)?,
            (None, None) => return Err(source.fail(&place, "has neither a uri nor a bufferView")),
        };
        if bytes.starts_with(&[0xff, 0xd8]) {
            return Ok(None);
        }
        let decoded = image::decode(bytes, Opacity::Alpha)
            .map_err(|problem| source.fail(&place, format!("the mask of {at} does not decode: {problem}")))?;
        let decoded = Arc::new(decoded);
        self.images.insert(index, Arc::clone(&decoded));
        Ok(Some(decoded))
    }
}

impl Material {
    /// The factor on alpha, and the texture it is in.
    fn base_color(&self) -> (f64, Option<&TextureInfo>) {
        match (&self.pbr_metallic_roughness, &self.extensions.specular_glossiness) {
            (metal, Some(gloss)) if metal.base_color_texture.is_none() => {
                (gloss.diffuse_factor.map_or(1.0, |f| f[3]), gloss.diffuse_texture.as_ref())
            }
            (metal, _) => (metal.base_color_factor.map_or(1.0, |f| f[3]), metal.base_color_texture.as_ref()),
        }
    }
}

impl Texture {
    /// Index of an image of a format that is read.
    fn image(&self) -> Option<usize> {
        self.extensions.webp.as_ref().map(|webp| webp.source).or(self.source)
    }
}

impl TextureInfo {
    /// The set of texture coordinates.
    fn coordinates(&self) -> usize {
        self.extensions.transform.as_ref().and_then(|t| t.tex_coord).unwrap_or(self.tex_coord)
    }

    /// KHR_texture_transform: scaled, then turned counter-clockwise on the image, then moved.
    fn transform(&self) -> (DMat2, DVec2) {
        let Some(transform) = &self.extensions.transform else { return (DMat2::IDENTITY, DVec2::ZERO) };
        let (sin, cos) = transform.rotation.unwrap_or(0.0).sin_cos();
        let turn = DMat2::from_cols(DVec2::new(cos, -sin), DVec2::new(sin, cos));
        let scale = DVec2::from_array(transform.scale.unwrap_or([1.0; 2]));
        (turn * DMat2::from_diagonal(scale), DVec2::from_array(transform.offset.unwrap_or([0.0; 2])))
    }
}
