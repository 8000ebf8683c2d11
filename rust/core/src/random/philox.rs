//! Philox4x64-10: a counter enciphered so that its bits pass for random.
//!
//! Source: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, Parallel random numbers: as easy as 1, 2, 3, SC '11.

const ROUNDS: usize = 10;
const MULTIPLIERS: [u64; 2] = [0xD2E7_470E_E14C_6C93, 0xCA5A_8263_9512_1157];
/// What the key grows by from round to round: the golden ratio, and √3 − 1.
const STEPS: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xBB67_AE85_84CA_A73B];

/// The four words that belong to a counter under a key.
///
/// # Examples
///
/// ```
/// use polhode::random::philox;
///
/// assert_eq!(philox([0; 4], [0; 2])[0], 0x1655_4d9e_ca36_314c); // as Random123 publishes
/// ```
#[must_use]
#[inline]
pub fn philox(counter: [u64; 4], key: [u64; 2]) -> [u64; 4] {
    let ([mut a, mut b, mut c, mut d], [mut k, mut l]) = (counter, key);
    for _ in 0..ROUNDS {
        let ((high_a, low_a), (high_c, low_c)) =
            (product(MULTIPLIERS[0], a), product(MULTIPLIERS[1], c));
        [a, b, c, d] = [high_c ^ b ^ k, low_c, high_a ^ d ^ l, low_a];
        k = k.wrapping_add(STEPS[0]);
        l = l.wrapping_add(STEPS[1]);
    }
    [a, b, c, d]
}

/// The upper and the lower word of a product.
#[inline]
fn product(x: u64, y: u64) -> (u64, u64) {
    let both = u128::from(x) * u128::from(y);
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the lower word is what is left"
    )]
    let words = ((both >> 64) as u64, both as u64);
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counter, key and words: the known answers that are published with Random123 (file `kat_vectors`).
    const KNOWN: [([u64; 4], [u64; 2], [u64; 4]); 3] = [
        (
            [0; 4],
            [0; 2],
            [
                0x1655_4d9e_ca36_314c,
                0xdb20_fe9d_672d_0fdc,
                0xd7e7_72ce_e186_176b,
                0x7e68_b68a_ec7b_a23b,
            ],
        ),
        (
            [u64::MAX; 4],
            [u64::MAX; 2],
            [
                0x87b0_92c3_013f_e90b,
                0x438c_3c67_be8d_0224,
                0x9cc7_d7c6_9cd7_77b6,
                0xa09c_aebf_594f_0ba0,
            ],
        ),
        (
            [
                0x243f_6a88_85a3_08d3,
                0x1319_8a2e_0370_7344,
                0xa409_3822_299f_31d0,
                0x082e_fa98_ec4e_6c89,
            ],
            [0x4528_21e6_38d0_1377, 0xbe54_66cf_34e9_0c6c],
            [
                0xa528_f454_03e6_1d95,
                0x38c7_2dbd_566e_9788,
                0xa5a1_610e_72fd_18b5,
                0x57bd_43b5_e52b_7fe6,
            ],
        ),
    ];

    #[test]
    fn words_are_those_that_are_published() {
        for (counter, key, words) in KNOWN {
            assert_eq!(philox(counter, key), words);
        }
    }
}
