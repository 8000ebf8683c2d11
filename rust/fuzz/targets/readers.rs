//! The target `readers` of libFuzzer.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| polhode_fuzz::readers::run(data));
