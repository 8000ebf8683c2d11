//! Numbers with a sigma in, doubts of bodies carried along.
//!
//! | file | what it knows |
//! |---|---|
//! | `class` | the class `Uncertain` |
//! | `quantity` | arguments that may be numbers with a sigma |
//! | `carried` | the doubts of a stack of bodies |

mod carried;
mod class;
mod quantity;
mod start;

pub(crate) use carried::{carried, of_numbers};
pub(crate) use class::PyUncertain;
pub(crate) use quantity::{
    Number, Quantity, Weight, factor, holds_uncertain, is_uncertain, known, quantity,
    quantity_list, quantity_or, rotation_quantity, symmetric, value_of,
};
pub(crate) use start::{StartGiven, UncertainStart};
