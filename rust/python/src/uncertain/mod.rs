//! Numbers with a sigma in, doubts of bodies carried along, covariances out.
//!
//! | file | what it knows |
//! |---|---|
//! | `class` | the class `Uncertain` |
//! | `quantity` | arguments that may be numbers with a sigma |
//! | `carried` | the doubts of a stack of bodies |
//! | `results` | covariances and standard deviations of bodies |
//! | `stored` | doubts as arrays, for pickles and files |

mod carried;
mod class;
mod quantity;
mod results;
mod stored;

pub(crate) use carried::{Doubts, carried};
pub(crate) use class::PyUncertain;
pub(crate) use quantity::{
    Number, Quantity, Weight, factor, has_ufloats, is_uncertain, known, quantity, quantity_list,
    quantity_or, rotation_quantity, symmetric, value_of,
};
