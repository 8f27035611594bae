//! Random states, readings and landmarks.
