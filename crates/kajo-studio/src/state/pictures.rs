//! The pictures that were traced last, and how two of them are compared.
//!
//! A picture that was traced to its end is kept, with all that decided how it came out. So it is there again when one
//! comes back to where it was made, and nothing is traced twice.

use std::sync::Arc;

use kajo::compare::LightDifference;
use kajo::memory;
use kajo::session::Frame;

use super::tracer::Request;
use super::{Action, CameraState, Compare, Shown, Studio};

/// Pictures that are kept, at most.
const MOST: usize = 8;

/// The share of the free memory that kept pictures may take: one in this many.
const SHARE: u64 = 4;

/// An unfinished picture is kept too when it took as many seconds.
const LONG: f64 = 10.0;

/// A picture that is kept.
#[derive(Clone, Debug)]
pub struct Kept {
    /// What it is called.
    pub letter: char,
    /// The picture.
    pub frame: Arc<Frame>,
    /// The name of its scene.
    pub title: String,
    request: Request,
    place: CameraState,
}

impl Kept {
    /// What it is, in a line.
    pub fn about(&self) -> String {
        format!("{}  {}, {}", self.letter, self.title, effort(&self.frame))
    }
}

/// `16 samples, 1.2 s`
pub fn effort(frame: &Frame) -> String {
    let samples = match frame.samples() {
        0 => "coarse".to_owned(),
        1 => "1 sample".to_owned(),
        n => format!("{n} samples"),
    };
    format!("{samples}, {:.1} s", frame.stats().seconds)
}

/// How far two pictures are apart.
#[derive(Clone, Debug)]
pub struct Apart {
    of: [Arc<Frame>; 2],
    /// Figures and a map, or why there are none.
    pub difference: Arc<Result<LightDifference, String>>,
}

/// The strip of pictures.
#[derive(Clone, Debug)]
pub struct Pictures {
    kept: Vec<Kept>,
    /// Letters used so far.
    used: u32,
    /// How two of them are shown together.
    pub compare: Compare,
    /// The one that others are compared with, left of the wipe; the newest of the others, where absent.
    pub left: Option<char>,
    /// The one on show; the newest trace, where absent.
    pub shown: Option<char>,
    /// Where the wipe is, as a share of the width.
    pub wipe: f32,
    apart: Option<Apart>,
}

impl Default for Pictures {
    fn default() -> Pictures {
        Pictures {
            kept: Vec::new(),
            used: 0,
            compare: Compare::Off,
            left: None,
            shown: None,
            wipe: 0.5,
            apart: None,
        }
    }
}

impl Pictures {
    /// All that are kept, the oldest first.
    pub fn kept(&self) -> &[Kept] {
        &self.kept
    }

    /// The one with this letter.
    pub fn get(&self, letter: char) -> Option<&Kept> {
        self.kept.iter().find(|kept| kept.letter == letter)
    }

    /// The newest picture that was made as a request says, in whatever size.
    pub(super) fn answer(&self, request: &Request) -> Option<&Kept> {
        self.kept.iter().rev().find(|kept| kept.request.is_like(request))
    }

    fn has(&self, frame: &Arc<Frame>) -> bool {
        self.kept.iter().any(|kept| Arc::ptr_eq(&kept.frame, frame))
    }

    /// Keeps a picture. One that was made alike gives way to it, and so do the oldest where there are too many.
    fn keep(&mut self, frame: Arc<Frame>, request: Request, place: CameraState, title: String) {
        if let Some(alike) = self.kept.iter_mut().find(|kept| kept.request == request) {
            alike.frame = frame;
            return;
        }
        let letter = self.free_letter();
        self.kept.push(Kept { letter, frame, title, request, place });
        let room = memory::available() / SHARE;
        while self.kept.len() > 1 && (self.kept.len() > MOST || self.bytes() > room) {
            // What is compared stays, and so does the newest.
            let held = [self.left, self.shown];
            let oldest =
                self.kept[..self.kept.len() - 1].iter().position(|kept| !held.contains(&Some(kept.letter)));
            let Some(oldest) = oldest else { break };
            self.kept.remove(oldest);
        }
    }

    /// The letter of a new picture: never one that another still has, and not soon again one that was dropped.
    fn free_letter(&mut self) -> char {
        loop {
            let letter = char::from(b'A' + (self.used % 26) as u8);
            self.used += 1;
            if self.get(letter).is_none() {
                return letter;
            }
        }
    }

    fn bytes(&self) -> u64 {
        self.kept.iter().map(|kept| kept.frame.bytes()).sum()
    }

    fn remove(&mut self, letter: char) {
        self.kept.retain(|kept| kept.letter != letter);
        for chosen in [&mut self.left, &mut self.shown] {
            if *chosen == Some(letter) {
                *chosen = None;
            }
        }
        if self.kept.is_empty() {
            self.compare = Compare::Off;
        }
    }
}

impl Studio {
    /// The picture on show: one that was chosen, or the one that shows what is asked for now.
    pub fn picture(&self) -> Option<Arc<Frame>> {
        let chosen = self.pictures.shown.and_then(|letter| self.pictures.get(letter));
        let kept = chosen.or_else(|| self.answering());
        kept.map(|kept| Arc::clone(&kept.frame)).or_else(|| self.tracer.frame())
    }

    /// What the picture on show is, in a line.
    pub fn about_picture(&self) -> String {
        let Some(frame) = self.picture() else { return String::new() };
        let kept = self.pictures.kept.iter().find(|kept| Arc::ptr_eq(&kept.frame, &frame));
        kept.map_or_else(|| format!("now  {}", effort(&frame)), Kept::about)
    }

    /// The picture that the one on show is compared with.
    pub fn reference(&self) -> Option<&Kept> {
        if self.pictures.compare == Compare::Off {
            return None;
        }
        let shown = self.picture();
        let is_other = |kept: &&Kept| shown.as_ref().is_none_or(|shown| !Arc::ptr_eq(&kept.frame, shown));
        let chosen = self.pictures.left.and_then(|letter| self.pictures.get(letter));
        chosen.or_else(|| self.pictures.kept.iter().rev().find(is_other))
    }

    /// How far the picture on show is from the one it is compared with, as far as that is wanted.
    pub fn apart(&mut self) -> Option<Apart> {
        if self.pictures.compare != Compare::Difference {
            self.pictures.apart = None;
            return None;
        }
        let of = [Arc::clone(&self.reference()?.frame), self.picture()?];
        let is_known = |apart: &&Apart| apart.of.iter().zip(&of).all(|(a, b)| Arc::ptr_eq(a, b));
        if let Some(known) = self.pictures.apart.as_ref().filter(is_known) {
            return Some(known.clone());
        }
        let difference = LightDifference::between(of[0].light(), of[1].light());
        let apart = Apart { of, difference: Arc::new(difference.map_err(|error| error.to_string())) };
        self.pictures.apart = Some(apart.clone());
        Some(apart)
    }

    /// The kept picture that shows what is asked for now, unless that is being traced.
    fn answering(&self) -> Option<&Kept> {
        let request = self.request()?;
        if self.tracer.was_asked_for(&request) { None } else { self.pictures.answer(&request) }
    }

    /// Columns and rows of the finished picture on show, where the window has another size by now.
    pub(super) fn finished_size(&self) -> Option<[u32; 2]> {
        if self.shown != Shown::Traced {
            return None;
        }
        let request = self.request()?;
        let chosen = self.pictures.shown.and_then(|letter| self.pictures.get(letter));
        if let Some(kept) =
            chosen.or_else(|| self.answering()).filter(|kept| kept.request.window != request.window)
        {
            return Some(kept.frame.full_size());
        }
        let (frame, of) = self.tracer.finished()?;
        (of.is_like(&request) && of.window != request.window).then(|| frame.full_size())
    }

    /// The letter of the picture that was traced to its end last, if it is kept.
    pub(super) fn finished_picture(&self) -> Option<char> {
        let (frame, _) = self.tracer.finished()?;
        self.pictures.kept.iter().find(|kept| Arc::ptr_eq(&kept.frame, &frame)).map(|kept| kept.letter)
    }

    /// Keeps a picture that is finished, once nothing is dragged any more.
    pub(super) fn keep_finished(&mut self) {
        let is_dragging = self.steps.is_moving() || self.dragged.is_some() || self.grip.is_some();
        if let Some((frame, request)) = self.tracer.finished().filter(|_| !is_dragging)
            && !self.pictures.has(&frame)
            && self.request().as_ref() == Some(&request)
        {
            self.keep(frame, request);
        }
    }

    /// Keeps a picture that took long, before another one is begun.
    pub(super) fn keep_dropped(&mut self) {
        let Some((frame, request)) = self.tracer.newest() else { return };
        let is_worth_it = frame.samples() > 0 && frame.stats().seconds >= LONG;
        if is_worth_it && !self.pictures.has(&frame) {
            self.keep(frame, request);
        }
    }

    fn keep(&mut self, frame: Arc<Frame>, request: Request) {
        let place = self.tracer.camera_state().unwrap_or_else(|| self.camera_state());
        let title = self.title();
        self.pictures.keep(frame, request, place, title);
    }

    pub(super) fn picture_action(&mut self, action: Action) {
        match action {
            Action::KeepPicture => match self.tracer.newest() {
                Some((frame, request)) => self.keep(frame, request),
                None => self.say("There is no picture yet: press Enter to trace one.", false),
            },
            Action::ForgetPicture(letter) => self.pictures.remove(letter),
            Action::ShowPicture(letter) => {
                self.pictures.shown = letter;
                self.shown = Shown::Traced;
            }
            Action::CompareWith(letter) => self.pictures.left = letter,
            Action::Compare(how) => self.pictures.compare = how,
            Action::Wipe(share) => self.pictures.wipe = share.clamp(0.0, 1.0),
            Action::LookAsIn(letter) => {
                if let Some(place) = self.pictures.get(letter).map(|kept| kept.place.clone()) {
                    self.pictures.shown = None;
                    self.go_to(place);
                }
            }
            _ => {}
        }
    }
}
