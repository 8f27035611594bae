//! The press at work on a small book: every promise broken once, and the book served.

mod algorithms;
mod diagrams;
mod faults;
mod figures;
mod library;
mod new;
mod paper;
mod parts;
mod recordings;
mod reports;
mod serve;
mod sheets;
mod small;
