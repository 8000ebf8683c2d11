//! With the feature `native-levels`: leaves out the instruction set AVX-512 where the machine that compiles has none.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let is_native = env::var_os("CARGO_FEATURE_NATIVE_LEVELS").is_some();
    let is_for_x86 = env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "x86_64");
    if is_native && is_for_x86 && !has_avx512() {
        println!("cargo::rustc-cfg=without_avx512");
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
}

#[cfg(not(target_arch = "x86_64"))]
fn has_avx512() -> bool {
    false
}
