//! Renders by the machines of another program, `kajo render --farm stdio`: that program is this test.

mod common;

use std::collections::BTreeMap;
use std::fs;
use std::io::BufReader;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use common::Folder;
use kajo_farm::protocol::{Request, Response, receive, send};
use kajo_farm::{LossKind, News, Order};

const RENDER: &str =
    "render ball.txt --size 64 48 --samples sobol 8 --integrator distribution --layers color,depth";
const UNITS: &str = "--unit-tile 24 --unit-samples 3 --job job";

/// A worker process.
struct Worker {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Worker {
    fn start(folder: &Folder, plan: &str, bundle: &[u8]) -> Worker {
        let mut child = folder
            .command()
            .args(["worker", "--stdio", "--threads", "1"])
            .current_dir("/")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (input, output) = (child.stdin.take().unwrap(), BufReader::new(child.stdout.take().unwrap()));
        let mut worker = Worker { child, input, output };
        let (opened, _) = worker.ask(&Request::Open { plan: plan.to_owned() }, bundle);
        assert!(opened.ok, "{opened:?}");
        worker
    }

    fn ask(&mut self, request: &Request, bytes: &[u8]) -> (Response, Vec<u8>) {
        send(&mut self.input, request, bytes).unwrap();
        receive(&mut self.output).unwrap().unwrap()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What the engine says to the order of a unit, for the n-th time; what it renders is the part.
type Answer<'a> = &'a mut dyn FnMut(u64, u32, Vec<u8>) -> Vec<(News, Vec<u8>)>;

fn brought(unit: u64, part: Vec<u8>) -> (News, Vec<u8>) {
    (News::Part { stage: 0, unit, host: "here".into(), samples: 1, rays: 1, seconds: 0.1 }, part)
}

fn lost(unit: u64, kind: LossKind) -> (News, Vec<u8>) {
    (News::Lost { stage: 0, unit, host: "here".into(), kind, message: "so it is".into() }, Vec::new())
}

/// Runs a coordinator, and answers its orders. Returns its exit code, what it said, and the units that were ordered.
fn run(folder: &Folder, line: &str, answer: Answer<'_>) -> (Option<i32>, String, BTreeMap<u64, u32>) {
    let mut coordinator = folder
        .command()
        .args(line.split_whitespace())
        .args(["--farm", "stdio"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut news = coordinator.stdin.take().unwrap();
    let mut orders = BufReader::new(coordinator.stdout.take().unwrap());
    let (mut worker, mut position, mut ordered) = (None, Vec::new(), BTreeMap::new());
    while let Some((order, bytes)) = receive::<Order>(&mut orders).unwrap() {
        match order {
            Order::Plan { plan, bundle } => {
                worker = Some(Worker::start(folder, &plan, &fs::read(bundle).unwrap()));
                // Where nothing is missing it has ended by now.
                let _ = send(&mut news, &News::Room { units: 3 }, &[]);
            }
            Order::Stage { .. } => position = bytes,
            Order::Unit { stage, unit, .. } => {
                let (response, part) =
                    worker.as_mut().unwrap().ask(&Request::Unit { stage, unit }, &position);
                assert!(response.ok, "{response:?}");
                let times = ordered.entry(unit).or_insert(0);
                *times += 1;
                for (message, part) in answer(unit, *times, part) {
                    // It may have ended.
                    let _ = send(&mut news, &message, &part);
                }
            }
            Order::Drop { .. } => {}
            Order::End => break,
        }
    }
    drop((worker, news));
    let ended = coordinator.wait_with_output().unwrap();
    (ended.status.code(), String::from_utf8_lossy(&ended.stderr).into_owned(), ordered)
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.succeed(&format!("{RENDER} -o plain.exr"));
    folder
}

#[test]
fn an_engine_without_a_shared_folder_makes_the_picture_of_a_plain_render() {
    let folder = folder();
    let line = format!("{RENDER} {UNITS} -o out.exr");
    let (code, said, ordered) = run(&folder, &line, &mut |unit, _, part| vec![brought(unit, part)]);
    assert_eq!((code, ordered.len()), (Some(0), 18), "{said}");
    assert!(said.contains("here: 18 units, "), "{said}");
    assert!(folder.read("out.exr") == folder.read("plain.exr"));
    // What is finished is not ordered again.
    let (code, said, ordered) = run(&folder, &line, &mut |_, _, _| Vec::new());
    assert_eq!((code, ordered.len()), (Some(0), 0), "{said}");
}

#[test]
fn what_an_engine_loses_doubles_or_damages_does_no_harm() {
    let folder = folder();
    let mut last = Vec::new();
    let mut answer = |unit: u64, times: u32, part: Vec<u8>| {
        let before = std::mem::replace(&mut last, part.clone());
        match (unit % 5, times) {
            (0, 1 | 2) => vec![lost(unit, LossKind::Worker)],
            (1, 1) => {
                let mut damaged = part;
                damaged[100] ^= 1;
                vec![brought(unit, damaged)]
            }
            (2, 1) => vec![brought(unit, before)],
            (3, 1) => vec![lost(unit, LossKind::Unit)],
            (4, _) => vec![brought(unit, part.clone()), brought(unit, part)],
            _ => vec![brought(unit, part)],
        }
    };
    let (code, said, ordered) = run(&folder, &format!("{RENDER} {UNITS} -o out.exr"), &mut answer);
    assert_eq!(code, Some(0), "{said}");
    assert!(folder.read("out.exr") == folder.read("plain.exr"));
    assert!(ordered[&0] >= 3 && ordered[&1] >= 2, "{ordered:?}");
    for word in ["is rendered again: so it is", "is no part of this job", "another unit", "try 1 of 3"] {
        assert!(said.contains(word), "{word}: {said}");
    }
}

#[test]
fn a_unit_that_fails_everywhere_is_left_out_and_named() {
    let folder = folder();
    let line = format!("{RENDER} {UNITS} -o out.exr");
    let (code, said, ordered) = run(&folder, &line, &mut |unit, _, part| match unit {
        7 => vec![lost(unit, LossKind::Unit)],
        _ => vec![brought(unit, part)],
    });
    assert_eq!((code, ordered[&7], ordered.len()), (Some(4), 3, 18), "{said}");
    assert!(said.contains("unit 7: so it is") && !folder.path("out.exr").exists(), "{said}");
    let (code, said, ordered) = run(&folder, &line, &mut |unit, _, part| vec![brought(unit, part)]);
    assert_eq!((code, ordered.len()), (Some(0), 1), "{said}");
    assert!(folder.read("out.exr") == folder.read("plain.exr"));
}

#[test]
fn an_engine_that_ends_or_gives_up_is_told_of() {
    let folder = folder();
    let line = format!("{RENDER} {UNITS} -o out.exr");
    for (wrong, code) in [(true, Some(2)), (false, Some(3))] {
        let over = News::Over { wrong, message: "all machines are gone".into() };
        let mut answer = |_, _, _| vec![(over.clone(), Vec::new())];
        let (found, said, _) = run(&folder, &line, &mut answer);
        assert_eq!(found, code, "{said}");
        assert!(said.contains("all machines are gone"), "{said}");
    }
    let (code, said, _) = run(&folder, &line, &mut |unit, _, _| vec![lost(unit, LossKind::Input)]);
    assert_eq!(code, Some(2), "{said}");
    // Nobody is there at all.
    folder.fail(&format!("{line} --farm stdio"), 3, &["the engine has ended"]);
    folder.fail("render ball.obj --farm stdio -o out.exr", 2, &["no such file"]);
}

#[test]
fn a_worker_refuses_the_bundle_of_another_scene() {
    let folder = folder();
    folder.succeed(&format!("plan {} {UNITS} -o out.exr", RENDER.trim_start_matches("render ")));
    folder.write("other.txt", common::BALL.replace("radius 1", "radius 1.01"));
    folder.succeed("bundle other.txt -o other.kbundle");
    folder.succeed("bundle ball.txt -o ball.kbundle");
    folder.fail("unit --job job --index 0 --bundle other.kbundle", 2, &["the plan is of another render"]);
    folder.succeed("unit --job job --index 0 --bundle ball.kbundle");
}
