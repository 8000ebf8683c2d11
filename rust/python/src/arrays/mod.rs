//! NumPy layout: anything array-like in, C-ordered float64 arrays out.

mod reading;
mod scalar;
mod series;
mod slabs;
mod writing;

pub(crate) use crate::foreign::{as_array, contiguous, numpy};
pub(crate) use crate::items::Item;
pub(crate) use reading::{
    Argument, floats, list_floats, read, read_indices, read_list, read_or, real_numbers, try_items,
    try_rows,
};
pub(crate) use scalar::read_scalar;
pub(crate) use series::{samples, try_series};
pub(crate) use slabs::{Slabs, all_in_slabs, in_slabs};
pub(crate) use writing::{
    Numbers, write, write_any_of, write_numbers, write_numbers_of, write_of, write_words_of, zeros,
};
