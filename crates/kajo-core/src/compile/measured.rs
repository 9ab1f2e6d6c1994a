//! Files of measured reflection, each read once however many materials show it.

use std::collections::HashMap;
use std::fmt::Display;
use std::sync::Arc;

use kajo_scene::{AssetError, AssetFile, Diagnostic, Limits};

use super::Compiler;
use super::fields::{At, FileName};
use crate::measured::MeasuredBrdf;
use crate::measured::MeasuredError;
use crate::measured::btf::{Btf, BtfError, read_btf};

/// What was read so far, by the paths of files; `None` where one cannot be read.
type Read<T> = HashMap<String, Option<Arc<T>>>;

/// Tables read so far.
#[derive(Default)]
pub(super) struct MeasuredCache {
    btfs: Read<Btf>,
    brdfs: Read<MeasuredBrdf>,
}

impl Compiler<'_> {
    /// The bidirectional texture function of a file.
    pub(super) fn btf(&mut self, file: &At<'_, FileName>) -> Option<Arc<Btf>> {
        let read = |file: AssetFile, limits: &Limits| {
            let (file, _, memory) = read_btf(file, limits)?;
            let btf = Btf::new(file)?;
            // What the reader held is another form of the same.
            drop(memory);
            limits.memory.take(btf.bytes() as u64)?;
            Ok::<Btf, BtfError>(btf)
        };
        self.read_once(file, |cache| &mut cache.btfs, read)
    }

    /// The measured BRDF of a file.
    pub(super) fn measured_brdf(&mut self, file: &At<'_, FileName>) -> Option<Arc<MeasuredBrdf>> {
        let read = |file: AssetFile, limits: &Limits| {
            let brdf = MeasuredBrdf::read(file, limits)?;
            limits.memory.take(brdf.bytes() as u64)?;
            Ok::<MeasuredBrdf, MeasuredError>(brdf)
        };
        self.read_once(file, |cache| &mut cache.brdfs, read)
    }

    /// What `read` makes of a file; what is wrong with it is reported where it is named first.
    fn read_once<T, E: Display + From<AssetError>>(
        &mut self,
        file: &At<'_, FileName>,
        known: fn(&mut MeasuredCache) -> &mut Read<T>,
        read: impl FnOnce(AssetFile, &Limits) -> Result<T, E>,
    ) -> Option<Arc<T>> {
        let At { value: FileName(name), item } = file;
        let opened = self.assets.open(name, item.path());
        let path = opened.as_ref().map_or_else(|_| name.clone(), |file| file.path.clone());
        if let Some(known) = known(&mut self.measured).get(&path) {
            return known.clone();
        }
        let made = opened.map_err(E::from).and_then(|file| read(file, &self.options.limits));
        let report = |error: E| {
            let error = Diagnostic::error(format!("cannot read `{name}`: {error}"));
            self.diagnostics.push(error.label(item.head_span(), "named here"));
        };
        let made = made.map_err(report).ok().map(Arc::new);
        known(&mut self.measured).insert(path, made.clone());
        made
    }
}
