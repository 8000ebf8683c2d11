//! The target `motions` of libFuzzer.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| polhode_fuzz::motions::run(data));
