//! Numbers of 16 bits: a sign, 5 bits of exponent and 10 of fraction [IEEE 754-2008, binary16].

/// The largest finite one.
pub const MAX: f32 = 65504.0;

/// The nearest half to `v`, ties to even; what is larger than [`MAX`] becomes infinite, and what is no number none.
pub fn from_f32(v: f32) -> u16 {
    let bits = v.to_bits();
    let sign = ((bits >> 16) & 0x8000) as u16;
    let magnitude = bits & 0x7fff_ffff;
    if magnitude > 0x7f80_0000 {
        return sign | 0x7e00;
    }
    // Halfway between the largest half and what would come next.
    if magnitude >= 0x477f_f000 {
        return sign | 0x7c00;
    }
    if magnitude < 0x3880_0000 {
        // Below 2^-14 halves are multiples of 2^-24, which adding 1/2 rounds a float to.
        let shifted = (f32::from_bits(magnitude) + 0.5).to_bits();
        return sign | (shifted - 0x3f00_0000) as u16;
    }
    let odd = (magnitude >> 13) & 1;
    sign | ((magnitude - 0x3800_0000 + 0x0fff + odd) >> 13) as u16
}

/// The value of a half.
pub fn to_f32(half: u16) -> f32 {
    let (sign, magnitude) = (u32::from(half & 0x8000) << 16, u32::from(half & 0x7fff));
    let value = match magnitude >> 10 {
        0 => magnitude as f32 * (1.0 / 16_777_216.0),
        31 => f32::from_bits(0x7f80_0000 | (magnitude << 13)),
        _ => f32::from_bits((magnitude << 13) + 0x3800_0000),
    };
    f32::from_bits(value.to_bits() | sign)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_half_survives_and_neighbours_share_what_is_between() {
        for half in 0..=0xffffu16 {
            let value = to_f32(half);
            if value.is_nan() {
                assert!(to_f32(from_f32(value)).is_nan());
                continue;
            }
            assert_eq!(from_f32(value), half, "{value}");
            let next = to_f32(half + u16::from(half & 0x7fff < 0x7bff));
            let middle = 0.5 * (value + next);
            let expected = if half & 1 == 0 { half } else { half + 1 };
            if next != value {
                assert_eq!(from_f32(middle), expected, "between {value} and {next}");
                let (inner, outer) = (middle + 0.5 * (next - middle), 0.5 * (value + middle));
                assert_eq!((from_f32(inner), from_f32(outer)), (half + 1, half), "{value}");
            }
        }
    }

    #[test]
    fn known_values() {
        assert_eq!([1.0, -2.0, 65504.0, 0.0].map(from_f32), [0x3c00, 0xc000, 0x7bff, 0]);
        assert_eq!((from_f32(65520.0), from_f32(1e-9)), (0x7c00, 0));
        assert_eq!(to_f32(0x3555), 0.333_251_95);
    }
}
