//! What is wrong with a file of a bidirectional texture function.

use kajo_scene::{AssetError, OverBudget};

use crate::measured::DirectionError;

/// Why there is no such texture.
#[derive(Debug, thiserror::Error)]
pub enum BtfError {
    /// The file could not be read.
    #[error(transparent)]
    Asset(#[from] AssetError),
    /// It needs more memory than is left.
    #[error(transparent)]
    Memory(#[from] OverBudget),
    /// It is something else.
    #[error("this is no kajo BTF: it does not begin with `kajoBTF`")]
    Magic,
    /// It is of the University of Bonn, where one of ours was expected.
    #[error("this is a BTF of the University of Bonn; `kajo btf compress` makes one of it that can be shown")]
    Bonn,
    /// It is something else, where one of the University of Bonn was expected.
    #[error(
        "this is no BTF of the University of Bonn: it does not begin as they do, such as with `!DFMF08FCR`"
    )]
    Signature,
    /// It is of the University of Bonn, in a form that is not read.
    #[error("its form is {0}; of those of the University of Bonn, DFMF and FMF are read")]
    Form(&'static str),
    /// It is of a later time.
    #[error("this is version {0} of the format, and 1 is read")]
    Version(u32),
    /// It ends too early.
    #[error("the file ends within its {0}")]
    Short(&'static str),
    /// It does not end where it should.
    #[error("the file goes on after its end")]
    Long,
    /// It was damaged.
    #[error("the checksum of the file is wrong: it was damaged, or not written to its end")]
    Checksum,
    /// Numbers that make no sense.
    #[error("{0}")]
    Content(String),
    /// Directions to the viewer.
    #[error("views: {0}")]
    Views(DirectionError),
    /// Directions to the light.
    #[error("lights: {0}")]
    Lights(DirectionError),
}
