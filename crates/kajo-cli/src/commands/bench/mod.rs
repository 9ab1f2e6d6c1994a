//! `kajo bench`: how fast the program is, on its own scenes and on meshes.

mod rays;
mod whitted;

use kajo_selftest::bench::{Machine, Spread, Times, memory, parse};

use crate::args::{BenchArgs, BenchCommand, MemoryArgs, ParseArgs};
use crate::failure::Failure;
use crate::{console, json};

pub fn bench(args: &BenchArgs) -> Result<(), Failure> {
    match &args.what {
        BenchCommand::Whitted(args) => whitted::run(args),
        BenchCommand::Rays(args) => rays::run(args),
        BenchCommand::Parse(args) => parse(args),
        BenchCommand::Memory(args) => memory(args),
    }
}

/// The commit that the program was built from, where its builder says so in `KAJO_COMMIT`.
const COMMIT: Option<&str> = option_env!("KAJO_COMMIT");

/// `kajo 0.1.0 (1a2b3c4); Fast 3000, 2 cores, AVX2`
fn header() -> String {
    let Machine { processor, cores, simd } = Machine::here();
    let commit = COMMIT.map(|commit| format!(" ({commit})")).unwrap_or_default();
    format!("kajo {}{commit}; {processor}, {cores} cores, {simd}\n", env!("CARGO_PKG_VERSION"))
}

/// The fields of [`header`].
fn machine_json() -> String {
    let Machine { processor, cores, simd } = Machine::here();
    json::object([
        ("version", json::string(env!("CARGO_PKG_VERSION"))),
        ("commit", COMMIT.map_or("null".to_owned(), json::string)),
        ("processor", json::string(&processor)),
        ("cores", cores.to_string()),
        ("simd", json::string(simd)),
    ])
}

/// `0.123 s (0.120 .. 0.130)`
fn seconds(spread: &Spread) -> String {
    format!("{:.4} s ({:.4} .. {:.4})", spread.median, spread.min, spread.max)
}

fn times_json(times: &Times) -> String {
    let spread = |s: &Spread| {
        let fields = [("median", s.median), ("min", s.min), ("max", s.max)];
        json::object(fields.map(|(name, value)| (name, json::number(value))))
    };
    json::object([("wall_s", spread(&times.wall)), ("cpu_s", spread(&times.cpu))])
}

fn parse(args: &ParseArgs) -> Result<(), Failure> {
    let report = parse::run(args.lines as usize, args.passes.into())
        .map_err(|error| Failure::Different(error.to_string()))?;
    if args.json {
        let fields = [
            ("machine", machine_json()),
            ("lines", report.lines.to_string()),
            ("bytes", report.bytes.to_string()),
            ("objects", report.objects.to_string()),
            ("parse", times_json(&report.parse)),
            ("load", times_json(&report.load)),
        ];
        console::data(&(json::object(fields) + "\n"))?;
        return Ok(());
    }
    let megabytes = report.bytes as f64 / 1e6;
    let mut text = header();
    text += &format!("{} lines, {megabytes:.1} MB, {} objects\n", report.lines, report.objects);
    for (what, times) in [("parse", &report.parse), ("parse and compile", &report.load)] {
        let rate = megabytes / times.wall.median;
        text += &format!(
            "{what:<20}wall {}, processor {}, {rate:.1} MB/s\n",
            seconds(&times.wall),
            seconds(&times.cpu)
        );
    }
    console::answer(&text)?;
    Ok(())
}

fn memory(args: &MemoryArgs) -> Result<(), Failure> {
    let memory::Report { triangles, file, kept, peak } =
        memory::run(args.triangles as usize).map_err(|error| Failure::Different(error.to_string()))?;
    if args.json {
        let fields = [
            ("machine", machine_json()),
            ("triangles", triangles.to_string()),
            ("file_bytes", file.to_string()),
            ("kept_bytes", kept.to_string()),
            ("peak_bytes", peak.map_or("null".to_owned(), |peak| peak.to_string())),
        ];
        console::data(&(json::object(fields) + "\n"))?;
        return Ok(());
    }
    let megabytes = |bytes: f64| format!("{:.1} MB", bytes / 1e6);
    let peak = match peak {
        Some(peak) => format!("{}, {:.2} times as much", megabytes(peak as f64), peak as f64 / kept as f64),
        None => "not told by this system".to_owned(),
    };
    console::answer(&format!(
        "{}{triangles} triangles from an OBJ file of {}\nmesh and tree       {}\npeak of the process {peak}\n",
        header(),
        megabytes(file as f64),
        megabytes(kept as f64),
    ))?;
    Ok(())
}
