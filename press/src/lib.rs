//! The press: it builds the book with mdBook, and the build fails when the book says what no program does.
//!
//! [`make`] is the whole; [`preprocess`] the preprocessor; [`fault`] what both find.

pub mod accept;
pub mod accepted;
pub mod answers;
pub mod api;
pub mod attributes;
pub mod bibliography;
pub mod blocks;

mod cargo;
mod compiler;
pub mod emit;
pub mod engine;
pub mod exhibits;
pub mod fault;
pub mod figures;
pub mod files;
pub mod formulas;
pub mod guard;
pub mod index;
pub mod inline;
pub mod ledger;
pub mod links;
pub mod lint;
pub mod listing;
pub mod main_road;
pub mod make;
pub mod new;
pub mod pack;
mod packing;
pub mod pages;
pub mod preprocess;
pub mod program;
pub mod prose;
pub mod recordings;
pub mod records;
pub mod reports;
pub mod serve;
pub mod settings;
pub mod sources;
pub mod steps;
pub mod symbols;
pub mod theorems;
pub mod uses;
pub mod warnings;
pub mod ways;
pub mod widgets;
