//! The methods of the class `RigidBody`.

mod composites;
mod construct;
mod container;
mod continuum;
mod deviations;
mod dynamics;
mod ensemble;
mod figures;
mod from_shapes;
mod matter;
mod motion;
mod outcome;
mod outside;
mod properties;
mod sigma;
mod simulate;
mod stored;
mod trust;
