//! `kajo diff`: how far two pictures are apart.

use kajo::compare::Difference;
use kajo::output::Target;
use kajo::{EncodeOptions, Format, encode};

use crate::args::DiffArgs;
use crate::console;
use crate::failure::Failure;
use crate::output::Destination;

pub fn diff(args: &DiffArgs) -> Result<(), Failure> {
    let target = args.output.as_ref().map(|path| {
        let format = Destination::File(path.clone()).format()?;
        let inputs = [args.reference.clone(), args.picture.clone()];
        Ok::<(Target, Format), Failure>((Target::check(path, &inputs)?, format))
    });
    let target = target.transpose()?;
    let difference = Difference::between(&args.reference, &args.picture)?;
    let percent_off = 100.0 * difference.share_above(args.max_off)?;
    console::answer(&figures(&difference, args.max_off, percent_off))?;
    if let Some((target, format)) = target {
        target.write(&encode(&difference.picture()?, format, &EncodeOptions::default())?)?;
    }
    match args.share {
        Some(allowed) if percent_off > allowed => Err(Failure::Different(format!(
            "{percent_off:.4} % of the pixels are off by more than {}/255; {allowed} % are allowed",
            args.max_off
        ))),
        _ => Ok(()),
    }
}

fn figures(difference: &Difference, max_off: f64, percent_off: f64) -> String {
    let figures = &difference.figures;
    format!(
        "MSE      {:.6e}\nRMSE     {:.6e}\nPSNR     {:.3} dB\nrelMSE   {:.6e}\nFLIP     {:.6}\nlargest  {:.3}/255\n\
         off by more than {max_off}/255: {percent_off:.4} % of the pixels\n",
        figures.mse,
        figures.rmse,
        figures.psnr,
        figures.rel_mse,
        difference.mean_flip(),
        figures.max_abs * 255.0
    )
}
