//! Marginalization: variables leave a window, and what was known of the others stays.
//!
//! A window's linearized factors are a Gaussian over named [`Blocks`], which stand for the steps of the
//! variables from where they were linearized. It has two forms of the same meaning:
//!
//! - [`Information`]: the information matrix Λ and the information vector η, with the density
//!   exp(−½ xᵀΛx + ηᵀx). [`marginalize`] takes blocks out of it by Schur complements.
//! - [`SquareRoot`]: rows R x + d of a whitened residual, with Λ = RᵀR and η = −Rᵀd.
//!   [`SquareRoot::marginalize`] takes blocks out of it by orthogonal transformations, and nothing is
//!   squared.
//!
//! Either becomes a [`LinearPrior`](crate::least_squares::LinearPrior), one more factor of the window
//! that goes on. [`fill_in`] says what it couples before it is made; [`divergence`] says in nats what
//! it costs to forget instead, and [`OverConfidence`] which directions are then claimed to be known
//! better than they are.

mod blocks;
mod couplings;
mod divergence;
mod error;
mod forgetting;
mod information;
mod layouts;
mod links;
mod over_confidence;
mod pivots;
mod prior;
mod square_root;

pub use blocks::{Block, Blocks};
pub use couplings::{Couplings, FillIn, fill_in};
pub use divergence::divergence;
pub use error::MarginalizationError;
pub use information::{Information, marginalize};
pub use layouts::{Layout, LayoutError, WindowSigmas};
pub use links::{keep_marginals, sparsify, zero_link};
pub use over_confidence::OverConfidence;
pub use square_root::SquareRoot;
