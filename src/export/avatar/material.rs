//! Materials of a character, checked: all numbers within their ranges, plain glTF without extensions.

use gltf_json::Index;
use gltf_json::material::{AlphaMode, Material};
use gltf_json::texture::{Sampler, Texture};
use gltf_json::validation::Checked;

use crate::Result;
use crate::gltf::bad;

/// A picture on a surface: the texture, and the number of the set of places on it.
pub(super) type Painted<'a> = (&'a mut Index<Texture>, u32);

/// All textures that a material uses.
pub(super) fn textures(material: &mut Material) -> impl Iterator<Item = Painted<'_>> {
    let pbr = &mut material.pbr_metallic_roughness;
    let plain = [&mut pbr.base_color_texture, &mut pbr.metallic_roughness_texture, &mut material.emissive_texture];
    let plain = plain.into_iter().flatten().map(|info| (&mut info.index, info.tex_coord));
    let normal = material.normal_texture.iter_mut().map(|t| (&mut t.index, t.tex_coord));
    let occlusion = material.occlusion_texture.iter_mut().map(|t| (&mut t.index, t.tex_coord));
    plain.chain(normal).chain(occlusion)
}

/// The material without extensions and notes.
///
/// # Errors
/// A number is out of its range.
pub(super) fn plain(material: &Material, place: &str) -> Result<Material> {
    let mut plain = material.clone();
    (plain.extensions, plain.extras) = (None, None);
    let pbr = &mut plain.pbr_metallic_roughness;
    (pbr.extensions, pbr.extras) = (None, None);
    for info in [&mut pbr.base_color_texture, &mut pbr.metallic_roughness_texture, &mut plain.emissive_texture] {
        info.iter_mut().for_each(|info| (info.extensions, info.extras) = (None, None));
    }
    plain.normal_texture.iter_mut().for_each(|t| (t.extensions, t.extras) = (None, None));
    plain.occlusion_texture.iter_mut().for_each(|t| (t.extensions, t.extras) = (None, None));
    if plain.alpha_mode == Checked::Invalid {
        return Err(bad(place, "expected alphaMode OPAQUE, MASK or BLEND, found another"));
    }
    if plain.alpha_mode != Checked::Valid(AlphaMode::Mask) {
        plain.alpha_cutoff = None;
    }
    in_range(&plain, place)?;
    Ok(plain)
}

fn in_range(material: &Material, place: &str) -> Result<()> {
    let pbr = &material.pbr_metallic_roughness;
    let strength = material.occlusion_texture.iter().map(|t| t.strength.0);
    let parts: Vec<f32> = pbr.base_color_factor.0.into_iter().chain(material.emissive_factor.0).collect();
    let parts = parts.into_iter().chain([pbr.metallic_factor.0, pbr.roughness_factor.0]).chain(strength);
    if let Some(found) = parts.into_iter().find(|part| !(0.0..=1.0).contains(part)) {
        return Err(bad(place, format!("expected factors from 0 to 1, found {found}")));
    }
    let cutoff = material.alpha_cutoff.map_or(0.0, |cutoff| cutoff.0);
    if !(cutoff >= 0.0 && cutoff.is_finite()) {
        return Err(bad(place, format!("expected an alphaCutoff of 0 or more, found {cutoff}")));
    }
    match material.normal_texture.iter().find(|t| !t.scale.is_finite()) {
        Some(normal) => Err(bad(place, format!("expected a finite scale of normals, found {}", normal.scale))),
        None => Ok(()),
    }
}

/// The sampler without notes.
///
/// # Errors
/// A filter or wrapping mode is none of glTF's.
pub(super) fn sampler(sampler: &Sampler, place: &str) -> Result<Sampler> {
    let wrong = sampler.mag_filter == Some(Checked::Invalid)
        || sampler.min_filter == Some(Checked::Invalid)
        || sampler.wrap_s == Checked::Invalid
        || sampler.wrap_t == Checked::Invalid;
    if wrong {
        return Err(bad(place, "expected filters and wrapping modes of glTF 2.0, found others"));
    }
    Ok(Sampler { extensions: None, extras: None, ..sampler.clone() })
}
