//! State that outlasts a render: one of the same scene through another camera starts from it.
//!
//! A picture that starts from such state depends on the cameras before it; on threads and tiles it does not.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

/// What renders of one scene leave to each other, whatever their integrator makes of it. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct KeptState(Arc<Mutex<Option<Box<dyn Any + Send>>>>);

impl KeptState {
    /// What is kept, which the caller may hand back by [`KeptState::put`]; `None` where that is nothing of this kind.
    pub(crate) fn take<T: Any>(&self) -> Option<T> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        kept.and_then(|kept| kept.downcast().ok()).map(|kept| *kept)
    }

    /// Keeps this in place of what there is.
    pub(crate) fn put<T: Any + Send>(&self, kept: T) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(kept));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_handed_out_once_and_by_its_kind() {
        let kept = KeptState::default();
        assert_eq!(kept.take::<u32>(), None);
        kept.clone().put(5u32);
        assert_eq!((kept.take::<u32>(), kept.take::<u32>()), (Some(5), None));
        kept.put("text");
        assert_eq!((kept.take::<u32>(), kept.take::<&str>()), (None, None));
    }
}
