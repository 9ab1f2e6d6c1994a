//! Patterns of the nearest of many points.

use kajo_math::pattern::{Metric, Worley, WorleyValue};

use super::{SEED, pattern_member};
use crate::compile::fields::{Keys, choice, choices, keys};

choices! {
    Metric {
        "chebyshev" => Metric::Chebyshev,
        "euclidean" => Metric::Euclidean,
        "manhattan" => Metric::Manhattan,
    }
}

choices! {
    WorleyValue {
        "cell" => WorleyValue::Cell,
        "crackle" => WorleyValue::Crackle,
        "nearest" => WorleyValue::Nearest,
        "second" => WorleyValue::Second,
    }
}

keys! {
    WorleyKeys {
        value: WorleyValue = choice::<WorleyValue>("value").or_word("nearest", "what the distances make"),
        metric: Metric = choice::<Metric>("metric").or_word("euclidean", "how distances are measured"),
        seed: u32 = SEED,
    }
}

keys! {
    CrackleKeys {
        metric: Metric = choice::<Metric>("metric").or_word("euclidean", "how distances are measured"),
        seed: u32 = SEED,
    }
}

pattern_member!(
    WORLEY,
    "Worley",
    "distances to the nearest of many points",
    [WorleyKeys],
    |params, sources| {
        let WorleyKeys { value, metric, seed } = WorleyKeys::read(params, sources)?;
        Worley { metric, value, seed }
    }
);

pattern_member!(
    CRACKLE,
    "Crackle",
    "cells with dark walls, as of dry mud and giraffes",
    [CrackleKeys],
    |params, sources| {
        let CrackleKeys { metric, seed } = CrackleKeys::read(params, sources)?;
        Worley { metric, value: WorleyValue::Crackle, seed }
    }
);
