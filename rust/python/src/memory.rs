//! Memory: what is asked for is compared with what the machine has left before anything of it is touched.
//!
//! An allocation alone does not tell: Linux hands out pages that it does not have, and ends a process that writes to them.

use std::fmt::{self, Display, Formatter};
use std::fs;

use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::shape::tuple;

/// What is asked for without a look at what is left, in bytes: to fill more takes much longer than the look.
const LITTLE: u64 = 1 << 26;

/// Where the system itself refuses.
const NOT_GIVEN: &str = "which the system does not give";

/// What arguments are called together: "body, omega".
pub(crate) struct Names<'a>(pub(crate) &'a [&'a str]);

impl Display for Names<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join(", "))
    }
}

/// How many items of `bytes` each `shape` has, if there is memory for all of them.
///
/// # Errors
/// `MemoryError` with what asks for them, the shape and the bytes; nothing has been allocated.
pub(crate) fn room(what: impl Display, shape: &[usize], bytes: usize) -> PyResult<usize> {
    // A length of zero makes none of any other.
    let items = if shape.contains(&0) {
        Some(0)
    } else {
        shape
            .iter()
            .try_fold(1_usize, |n, &length| n.checked_mul(length))
    };
    let needed = items.and_then(|items| Some((items, items.checked_mul(bytes)? as u64)));
    match needed {
        Some((items, needed)) if needed <= LITTLE => Ok(items),
        Some((items, needed)) => match memory_left() {
            Some(left) if needed > left => {
                let law = format!("but {} are left", human(left as f64));
                Err(refusal(what, shape, bytes, &law))
            }
            // Addresses for all of it, given back at once: a limit of the process tells now, not half way.
            _ if Vec::<u8>::new().try_reserve_exact(items * bytes).is_err() => {
                Err(refusal(what, shape, bytes, NOT_GIVEN))
            }
            _ => Ok(items),
        },
        None => Err(refusal(
            what,
            shape,
            bytes,
            "more than a process can address",
        )),
    }
}

/// How many items a shape has, where they are so few that nobody needs to look whether there is room.
pub(crate) fn few(shape: &[usize], bytes: usize) -> Option<usize> {
    let mut items = 1_usize;
    for &length in shape {
        items = items.checked_mul(length)?;
    }
    (items.checked_mul(bytes)? as u64 <= LITTLE).then_some(items)
}

/// An empty vector with room for the items of `shape`; `copies` is how many as large there will be beside it.
///
/// # Errors
/// As [`room`], and where the system refuses.
pub(crate) fn vector<T>(what: impl Display, shape: &[usize], copies: usize) -> PyResult<Vec<T>> {
    let items = room(&what, shape, size_of::<T>().saturating_mul(1 + copies))?;
    let mut vector = Vec::new();
    (vector.try_reserve_exact(items))
        .map_err(|_| refusal(what, shape, size_of::<T>(), NOT_GIVEN))?;
    Ok(vector)
}

fn refusal(what: impl Display, shape: &[usize], bytes: usize, law: &str) -> PyErr {
    let needed = shape
        .iter()
        .fold(bytes as f64, |n, &length| n * length as f64);
    PyMemoryError::new_err(format!(
        "{what}: a result of shape {} takes {} with its copies, {law}; ask for it in parts",
        tuple(shape),
        human(needed)
    ))
}

/// A number of bytes for people.
fn human(bytes: f64) -> String {
    let units = ["kB", "MB", "GB", "TB", "PB"];
    let (mut number, mut unit) = (bytes / 1e3, units[0]);
    for larger in &units[1..] {
        if number < 1e3 {
            break;
        }
        (number, unit) = (number / 1e3, larger);
    }
    if number < 1e3 {
        format!("{number:.3} {unit}")
    } else {
        format!("{bytes:.1e} bytes")
    }
}

/// What is left for this process in bytes, where the system tells: of the machine and of its group.
fn memory_left() -> Option<u64> {
    let machine = machine().or_else(|| Python::attach(|py| installed_memory(py).ok()));
    [machine, group()].into_iter().flatten().min()
}

/// Of the machine: what is free or can be made so, and the swap.
fn machine() -> Option<u64> {
    let told = fs::read_to_string("/proc/meminfo").ok()?;
    let swap = kilobytes(&told, "SwapFree:").unwrap_or(0);
    Some(kilobytes(&told, "MemAvailable:")?.saturating_add(swap))
}

/// Of a machine that does not tell what is free: all that is installed.
fn installed_memory(py: Python<'_>) -> PyResult<u64> {
    let os = py.import("os")?;
    let ask = |name: &str| os.call_method1("sysconf", (name,))?.extract::<u64>();
    Ok(ask("SC_PHYS_PAGES")?.saturating_mul(ask("SC_PAGE_SIZE")?))
}

/// Of the control group that a container is; what files take of it can be had back.
fn group() -> Option<u64> {
    let own = fs::read_to_string("/proc/self/cgroup").ok()?;
    let path = own.lines().find_map(|line| line.strip_prefix("0::"))?;
    let folder = format!("/sys/fs/cgroup{}", path.trim_end_matches('/'));
    let number = |file: &str| -> Option<u64> {
        let told = fs::read_to_string(format!("{folder}/{file}")).ok()?;
        told.trim().parse().ok()
    };
    let (most, used) = (number("memory.max")?, number("memory.current")?);
    let parts = fs::read_to_string(format!("{folder}/memory.stat")).unwrap_or_default();
    let files = parts
        .lines()
        .find_map(|line| line.strip_prefix("inactive_file "))
        .and_then(|number| number.trim().parse().ok())
        .unwrap_or(0);
    Some(most.saturating_sub(used.saturating_sub(files)))
}

/// The bytes that a line such as "`MemAvailable`:   123 kB" tells.
fn kilobytes(told: &str, name: &str) -> Option<u64> {
    let line = told.lines().find_map(|line| line.strip_prefix(name))?;
    let number: u64 = line.split_whitespace().next()?.parse().ok()?;
    number.checked_mul(1024)
}
