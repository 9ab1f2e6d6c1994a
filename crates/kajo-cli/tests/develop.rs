//! What happens to a picture after it is rendered: denoising, exposure, tone curves, gamuts.

mod common;

use common::Folder;

const BALL: &str = "ball.txt --size 60 40 --samples uniform 4";

fn values(folder: &Folder, name: &str) -> Vec<f32> {
    common::picture(&folder.path(name)).into_data()
}

#[test]
fn an_exposure_beyond_all_numbers_is_warned_of() {
    let folder = Folder::new();
    folder.write("ball.txt", common::BALL.replace("color 0.9 0.9 0.9", "color 1e20 1e20 1e20"));
    let ran = folder.succeed(&format!("{BALL} -o bright.exr --exposure 100"));
    assert!(ran.stderr.contains("warning: the exposure makes"), "{}", ran.stderr);
    assert!(values(&folder, "bright.exr").iter().all(|v| v.is_finite()));
    let ran = folder.succeed(&format!("{BALL} -o bright.exr --exposure 50"));
    assert!(!ran.stderr.contains("exposure"), "{}", ran.stderr);
}

#[test]
fn light_is_developed_for_the_kind_of_file() {
    let folder = Folder::new();
    folder.succeed(&format!("{BALL} -o plain.exr"));
    folder.succeed(&format!("{BALL} -o bright.exr --exposure 2 --tone agx"));
    for (plain, bright) in values(&folder, "plain.exr").into_iter().zip(values(&folder, "bright.exr")) {
        assert_eq!(bright, 4.0 * plain, "a file of light has no tone curve");
    }
    folder.succeed(&format!("{BALL} -o plain.png --bits 16"));
    folder.succeed(&format!("{BALL} -o srgb.png --bits 16 --tone srgb"));
    let encoded = |v: f32| if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    for (plain, srgb) in values(&folder, "plain.png").into_iter().zip(values(&folder, "srgb.png")) {
        assert!((srgb - encoded(plain)).abs() < 1e-3, "{plain} became {srgb}");
    }
    folder.succeed(&format!("{BALL} -o warm.exr --white-balance 3000"));
    let (warm, plain) = (values(&folder, "warm.exr"), values(&folder, "plain.exr"));
    assert!(warm[0] < plain[0] && warm[2] > 1.5 * plain[2], "{:?} became {:?}", &plain[..3], &warm[..3]);
    folder.succeed(&format!("{BALL} -o wide.exr --gamut acescg"));
    let wide = folder.read("wide.exr");
    assert!(wide.windows(15).any(|bytes| bytes == b"chromaticities\0"));
    assert_ne!(values(&folder, "wide.exr"), values(&folder, "plain.exr"));
    folder.fail(&format!("{BALL} -o a.png --tone filmic"), 2, &["filmic", "agx"]);
    folder.fail(&format!("{BALL} -o a.png --white-balance 50"), 2, &["temperature"]);
    folder.fail(&format!("{BALL} -o a.png --exposure 101"), 2, &["from -100 to 100"]);
}

#[test]
fn noise_is_taken_out_by_what_is_there() {
    let folder = Folder::new();
    folder.succeed(&format!("{BALL} -o noisy.exr"));
    let ran = folder.succeed(&format!("{BALL} -o smooth.exr --denoise builtin"));
    assert!(ran.stderr.contains("denoised by non-local means"), "{}", ran.stderr);
    let once = folder.succeed(&format!("{BALL} --samples 1 -o once.exr --denoise builtin"));
    assert!(once.stderr.contains("is not denoised") && once.stderr.contains("only one"), "{}", once.stderr);
    let quiet = folder.succeed(&format!("{BALL} -o smooth.exr --denoise builtin --quiet --threads 1"));
    assert_eq!(quiet.stderr, "");
    let (noisy, smooth) = (values(&folder, "noisy.exr"), values(&folder, "smooth.exr"));
    assert!(noisy != smooth && noisy.len() == smooth.len(), "only light is written");
    let mean = |values: &[f32]| values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64;
    assert!((mean(&smooth) / mean(&noisy) - 1.0).abs() < 0.02);

    let mut command = folder.command();
    command.args(format!("{BALL} -o same.exr --denoise oidn").split_whitespace());
    let output = command.env("KAJO_OIDN", "libNoSuchDenoiser.so").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        output.status.success() && said.contains("is not denoised") && said.contains("not installed"),
        "{said}"
    );
    assert!(values(&folder, "same.exr") == noisy, "the noisy picture is kept");
}
