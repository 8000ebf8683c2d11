//! The committed seeds and some thousand inputs of a generator, through the same harnesses that libFuzzer feeds.

// What is missing here is a broken test.
#![allow(clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use polhode_fuzz::HARNESSES;

/// An input that takes longer hangs.
const LONGEST: Duration = Duration::from_secs(30);

/// Of a thread that replays: unoptimised, the wide kernels need more than a test has.
const STACK: usize = 64 << 20;

/// Marsaglia's xorshift: the same bytes on every machine.
struct Bytes(u64);

impl Bytes {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn some(&mut self) -> Vec<u8> {
        let count = self.next() % 600;
        (0..count).map(|_| self.next().to_le_bytes()[3]).collect()
    }
}

#[test]
fn seeds() {
    let replay = thread::Builder::new().stack_size(STACK).spawn(each_seed);
    replay.expect("a thread").join().expect("every seed passes");
}

fn each_seed() {
    for (name, harness) in HARNESSES {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("seeds")
            .join(name);
        let mut count = 0;
        for entry in fs::read_dir(folder).expect("seeds") {
            let path = entry.expect("a seed").path();
            eprintln!("{}", path.display());
            harness(&fs::read(path).expect("a seed"));
            count += 1;
        }
        assert!(count > 0, "{name} has no seeds");
    }
}

fn generated(name: &str, count: u64) {
    let found = HARNESSES.iter().find(|(harness, _)| *harness == name);
    let (_, harness) = found.expect("a harness");
    let (told, hear) = mpsc::channel();
    let harness = *harness;
    let replay = thread::Builder::new().stack_size(STACK);
    let spawned = replay.spawn(move || {
        let mut bytes = Bytes(0x9e37_79b9_7f4a_7c15);
        for k in 0..count {
            let input = bytes.some();
            let kept = input.clone();
            let outcome = std::panic::catch_unwind(|| harness(&input)).is_ok();
            if told.send((k, outcome, kept)).is_err() {
                return;
            }
        }
    });
    spawned.expect("a thread");
    for k in 0..count {
        let (number, is_good, input) = hear
            .recv_timeout(LONGEST)
            .unwrap_or_else(|_| panic!("{name}: input {k} takes longer than {LONGEST:?}"));
        assert!(is_good, "{name}: input {number}: {input:?}");
    }
}

#[test]
fn generated_files() {
    generated("readers", 4000);
}

#[test]
fn generated_bodies() {
    generated("bodies", 8000);
}

#[test]
fn generated_angles() {
    generated("angles", 8000);
}

#[test]
fn generated_motions() {
    generated("motions", 2000);
}
