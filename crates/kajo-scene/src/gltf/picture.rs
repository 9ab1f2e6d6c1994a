//! Pictures of glTF files: beside them, or within.

use super::container::{self, Buffers};
use super::material::ModelMaterial;
use super::{Budget, json, read_with};
use crate::assets::{AssetFile, Assets};
use crate::limits::Limits;
use crate::mesh_file_error::MeshFileError;
use std::collections::BTreeSet;

/// Where a picture is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PictureSource {
    /// In a file of this name, beside the model's.
    File(String),
    /// The content of such a file, which the model holds.
    Bytes(Vec<u8>),
}

/// Reads one picture that a glTF file holds, and nothing else of it but what the picture is found by.
///
/// * `number`: an index into [`super::Model::pictures`]
///
/// # Errors
/// As for [`super::read_gltf`], and when the file holds no such picture.
pub fn read_gltf_picture(
    file: AssetFile,
    assets: &dyn Assets,
    limits: &Limits,
    number: usize,
) -> Result<Vec<u8>, MeshFileError> {
    read_with(file, assets, limits, |document, buffers, budget| {
        buffers.decode(document, budget)?;
        let held = match document.images.get(number) {
            Some(image) => picture(image, document, buffers, budget),
            None => Err("there is no such picture".to_owned()),
        };
        match held.map_err(|said| format!("images[{number}]: {said}"))? {
            PictureSource::Bytes(bytes) => Ok(bytes),
            PictureSource::File(_) => Err(format!("images[{number}]: it is in a file of its own")),
        }
    })
}

/// The pictures that the materials use.
pub(super) fn pictures(
    document: &json::Document,
    materials: &[ModelMaterial],
    buffers: &Buffers<'_>,
    budget: &mut Budget,
) -> Result<Vec<Option<PictureSource>>, String> {
    let used: BTreeSet<usize> =
        materials.iter().flat_map(ModelMaterial::pictures).map(|p| p.picture).collect();
    let mut read = |(i, image): (usize, &json::Image)| {
        if !used.contains(&i) {
            return Ok(None);
        }
        picture(image, document, buffers, budget).map(Some).map_err(|said| format!("images[{i}]: {said}"))
    };
    document.images.iter().enumerate().map(&mut read).collect()
}

fn picture(
    image: &json::Image,
    document: &json::Document,
    buffers: &Buffers<'_>,
    budget: &mut Budget,
) -> Result<PictureSource, String> {
    if let Some(uri) = &image.uri {
        return match uri.strip_prefix("data:") {
            Some(data) => {
                budget.take::<u8>(data.len())?;
                container::decode_data(data)
                    .map(PictureSource::Bytes)
                    .ok_or("its `data:` uri is not in base64".to_owned())
            }
            None => container::percent_decoded(uri)
                .map(PictureSource::File)
                .ok_or("its name is not UTF-8".to_owned()),
        };
    }
    let view = image.buffer_view.ok_or("it has neither a `uri` nor a `bufferView`")?;
    let (bytes, _) = buffers.view(document, view)?;
    budget.take::<u8>(bytes.len())?;
    Ok(PictureSource::Bytes(bytes.to_vec()))
}
