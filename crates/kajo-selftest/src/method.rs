//! The integrators, each with the settings that make a method of its own.

/// An integrator and how it is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    /// What the user reads.
    pub name: &'static str,
    /// Lines of a `Settings` block.
    pub settings: &'static str,
}

const fn method(name: &'static str, settings: &'static str) -> Method {
    Method { name, settings }
}

/// Path tracing with lights drawn and met, weighed against each other.
pub const PATH: Method = method("path", "integrator path");

/// Path tracing in which lights are only met.
pub const PATH_SCATTERING: Method = method("path, scattering", "integrator path  technique scattering");

/// Path tracing in which lights are only drawn.
pub const PATH_LIGHTS: Method = method("path, lights", "integrator path  technique lights");

/// Path tracing by wavelength.
pub const PATH_SPECTRAL: Method = method("path, spectral", "integrator path  spectral on");

/// Path tracing whose paths end after the last bounce only.
pub const PATH_NO_ROULETTE: Method = method("path, no roulette", "integrator path  roulette off");

/// What emitters light themselves.
pub const DIRECT: Method = method("direct", "integrator direct");

/// Distribution ray tracing with directions by the cosine.
pub const DISTRIBUTION_COSINE: Method =
    method("distribution, cosine", "integrator distribution  directions cosine  branches 4");

/// Distribution ray tracing with directions all alike.
pub const DISTRIBUTION_UNIFORM: Method =
    method("distribution, uniform", "integrator distribution  directions uniform  branches 4");

/// Paths from the camera and from lights, joined.
pub const BIDIRECTIONAL: Method = method("bidirectional", "integrator bidirectional");

/// The same by wavelength.
pub const BIDIRECTIONAL_SPECTRAL: Method =
    method("bidirectional, spectral", "integrator bidirectional  spectral on");

/// Paths from lights alone.
pub const LIGHT: Method = method("light", "integrator light");

/// Photons anew for each sample, in ever smaller disks.
pub const SPPM: Method = method("sppm", "integrator sppm  photons 20000");

/// The same by wavelength.
pub const SPPM_SPECTRAL: Method = method("sppm, spectral", "integrator sppm  photons 1000  spectral on");

/// Paths from the camera and from lights, joined and merged.
pub const VCM: Method = method("vcm", "integrator vcm  photons 5000");

/// The same with one radius for all passes.
pub const VCM_ONE_RADIUS: Method =
    method("vcm, one radius", "integrator vcm  photons 2000  mergeRadius 0.03  mergeAlpha 1");

/// Paths from the camera and from lights, joined and merged, by wavelength.
pub const VCM_SPECTRAL: Method = method("vcm, spectral", "integrator vcm  photons 500  spectral on");

/// Irradiance of few points, interpolated.
pub const IRRADIANCE: Method = method("irradiance", "integrator irradiance  rays 1024");

/// What interpolates, with errors that more samples do not take away.
pub const CACHES: &[Method] = &[IRRADIANCE];

/// Markov chains over paths from both ends.
pub const MLT: Method = method("mlt", "integrator mlt");

/// The same with chains for each length of paths.
pub const MMLT: Method = method("mmlt", "integrator mmlt");

/// Path tracing that also draws lights through glass.
pub const PATH_MANIFOLD: Method = method("path, manifold", "integrator path  caustics manifold");

/// One map of photons that is seen itself.
pub const PHOTON_DIRECT: Method =
    method("photon, direct", "integrator photon  photons 100000  photonMap direct");

/// What keeps photons and vertices for each sample of a picture of some pixels, few of them.
pub const FEW_PHOTONS: &[Method] =
    &[method("sppm", "integrator sppm  photons 2000"), method("vcm", "integrator vcm  photons 1000")];

/// One map of photons behind one more ray, and one of caustics beside paths.
pub const FEW_PHOTONS_IN_MAPS: &[Method] = &[
    method("photon, gather", "integrator photon  photons 10000  photonMap gather"),
    method("photon, caustics", "integrator photon  photons 10000  photonMap caustics"),
];

/// What keeps photons, vertices or records for a whole picture, where there is little but direct light: few of them, and in disks that
/// the small floors of such scenes hold.
pub const SHARED: &[Method] = &[
    method("sppm", "integrator sppm  photons 200"),
    method("vcm", "integrator vcm  photons 200  mergeRadius 0.002"),
    method("photon, gather", "integrator photon  photons 2000  photonMap gather"),
    method("photon, caustics", "integrator photon  photons 2000  photonMap caustics"),
    IRRADIANCE,
];

/// Those of them that keep photons and vertices, and count mirrors among their bounces.
pub const SHARED_PHOTONS: &[Method] = SHARED.split_at(4).0;

/// What keeps photons, and makes as many of them as it takes samples.
pub const PHOTONS: &[Method] = &[SPPM, VCM];

/// The same by wavelength: all paths of a sample of the picture have the same wavelengths, so many small samples are taken.
pub const PHOTONS_SPECTRAL: &[Method] = &[SPPM_SPECTRAL, VCM_SPECTRAL];

/// Columns and rows of pictures that are to have such samples.
pub const SIZE_BY_WAVELENGTH: [u32; 2] = [12, 12];

/// Ambient occlusion.
pub const OCCLUSION: Method = method("occlusion", "integrator occlusion");

/// Recursive ray tracing with the classic formula.
pub const CLASSIC: Method = method("classic", "integrator classic");

/// Everything that follows light through any number of bounces.
pub const GLOBAL: &[Method] =
    &[PATH, PATH_SCATTERING, PATH_LIGHTS, PATH_SPECTRAL, BIDIRECTIONAL, BIDIRECTIONAL_SPECTRAL];

/// The same with light that cannot leave a clear body mirrored in it.
pub const CLASSIC_TOTAL: Method =
    method("classic, total reflection", "integrator classic  totalReflection on");

/// Everything that takes a number of bounces.
pub const BOUNCES: &[Method] = &[
    PATH,
    PATH_SCATTERING,
    PATH_LIGHTS,
    PATH_SPECTRAL,
    PATH_NO_ROULETTE,
    BIDIRECTIONAL,
    DISTRIBUTION_COSINE,
    DISTRIBUTION_UNIFORM,
];

/// Everything that estimates the light of emitters of some size.
pub const LIGHTS: &[Method] = &[PATH, PATH_SCATTERING, PATH_LIGHTS, PATH_SPECTRAL, BIDIRECTIONAL, DIRECT];

/// The same for lights so small that they are hardly ever met.
pub const SMALL_LIGHTS: &[Method] = &[PATH, PATH_LIGHTS, BIDIRECTIONAL, DIRECT];

/// Everything that follows mirrors and glass.
pub const MIRRORS: &[Method] = &[PATH, BIDIRECTIONAL, DIRECT, CLASSIC];

/// The same where light is totally reflected.
pub const TOTAL_MIRRORS: &[Method] = &[PATH, BIDIRECTIONAL, DIRECT, CLASSIC_TOTAL];

/// The same without the classic integrator, which does not divide radiance by the squared index.
pub const GLASS: &[Method] = &[PATH, PATH_SPECTRAL, BIDIRECTIONAL, DIRECT];

/// Everything that shows whole matt surfaces.
pub const WHOLE: &[Method] =
    &[PATH, PATH_SCATTERING, PATH_LIGHTS, PATH_SPECTRAL, BIDIRECTIONAL, LIGHT, DIRECT];
