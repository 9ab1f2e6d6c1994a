//! The block behind the name of a picture: how it lies, what its numbers mean, and what else it may say by the key
//! that it is the value of.
//!
//! Scene: `roughness scratches.png { repeat 4 2  channel green  range 0.1 0.4 }`

use kajo_color::Emission;
use kajo_math::Vec2;
use kajo_scene::{Args, Diagnostic};

use super::{Plain, Sources, Stated, Typed, between, choice, choices, flag, keys, number, pair, whole};
use crate::schema::{Absent, Block, Constant, FieldKind, FieldSpec, Kind, NumberRange};
use crate::texture::{Channel, Encoding, TexelFilter, Tiling, Wrap};

choices! {
    Wrap {
        "repeat" => Wrap::Repeat,
        "mirror" => Wrap::Mirror,
        "clamp" => Wrap::Clamp,
        "black" => Wrap::Black,
        "once" => Wrap::Once,
    }
}

choices! {
    Tiling {
        "regular" => Tiling::Regular,
        "random" => Tiling::Random,
    }
}

choices!(TexelFilter: TexelFilter::NAMES);

choices! {
    Encoding {
        "srgb" => Encoding::Srgb,
        "linear" => Encoding::Linear,
    }
}

choices! {
    Channel {
        "red" => Channel::Red,
        "green" => Channel::Green,
        "blue" => Channel::Blue,
        "alpha" => Channel::Alpha,
    }
}

/// How often a picture fits into the unit square: one number for both ways, or two.
pub(super) struct Repeat(pub Vec2);

impl Plain<'_> for Repeat {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Repeat, Diagnostic> {
        let repeat = match args.numbers_left() {
            1 => args.number().map(Vec2::splat),
            _ => args.vec2(),
        };
        repeat.map(Repeat)
    }
}

impl Stated for Repeat {
    fn of(constant: Constant) -> Option<Repeat> {
        Vec2::of(constant).map(Repeat)
    }
}

/// The first and the last frame of a sequence.
pub(super) struct FrameNumbers(pub [i64; 2]);

impl Plain<'_> for FrameNumbers {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<FrameNumbers, Diagnostic> {
        let mut number = |i| args.int_in(spec.kind.range(i).wholes());
        let [first, last] = [number(0)?, number(1)?];
        if first <= last {
            Ok(FrameNumbers([first, last]))
        } else {
            Err(args.error("the first frame is not after the last one"))
        }
    }
}

/// Bound on numbers of frames, as those of an animation.
const LAST: i32 = 1_000_000_000;
const FRAME: NumberRange = NumberRange { min: -(LAST as f64), max: LAST as f64 };

keys! {
    /// How a picture lies, and what its numbers mean.
    pub PictureKeys {
        repeat: Repeat = Typed::<Repeat>::new("repeat", FieldKind::Numbers(&[NumberRange::ANY; 2]))
            .otherwise(Constant::Pair([1.0; 2]), "how often it fits into the unit square, across and up; one number for both"),
        offset: Vec2 = pair("offset").or([0.0; 2], "moves it by so much of itself to the left and down"),
        wrap: Wrap = choice::<Wrap>("wrap").or_word(
            "repeat",
            "what is beside it: itself, its mirror image, its last row or column, black, or nothing: black with an alpha of 0",
        ),
        tiling: Tiling = choice::<Tiling>("tiling").or_word(
            "regular",
            "how it repeats; `random` lays pieces of it at random, without seams and without a pattern that is seen from afar",
        ),
        filter: Option<TexelFilter> = choice::<TexelFilter>("filter")
            .unlike("by `textureFilter`", "ewa", "what is between its texels, and what stands for many of them"),
        encoding: Option<Encoding> = choice::<Encoding>("encoding")
            .unlike("by the file", "srgb", "what its numbers mean; those of a key that is no colour are linear"),
    }
}

keys! {
    /// Which pictures of a sequence there are.
    pub SequenceKeys {
        frames: Option<FrameNumbers> = Typed::<FrameNumbers>::new("frames", FieldKind::Wholes(&[FRAME; 2]))
            .unlike("a file for each frame", "1 24", "of a sequence: the first and the last file that there are"),
        frame_offset: i32 = whole("frameOffset", -LAST, LAST)
            .or(0, "of a sequence: by how many frames what is shown is ahead"),
        cycle: bool = flag("cycle").only_beside("frames").or(
            false,
            "whether it begins again, or stands still before its first and after its last picture",
        ),
    }
}

keys! {
    /// Which numbers of a picture are meant.
    pub ChannelKeys {
        channel: Channel =
            choice::<Channel>("channel").or_word("red", "of pictures of numbers: which channel"),
    }
}

/// What black and white stand for, within the values of the key that the picture is for.
pub(super) const RANGE: FieldSpec = FieldSpec {
    absent: Absent::Value(Constant::Pair([0.0, 1.0])),
    about: "of numbers: what 0 and 1, or black and white, stand for, within the values of the key; must be there where 0 or 1 is none of them",
    ..FieldSpec::new("range", FieldKind::Numbers(&[NumberRange::ANY; 2]))
};

keys! {
    /// Of `opacity`.
    pub CutoffKeys {
        cutoff: Option<f32> = between("cutoff", 0.0, 1.0).unlike(
            "none",
            "0.5",
            "of `opacity`: the surface is there where the picture is this much or more, and nowhere else",
        ),
    }
}

keys! {
    /// Of `normalMap`.
    pub NormalKeys {
        scale: f32 = number("scale").or(1.0, "of `normalMap`: how steep the dents are made"),
    }
}

keys! {
    /// Of `bump`.
    pub HeightKeys {
        height: f32 =
            number("height").unit("length").or(0.01, "of `bump`: how far white rises above black"),
    }
}

keys! {
    /// Of `emission`.
    pub SlideKeys {
        light: Option<Emission> = Typed::<Emission>::new("light", FieldKind::Emission)
            .unit("W/(m² sr)")
            .presumed(Constant::Triple([1.0; 3]), "of `emission`: the light that shines through the picture"),
    }
}

/// What is said behind the name of a picture that these groups of fields are for.
const fn block(groups: &'static [&'static [FieldSpec]]) -> Block {
    Block {
        keyword: "picture",
        kind: Kind::Picture,
        about: "what is said in a block behind the name of a picture",
        groups,
        parts: &[],
    }
}

/// Behind a picture of colours.
pub(in crate::compile) const COLORS: Block = block(&[PictureKeys::FIELDS, SequenceKeys::FIELDS]);

/// Behind a picture of numbers.
pub(in crate::compile) const NUMBERS: Block =
    block(&[PictureKeys::FIELDS, ChannelKeys::FIELDS, &[RANGE], SequenceKeys::FIELDS]);

/// Behind a picture of holes.
pub(in crate::compile) const HOLES: Block =
    block(&[PictureKeys::FIELDS, ChannelKeys::FIELDS, &[RANGE], CutoffKeys::FIELDS, SequenceKeys::FIELDS]);

/// Behind a picture of normals.
pub(in crate::compile) const NORMALS: Block =
    block(&[PictureKeys::FIELDS, NormalKeys::FIELDS, SequenceKeys::FIELDS]);

/// Behind a picture of heights.
pub(in crate::compile) const HEIGHTS: Block =
    block(&[PictureKeys::FIELDS, ChannelKeys::FIELDS, HeightKeys::FIELDS, SequenceKeys::FIELDS]);

/// Behind a picture that light shines through.
pub(in crate::compile) const SLIDE: Block =
    block(&[PictureKeys::FIELDS, SlideKeys::FIELDS, SequenceKeys::FIELDS]);

/// All that may be said behind a picture.
pub(in crate::compile) const PICTURE: Block = block(&[
    PictureKeys::FIELDS,
    ChannelKeys::FIELDS,
    &[RANGE],
    CutoffKeys::FIELDS,
    NormalKeys::FIELDS,
    HeightKeys::FIELDS,
    SlideKeys::FIELDS,
    SequenceKeys::FIELDS,
]);
