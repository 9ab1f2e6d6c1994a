//! Curves from blocks and from files of hair.
//!
//! | file | begins with | what it is |
//! |---|---|---|
//! | text | | lines `x y z` or `x y z radius`, a blank line between strands: what Mitsuba reads |
//! | Mitsuba 0.6 | `BINARY_HAIR` | number of points, then floats; an infinite one begins a strand |
//! | Cem Yuksel's HAIR | `HAIR` | head of 128 bytes, then segments of strands, points, thicknesses |

use kajo_math::Vec3;
use kajo_scene::{Diagnostic, Item, Span, read_limited};

use super::Compiler;
use crate::shape::{CurveBasis, CurveForm, Curves, ShapeId, Strands};

/// Curves as a block asks for them.
pub(super) struct CurvesRequest {
    /// A file, and where that is named.
    pub file: Option<(String, Span)>,
    /// Strands that are written out. Radii that are left open are no numbers.
    pub strands: Strands,
    pub basis: CurveBasis,
    pub form: CurveForm,
    /// The radius of points that have none, at both ends of a strand.
    pub radii: [f32; 2],
}

impl Compiler<'_> {
    /// The curves of a block; why there are none is reported.
    pub(super) fn curves(&mut self, item: Item<'_>, request: CurvesRequest) -> Option<ShapeId> {
        let CurvesRequest { file, mut strands, basis, form, radii } = request;
        let at = file.as_ref().map_or_else(|| item.head_span(), |(_, span)| *span);
        if let Some((name, span)) = &file {
            self.read_strands(name, item, *span, &mut strands)?;
        }
        fill_radii(&mut strands, radii);
        let (kept, building) = Curves::memory(strands.points.len());
        let memory = &self.options.limits.memory;
        let taken = memory.take(kept as u64).and_then(|()| memory.share(building as u64));
        let _building = match taken {
            Ok(share) => share,
            Err(over) => {
                self.report_memory("curves", over, at);
                return None;
            }
        };
        match Curves::new(&strands, basis, form) {
            Ok(curves) => {
                if curves.dropped() > 0 {
                    let message =
                        format!("{} strands are left out, whose points are all the same", curves.dropped());
                    self.diagnostics.push(Diagnostic::warning(message).label(at, "some of these"));
                }
                self.shape(item, curves)
            }
            Err(error) => {
                let help = match basis {
                    CurveBasis::Bezier => "Béziers take 4 points, and 3 for each one more",
                    _ => {
                        "a strand takes two points or more, with finite numbers and radii that are not below zero"
                    }
                };
                let error = Diagnostic::error(error.to_string()).label(at, "makes no curves").help(help);
                self.diagnostics.push(error);
                None
            }
        }
    }

    fn read_strands(&mut self, name: &str, item: Item<'_>, span: Span, out: &mut Strands) -> Option<()> {
        let limits = self.options.limits.clone();
        let file = self.assets.open(name, item.path()).map_err(|error| error.to_string());
        let read = file.and_then(|file| {
            let held = file.len.unwrap_or(0);
            // The file, and about as much again for what is read from it.
            let _held = limits.memory.share(2 * held).map_err(|over| over.to_string())?;
            let bytes = read_limited(file, limits.mesh_bytes).map_err(|error| error.to_string())?;
            parse(&bytes, out)
        });
        read.map_err(|reason: String| self.cannot_read(name, &reason, span)).ok()
    }
}

/// Gives radii to points that have none.
fn fill_radii(strands: &mut Strands, [root, tip]: [f32; 2]) {
    for strand in 0..strands.len() {
        let range = strands.range(strand);
        let last = (range.len().max(2) - 1) as f32;
        for (i, radius) in strands.radii[range].iter_mut().enumerate() {
            if radius.is_nan() {
                *radius = root + (tip - root) * (i as f32 / last);
            }
        }
    }
}

/// Adds the strands of a file.
fn parse(bytes: &[u8], out: &mut Strands) -> Result<(), String> {
    if let Some(rest) = bytes.strip_prefix(b"BINARY_HAIR") {
        return binary_hair(rest, out).ok_or_else(|| "the file ends too early".to_owned());
    }
    if bytes.starts_with(b"HAIR") {
        return hair(bytes, out).ok_or_else(|| "the file ends too early".to_owned());
    }
    text(bytes, out)
}

fn text(bytes: &[u8], out: &mut Strands) -> Result<(), String> {
    let mut begun = out.points.len();
    let finish = |out: &mut Strands, begun: &mut usize| {
        if out.points.len() > *begun {
            out.finish_strand();
            *begun = out.points.len();
        }
    };
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = line.trim_ascii();
        if line.is_empty() {
            finish(out, &mut begun);
            continue;
        }
        if line.starts_with(b"#") {
            continue;
        }
        let mut numbers = [f32::NAN; 4];
        let mut count = 0;
        for word in line.split(|b| b.is_ascii_whitespace() || *b == b',').filter(|word| !word.is_empty()) {
            let number = std::str::from_utf8(word).ok().and_then(|word| word.parse::<f32>().ok());
            let (Some(slot), Some(number)) = (numbers.get_mut(count), number.filter(|x| x.is_finite()))
            else {
                return Err(format!("line {}: expected three or four numbers", i + 1));
            };
            *slot = number;
            count += 1;
        }
        if count < 3 {
            return Err(format!("line {}: expected three or four numbers, found {count}", i + 1));
        }
        out.points.push(Vec3::new(numbers[0], numbers[1], numbers[2]));
        out.radii.push(numbers[3]);
    }
    finish(out, &mut begun);
    Ok(())
}

/// A little-endian word at a place of a file.
fn word(bytes: &[u8], at: usize) -> Option<[u8; 4]> {
    bytes.get(at..at.checked_add(4)?)?.try_into().ok()
}

fn float(bytes: &[u8], at: usize) -> Option<f32> {
    word(bytes, at).map(f32::from_le_bytes)
}

fn vector(bytes: &[u8], at: usize) -> Option<Vec3> {
    Some(Vec3::new(float(bytes, at)?, float(bytes, at + 4)?, float(bytes, at + 8)?))
}

fn binary_hair(bytes: &[u8], out: &mut Strands) -> Option<()> {
    let count = u32::from_le_bytes(word(bytes, 0)?);
    let (mut at, begun) = (4, out.points.len());
    for _ in 0..count {
        if float(bytes, at)?.is_infinite() {
            at += 4;
            if out.points.len() > begun {
                out.finish_strand();
            }
        }
        out.points.push(vector(bytes, at)?);
        out.radii.push(f32::NAN);
        at += 12;
    }
    if out.points.len() > begun {
        out.finish_strand();
    }
    Some(())
}

/// Arrays in the file are told by bits: segments, points, thickness.
fn hair(bytes: &[u8], out: &mut Strands) -> Option<()> {
    const HEAD: usize = 128;
    let number = |at: usize| word(bytes, at).map(u32::from_le_bytes);
    let [strands, points, arrays, usual] = [number(4)?, number(8)?, number(12)?, number(16)?];
    let has = |bit: u32| arrays & (1 << bit) != 0;
    let (strands, points) = (strands as usize, points as usize);
    let thickness = float(bytes, 20)?;
    let segments = HEAD;
    let first_point = segments + if has(0) { 2 * strands } else { 0 };
    let first_radius = first_point.checked_add(12 * points)?;
    let mut next = 0;
    for strand in 0..strands {
        let count = if has(0) {
            let at = segments + 2 * strand;
            u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?).into()
        } else {
            usual as usize
        };
        for _ in 0..=count {
            if next >= points {
                return None;
            }
            out.points.push(vector(bytes, first_point + 12 * next)?);
            let width = if has(2) { float(bytes, first_radius + 4 * next)? } else { thickness };
            out.radii.push(if width > 0.0 || has(2) { 0.5 * width } else { f32::NAN });
            next += 1;
        }
        out.finish_strand();
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use kajo_math::Ray;
    use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

    use super::*;
    use crate::compile::{CompileOptions, compile};
    use crate::scene::Scene;

    fn words(head: &[u8], words: &[u32], floats: &[f32]) -> Vec<u8> {
        let words = words.iter().flat_map(|word| word.to_le_bytes());
        head.iter().copied().chain(words).chain(floats.iter().flat_map(|x| x.to_le_bytes())).collect()
    }

    fn assets() -> MemoryAssets {
        let strand = [0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let mitsuba = words(b"BINARY_HAIR", &[3], &strand);
        let mut yuksel = words(b"HAIR", &[1, 3, 2, 2], &[0.5]);
        yuksel.resize(128, 0);
        yuksel.extend(strand.iter().flat_map(|x| x.to_le_bytes()));
        let cut = yuksel[..yuksel.len() - 4].to_vec();
        let huge = words(b"HAIR", &[u32::MAX, u32::MAX, 2, u32::MAX], &[0.5; 40]);
        MemoryAssets::new()
            .with("a.txt", "# hair\n0 -1 0 0.25\n0 0 0 0.25\n0 1 0 0.25\n\n\n3 -1 0 0.1\n3 1 0 0.1\n")
            .with("open.txt", "0 -1 0\r\n0 0 0\r\n0 1 0\r\n")
            .with("words.txt", "0 0 0\n0 1 zero\n")
            .with("short.txt", "0 0 0\n0 1\n")
            .with("long.txt", "0 0 0\n0 1 0 1 1\n")
            .with("empty.txt", "\n\n")
            .with("point.txt", "0 0 0\n\n0 1 0\n0 2 0\n")
            .with("mitsuba.hair", mitsuba)
            .with("yuksel.hair", yuksel)
            .with("cut.hair", cut)
            .with("huge.hair", huge)
            .with("many.bin", words(b"BINARY_HAIR", &[u32::MAX], &[0.0; 6]))
    }

    fn compiled(block: &str) -> Result<Scene, String> {
        let text = format!(
            "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
             Materials {{ Matte {{ }} Matte {{ emission 1 }} }} Group {{ MaterialIndex 0 {block} }}"
        );
        let mut parsed = SceneDesc::parse_str(&text);
        let mut diagnostics = Diagnostics::default();
        parsed.diagnostics.iter().for_each(|d| diagnostics.push(d.clone()));
        let scene = compile(&mut parsed.desc, &assets(), &CompileOptions::default(), &mut diagnostics);
        let said: Vec<String> = diagnostics.iter().map(|d| d.message.clone()).collect();
        scene.filter(|_| said.is_empty()).ok_or_else(|| said.join(" / "))
    }

    fn distance(scene: &Scene, x: f32) -> Option<f32> {
        let ray = Ray::new(Vec3::new(x, 0.0, 4.0), Vec3::NEG_Z);
        scene.trace(&ray).surface().map(|at| at.hit.t)
    }

    #[test]
    fn files_and_blocks_say_the_same() {
        for block in [
            "Curves { file a.txt }",
            "Curves { file open.txt radius 0.25 }",
            "Curves { file mitsuba.hair radius 0.25 basis catmullrom }",
            "Curves { file yuksel.hair }",
            "Curves { radius 0.25  strand { points 0 -1 0  0 0 0  0 1 0 } }",
            "Curves { radius 0.5 tipRadius 0  strand { points 0 -1 0  0 0 0  0 1 0 } }",
            "Curves { basis linear  strand { points 0 -1 0  0 1 0  radii 0.25 } }",
            "Curves { basis bezier  strand { points 0 -1 0  0 -0.5 0  0 0.5 0  0 1 0  radii 0 0.25 0.25 0.5 } }",
        ] {
            let scene = compiled(block).unwrap_or_else(|said| panic!("{block}: {said}"));
            let t = distance(&scene, 0.0).unwrap_or_else(|| panic!("{block}: nothing there"));
            assert!((t - 3.75).abs() < 0.02, "{block}: {t}");
            assert_eq!(distance(&scene, 3.0).is_some(), block.contains("a.txt"), "{block}");
        }
    }

    #[test]
    fn what_makes_no_curves_is_told() {
        for (block, expected) in [
            ("Curves { }", "needs `strand`"),
            ("Curves { file none.txt }", "cannot read `none.txt`"),
            ("Curves { file words.txt }", "line 2: expected three or four numbers"),
            ("Curves { file short.txt }", "line 2: expected three or four numbers, found 2"),
            ("Curves { file long.txt }", "line 2: expected three or four numbers"),
            ("Curves { file empty.txt }", "there are no curves"),
            ("Curves { file point.txt }", "strand 1 has 1 points"),
            ("Curves { file cut.hair }", "the file ends too early"),
            ("Curves { file huge.hair }", "the file ends too early"),
            ("Curves { file many.bin }", "the file ends too early"),
            ("Curves { strand { } }", "needs `points`"),
            ("Curves { strand { points 0 0 0 } }", "strand 1 has 1 points"),
            ("Curves { strand { points 0 0 0  1 1 } }", "`points`"),
            ("Curves { strand { points 0 0 0  1 1 1  radii 1 2 3 } }", "3 radii for 2 points"),
            ("Curves { basis bezier  strand { points 0 0 0  1 1 1 } }", "strand 1 has 2 points"),
            ("Curves { strand { points 1 1 1  1 1 1 } }", "there are no curves"),
            ("Curves { radius -1  strand { points 1 1 1  1 1 2 } }", "`radius`"),
            ("Curves { basis cubic  strand { points 1 1 1  1 1 2 } }", "`cubic`"),
            (
                "Difference { Curves { strand { points 1 1 1  1 1 2 } } Sphere { center 0 0 0 radius 1 } }",
                "must have an inside",
            ),
        ] {
            let said = compiled(block).err().unwrap_or_default();
            assert!(said.contains(expected), "{block}: {said}");
        }
    }

    #[test]
    fn tubes_give_light_and_ribbons_say_that_they_do_not() {
        let block = |form: &str| {
            format!("MaterialIndex 1 Curves {{ form {form}  strand {{ points 0 -1 0  1 0 0  0 1 0 }} }}")
        };
        let tube = compiled(&block("tube")).unwrap();
        assert!(tube.lighting.lights.areas.len() > 2);
        assert!(compiled(&block("ribbon")).is_err_and(|said| said.contains("gives no light")));
    }
}
