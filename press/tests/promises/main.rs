//! The press at work on a small book: every promise broken once, and the book served.

mod faults;
mod library;
mod parts;
mod serve;
mod small;
