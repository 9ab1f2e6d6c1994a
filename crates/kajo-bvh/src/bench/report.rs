//! Running the protocol and reporting what it showed.

use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use super::clock::{Seconds, thread_seconds, timed};
use super::{Mesh, primary, secondary};
use crate::{BuildError, BuildSettings, TriangleBvh, TriangleHit};

/// Rays that a thread takes at a time.
const CHUNK: usize = 1024;

/// What to run.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Threads that build and trace.
    pub threads: usize,
    /// Times that every figure is taken.
    pub passes: usize,
    /// Times that the tree is built.
    pub builds: usize,
    /// What kind of tree.
    pub build: BuildSettings,
}

/// A figure for each set of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures<T> {
    /// Primary rays.
    pub primary: T,
    /// Bounce rays.
    pub bounce: T,
    /// Shadow rays.
    pub shadow: T,
}

/// 10^6 rays a second of each set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// Primary rays, one by one.
    pub primary: f64,
    /// Bounce rays.
    pub bounce: f64,
    /// Shadow rays.
    pub shadow: f64,
    /// Primary rays, eight at a time.
    pub primary_packet: f64,
}

/// What running the protocol on one mesh showed.
#[derive(Clone, Debug)]
pub struct Report {
    /// Name of the mesh.
    pub mesh: String,
    /// Its triangles.
    pub triangles: usize,
    /// Threads used.
    pub threads: usize,
    /// Median seconds of a build by wall clock.
    pub build_wall_s: f64,
    /// Median seconds of a build by processor time, all threads added.
    pub build_cpu_s: f64,
    /// Memory of the finished tree with its triangles.
    pub bytes: usize,
    /// 10^6 rays a second by wall clock, all threads together.
    pub mrays_wall: Rates,
    /// 10^6 rays per second of processor time of one thread.
    pub mrays_cpu: Rates,
    /// Rays that hit something.
    pub hits: Figures<usize>,
    /// Sum of the hits' distances: primary and bounce.
    pub sum_t: [f64; 2],
}

impl Report {
    /// The report as a JSON object on one line.
    pub fn to_json(&self) -> String {
        let mut out = String::new();
        let rates = |r: &Rates| {
            format!(
                "{{\"primary\":{:.4},\"bounce\":{:.4},\"shadow\":{:.4},\"primary_packet\":{:.4}}}",
                r.primary, r.bounce, r.shadow, r.primary_packet
            )
        };
        // Writing to a string cannot fail.
        let _ = write!(
            out,
            "{{\"mesh\":\"{}\",\"triangles\":{},\"threads\":{},\"build_wall_s\":{:.5},\"build_cpu_s\":{:.5},\"bytes\":{},",
            self.mesh.escape_default(),
            self.triangles,
            self.threads,
            self.build_wall_s,
            self.build_cpu_s,
            self.bytes
        );
        let _ = write!(
            out,
            "\"mrays_wall\":{},\"mrays_cpu\":{},\"hits\":{{\"primary\":{},\"bounce\":{},\"shadow\":{}}},\"sum_t\":{{\"primary\":{},\"bounce\":{}}}}}",
            rates(&self.mrays_wall),
            rates(&self.mrays_cpu),
            self.hits.primary,
            self.hits.bounce,
            self.hits.shadow,
            self.sum_t[0],
            self.sum_t[1]
        );
        out
    }
}

/// Traces `rays`, or packets of them, `chunk` at a time, by `trace`.
fn trace<R: Sync, T: Send>(
    rays: &[R],
    out: &mut [T],
    chunk: usize,
    threads: usize,
    trace: impl Fn(&R) -> T + Sync,
) -> Seconds {
    let chunks: Vec<_> = rays
        .chunks(chunk)
        .zip(out.chunks_mut(chunk))
        .map(|chunk| std::sync::Mutex::new(Some(chunk)))
        .collect();
    let next = AtomicUsize::new(0);
    let work = || {
        thread_seconds(|| {
            while let Some(chunk) = chunks.get(next.fetch_add(1, Ordering::Relaxed)) {
                let Some((rays, out)) = chunk.lock().ok().and_then(|mut c| c.take()) else { continue };
                for (ray, out) in rays.iter().zip(out) {
                    *out = trace(ray);
                }
            }
        })
    };
    let start = Instant::now();
    let cpu: f64 = std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let own = work();
        own + others.into_iter().filter_map(|t| t.join().ok()).sum::<f64>()
    });
    Seconds { wall: start.elapsed().as_secs_f64(), cpu: cpu / threads as f64 }
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Runs the protocol on a mesh.
///
/// `settings.threads`, `passes` and `builds` below one count as one.
pub fn run(mesh: &Mesh, settings: &Settings) -> Result<Report, BuildError> {
    let threads = settings.threads.max(1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok();
    let build = || TriangleBvh::build(&mesh.positions, &mesh.triangles, &settings.build);
    let mut build_times = Vec::new();
    let mut tree = TriangleBvh::default();
    for _ in 0..settings.builds.max(1) {
        let (built, time) = timed(|| pool.as_ref().map_or_else(build, |pool| pool.install(build)));
        tree = built?;
        build_times.push(time);
    }

    let rays = primary(mesh);
    let mut hits: Vec<Option<TriangleHit>> = vec![None; rays.len()];
    trace(&rays, &mut hits, CHUNK, threads, |ray| tree.closest(ray));
    let second = secondary(mesh, &rays, &hits);
    let mut bounces = vec![None; second.bounce.len()];
    let mut shadows = vec![false; second.shadow.len()];
    let (packets, _) = rays.as_chunks::<8>();
    let mut packet_hits = vec![[None; 8]; packets.len()];
    let mut times = [const { Vec::new() }; 4];
    for _ in 0..settings.passes.max(1) {
        times[0].push(trace(&rays, &mut hits, CHUNK, threads, |ray| tree.closest(ray)));
        times[1].push(trace(&second.bounce, &mut bounces, CHUNK, threads, |ray| tree.closest(ray)));
        times[3].push(trace(packets, &mut packet_hits, CHUNK / 8, threads, |rays| tree.closest8(rays)));
        times[2].push(trace(&second.shadow, &mut shadows, CHUNK, threads, |ray| tree.any(ray)));
    }

    assert!(packet_hits.iter().flatten().eq(&hits), "packets hit what their rays hit");

    let sizes = [rays.len(), second.bounce.len(), second.shadow.len(), rays.len()];
    let rate = |seconds: fn(&Seconds) -> f64| {
        let [primary, bounce, shadow, primary_packet] =
            [0, 1, 2, 3].map(|i| sizes[i] as f64 * 1e-6 / median(times[i].iter().map(seconds).collect()));
        Rates { primary, bounce, shadow, primary_packet }
    };
    let count = |hits: &[Option<TriangleHit>]| hits.iter().flatten().count();
    let sum_t = |hits: &[Option<TriangleHit>]| hits.iter().flatten().map(|h| f64::from(h.t)).sum();
    Ok(Report {
        mesh: mesh.name.clone(),
        triangles: mesh.triangles.len(),
        threads,
        build_wall_s: median(build_times.iter().map(|t| t.wall).collect()),
        build_cpu_s: median(build_times.iter().map(|t| t.cpu).collect()),
        bytes: tree.stats().bytes,
        mrays_wall: rate(|t| t.wall),
        mrays_cpu: rate(|t| t.cpu),
        hits: Figures {
            primary: count(&hits),
            bounce: count(&bounces),
            shadow: shadows.iter().filter(|hit| **hit).count(),
        },
        sum_t: [sum_t(&hits), sum_t(&bounces)],
    })
}
