//! `Lorentz` blocks: objects in an inertial frame of their own.
//!
//! Scene: `Lorentz { velocity 0.9 0 0  Translate 0 1 0  Sphere { center 0 0 0 radius 1 } }`

use kajo_math::{DAffine3, DVec3, Motion};
use kajo_scene::{Args, Diagnostic, Item, Params};

use super::Compiler;
use super::fields::{Keys, Plain, Sources, Stated, Typed, keys};
use super::graphics_state::{CurrentTransform, GraphicsState};
use crate::ids::FrameId;
use crate::schema::{Constant, FieldKind, FieldSpec, NumberRange};

/// A velocity as a fraction of the speed of light, less than 1 long.
#[derive(Clone, Copy)]
pub(super) struct Velocity(pub DVec3);

/// What says how something moves.
pub(super) const VELOCITY: Typed<Velocity> =
    Typed::new("velocity", FieldKind::Numbers(&[NumberRange::ANY; 3])).sliding([0.0, 0.999]);

impl Plain<'_> for Velocity {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Velocity, Diagnostic> {
        let v = DVec3::new(args.double()?, args.double()?, args.double()?);
        if v.length_squared() < 1.0 {
            return Ok(Velocity(v));
        }
        let message =
            format!("a velocity is less than 1 long, the speed of light, and this one is {}", v.length());
        Err(args.error(message))
    }
}

impl Stated for Velocity {
    fn of(constant: Constant) -> Option<Velocity> {
        match constant {
            Constant::Triple(numbers) => Some(Velocity(numbers.into())),
            _ => None,
        }
    }
}

keys! {
    pub LorentzKeys {
        velocity: Velocity = VELOCITY.required("of what it holds, as a fraction of the speed of light"),
    }
}

impl Compiler<'_> {
    /// Everything in a `Lorentz` block, in its own frame.
    pub(super) fn lorentz(&mut self, item: Item<'_>, ctm: &CurrentTransform, state: &mut GraphicsState) {
        let (keys, children) = self.lorentz_keys(item);
        let (operations, objects) = self.operations_first(item, children);
        let there = self.moved(item, &operations, ctm);
        if !self.may_hold_frame(item, &there, state) {
            return;
        }
        let outer = self.scene.rest();
        let frame = keys.and_then(|LorentzKeys { velocity }| {
            let map = ctm.world.constant()?;
            let frame = self.scene.moving_frame(turned(map, velocity.0), origin(&there));
            self.accepted(frame, item.head_span())
        });
        // Without one, what it holds is read all the same, for the mistakes in it.
        let (rest, offset) = frame.unwrap_or((outer, DVec3::ZERO));
        self.scene.rest_in(rest);
        let mut inner = if offset == DVec3::ZERO {
            there
        } else {
            let moved =
                CurrentTransform::new(Motion::still(DAffine3::from_translation(offset)).then(&there.world));
            if there.is_flat() { moved.flattened() } else { moved }
        };
        for object in objects {
            self.object(object, item.keyword(), &mut inner, state);
        }
        self.scene.rest_in(outer);
    }

    fn lorentz_keys<'t>(&mut self, item: Item<'t>) -> (Option<LorentzKeys>, Vec<Item<'t>>) {
        let mut children = Vec::new();
        let keys = self.read_keys(item, |params: &mut Params<'t, '_>, sources| {
            params.name();
            let keys = LorentzKeys::read(params, sources);
            children = params.rest();
            keys
        });
        (keys, children)
    }

    /// Whether a frame can be made here; if not, that is reported.
    fn may_hold_frame(&mut self, item: Item<'_>, there: &CurrentTransform, state: &GraphicsState) -> bool {
        let (message, label, help) = if state.is_operand {
            let message = "what a solid is made of cannot move by itself";
            (message, "not within a solid", "write `Lorentz { ... }` around the whole solid")
        } else if state.parts.is_some() {
            let message = "a definition cannot hold a `Lorentz`";
            (
                message,
                "not within `Define`",
                "write `Lorentz { ... }` around the `Instance` of the definition",
            )
        } else if there.world.constant().is_none() {
            let message =
                "what a `Motion` moves cannot hold a `Lorentz`, whose velocity is all the motion that it has";
            (
                message,
                "moves in two ways",
                "leave out the `Motion`; `worldTime` of the camera says the moment",
            )
        } else {
            return true;
        };
        self.diagnostics.push(Diagnostic::error(message).label(item.keyword_span(), label).help(help));
        false
    }

    /// Whether objects that are put into the scene now move with a velocity.
    pub(super) fn is_moving(&self) -> bool {
        self.scene.rest().frame != FrameId::WORLD
    }

    /// Whether an object can stand at a place, which does not move within a `Lorentz` block; if not, that is reported.
    ///
    /// * `has_moving_parts`: whether it moves in part
    pub(super) fn may_rest(&mut self, ctm: &CurrentTransform, has_moving_parts: bool, by: Item<'_>) -> bool {
        if !self.is_moving() || (ctm.world.constant().is_some() && !has_moving_parts) {
            return true;
        }
        let message = "what a `Lorentz` holds rests in it, and cannot be moved by a `Motion` as well";
        let error = Diagnostic::error(message).label(by.head_span(), "moves in two ways");
        self.diagnostics
            .push(error.help("leave out the `Motion`; `worldTime` of the camera says the moment"));
        false
    }
}

/// A velocity under a map: turned with it, and as fast as before.
fn turned(map: &DAffine3, velocity: DVec3) -> DVec3 {
    if map.matrix3 == DAffine3::IDENTITY.matrix3 {
        return velocity;
    }
    map.transform_vector3(velocity).normalize_or_zero() * velocity.length()
}

/// Where a transform takes the origin.
fn origin(ctm: &CurrentTransform) -> DVec3 {
    ctm.world.constant().map_or(DVec3::ZERO, |map| map.translation)
}

#[cfg(test)]
mod tests {
    use kajo_math::{DVec3, Vec2};
    use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

    use crate::compile::{CompileOptions, compile};
    use crate::ids::{FrameId, ObjectId};
    use crate::scene::Scene;

    const CAMERA: &str = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";

    /// The scene with these objects, or the errors.
    fn compiled(camera: &str, objects: &str) -> Result<Scene, String> {
        let text = format!("{camera} Materials {{ Matte {{ }} }} Group {{ MaterialIndex 0 {objects} }}");
        let mut parsed = SceneDesc::parse_str(&text);
        let mut diagnostics = Diagnostics::default();
        let (assets, options) = (MemoryAssets::new(), CompileOptions::default());
        let scene = compile(&mut parsed.desc, &assets, &options, &mut diagnostics);
        let said: Vec<_> = diagnostics.iter().map(|d| d.message.clone()).collect();
        scene.filter(|_| said.is_empty()).ok_or_else(|| said.join("; "))
    }

    const BALL: &str = "Sphere { center 0 0 0 radius 1 }";

    fn velocity(scene: &Scene, object: u32) -> DVec3 {
        let all = scene.relativity.as_ref().unwrap();
        all.frame(all.frame_of(ObjectId::from_index(object))).from_world().velocity()
    }

    #[test]
    fn velocities_compose_and_are_turned() {
        let inner = format!("Lorentz {{ velocity 0.5 0 0 {BALL} }}");
        let scene = compiled(CAMERA, &format!("Lorentz {{ velocity 0.5 0 0 {BALL} {inner} }}")).unwrap();
        assert!(velocity(&scene, 0).distance(0.5 * DVec3::X) < 1e-15);
        assert!(velocity(&scene, 1).distance(0.8 * DVec3::X) < 1e-15);
        let turned = format!("Transform {{ ZRotate 90 Scale 3 3 3 {inner} }} {BALL}");
        let scene = compiled(CAMERA, &turned).unwrap();
        assert!(velocity(&scene, 0).distance(0.5 * DVec3::Y) < 1e-15);
        assert_eq!(velocity(&scene, 1), DVec3::ZERO);
    }

    #[test]
    fn what_moves_alike_shares_a_frame_and_keeps_its_place() {
        let car = |x: f32| format!("Lorentz {{ velocity 0.6 0 0 Translate {x} 2 0 {BALL} }}");
        let scene = compiled(CAMERA, &format!("{} {}", car(1.0), car(5.0))).unwrap();
        let all = scene.relativity.as_ref().unwrap();
        assert_eq!(all.ids().count(), 2);
        for (object, x) in [(0, 1.0), (1, 5.0)] {
            let object = ObjectId::from_index(object);
            let primitive = &scene.geometry.primitives[object.index()];
            let rests = scene.geometry.transform_of(primitive, 0.0).world_from_object.translation;
            let seen =
                all.snapshot(object).unwrap().transform_point3(kajo_math::Vec3::from(rests).as_dvec3());
            assert!(seen.distance(DVec3::new(x, 2.0, 0.0)) < 1e-6, "{seen}");
        }
    }

    #[test]
    fn nothing_moves_where_all_velocities_are_zero() {
        let scene = compiled(CAMERA, &format!("Lorentz {{ velocity 0 0 0 {BALL} }}")).unwrap();
        assert!(scene.relativity.is_none());
        let back = format!("Lorentz {{ velocity 0 0 0.5 Lorentz {{ velocity 0 0 0 {BALL} }} }}");
        let scene = compiled(CAMERA, &back).unwrap();
        assert_eq!(scene.relativity.unwrap().frame_of(ObjectId::from_index(0)), FrameId::new(1).unwrap());
    }

    #[test]
    fn a_camera_may_move() {
        let camera = CAMERA.replace("angle 30", "angle 30 velocity 0 0 -0.9 worldTime 4");
        let scene = compiled(&camera, BALL).unwrap();
        let observer = scene.relativity.unwrap().observer;
        assert_eq!((observer.velocity, observer.time), (DVec3::new(0.0, 0.0, -0.9), 4.0));
    }

    /// A camera by its own clock is where its world line is, and at the moment 0 where it would have come from.
    #[test]
    fn a_camera_may_go_by_its_own_clock() {
        let flown = |line: &str| {
            let camera = CAMERA.replace("angle 30", &format!("angle 30 WorldLine {{ {line} }}"));
            let scene = compiled(&camera, BALL).unwrap();
            let observer = scene.relativity.as_ref().unwrap().observer;
            let places = scene.output.camera.origins([Vec2::NEG_ONE, Vec2::ONE], 1.0).unwrap();
            let still = compiled(CAMERA, BALL).unwrap().output.camera;
            let from = still.origins([Vec2::NEG_ONE, Vec2::ONE], 1.0).unwrap().center();
            (observer, (places.center() - from).as_dvec3())
        };
        let (observer, at_first) = flown("event 0 0 0 0  event 10 0 0 -6  event 20 0 0 -12  properTime 4");
        assert!(observer.velocity.distance(DVec3::new(0.0, 0.0, -0.6)) < 1e-12, "{observer:?}");
        assert!((observer.time - 5.0).abs() < 1e-12 && at_first.length() < 1e-6, "{observer:?} {at_first}");
        let (observer, at_first) = flown("acceleration 0 0 -0.5  properTime 3");
        let (v, t, x) = (1.5f64.tanh(), 1.5f64.sinh() / 0.5, (1.5f64.cosh() - 1.0) / 0.5);
        assert!((observer.velocity.z + v).abs() < 1e-12 && (observer.time - t).abs() < 1e-12, "{observer:?}");
        assert!((at_first.z - (t * v - x)).abs() < 1e-5, "{at_first}");
    }

    #[test]
    fn mistakes_of_world_lines_are_named() {
        for (line, expected) in [
            ("WorldLine { }", "goes through events, and here is none"),
            ("WorldLine { event 0 0 0 0  event 0 1 0 0 }", "in the order of their moments"),
            ("WorldLine { event 0 0 0 0  event 1 2 0 0 }", "at 2.0000 times the speed of light"),
            ("WorldLine { event 0 0 0 0  acceleration 0 0 1 }", "either events or an `acceleration`"),
            ("WorldLine { acceleration 0 0 1  properTime 50 }", "as fast as light, nearly"),
            ("WorldLine { acceleration 0 0 1  properTime 5000 }", "as fast as light, nearly"),
            ("WorldLine { acceleration 0 0 1 } velocity 0.5 0 0", "beside a `WorldLine`"),
            ("WorldLine { acceleration 0 0 1 } worldTime 2", "beside a `WorldLine`"),
        ] {
            let camera = CAMERA.replace("angle 30", &format!("angle 30 {line}"));
            let said = compiled(&camera, BALL).unwrap_err();
            assert!(said.contains(expected), "{line}: {said}");
        }
        let fitted = "PerspectiveCamera { fit scene WorldLine { acceleration 0 0 1 } }";
        let said = compiled(fitted, BALL).unwrap_err();
        assert!(said.contains("as if it stood at the origin"), "{said}");
    }

    #[test]
    fn mistakes_are_named() {
        let error = |objects: &str| compiled(CAMERA, objects).unwrap_err();
        for fast in ["1 0 0", "0.8 0.8 0", "-3 0 0"] {
            let said = error(&format!("Lorentz {{ velocity {fast} {BALL} }}"));
            assert!(said.contains("less than 1 long"), "{said}");
        }
        let near = error(&format!("Lorentz {{ velocity 0.99999999 0 0 {BALL} }}"));
        assert!(near.contains("at the speed of light"), "{near}");
        let fast = |inner: &str| format!("Lorentz {{ velocity 0.9999 0 0 {inner} }}");
        let nested = error(&fast(&fast(&fast(BALL))));
        assert!(nested.contains("at the speed of light"), "{nested}");
        let missing = error(&format!("Lorentz {{ {BALL} }}"));
        assert!(missing.contains("velocity"), "{missing}");
        let motion = "Motion { key 0 { } key 1 { Translate 1 0 0 } }";
        let moving = error(&format!("Transform {{ {motion} Lorentz {{ velocity 0.5 0 0 {BALL} }} }}"));
        assert!(moving.contains("`Motion`"), "{moving}");
        let moving = error(&format!("Lorentz {{ velocity 0.5 0 0 Transform {{ {motion} {BALL} }} }}"));
        assert!(moving.contains("rests in it"), "{moving}");
        let defined = error(&format!("Define car {{ Lorentz {{ velocity 0.5 0 0 {BALL} }} }} {BALL}"));
        assert!(defined.contains("a definition cannot hold"), "{defined}");
        let solid = error(&format!("Difference {{ Lorentz {{ velocity 0.5 0 0 {BALL} }} {BALL} }}"));
        assert!(solid.contains("made of"), "{solid}");
        let camera = CAMERA.replace("angle 30", "angle 30 velocity 0 0 -1");
        assert!(compiled(&camera, BALL).unwrap_err().contains("less than 1 long"));
        let many: String =
            (0..300).map(|i| format!("Lorentz {{ velocity {} 0 0 {BALL} }}", 0.001 * f64::from(i))).collect();
        assert!(error(&many).contains("different velocities"));
    }
}
