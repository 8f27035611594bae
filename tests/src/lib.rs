//! Tests of the rendered book; they stand in `tests/tests`.
