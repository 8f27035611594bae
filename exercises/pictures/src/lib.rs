//! Pictures of answers to the exercises: what a student has written stands beside what the book says.
//!
//! A page that is served with `cargo book serve --mine` runs them as WebAssembly, each answer in a module of its own.
//! What is right is computed by the library and by the public checks; no reference answer is here.

mod answer;
mod beside;
mod descent;
mod left_perturbation;
mod residual_jacobian;
mod squares;

pub use answer::{Asked, is_silent, panic_said, silence, written};
pub use beside::Beside;
pub use exercise_spec;
pub use left_perturbation::LeftPerturbation;
pub use residual_jacobian::ResidualJacobian;
pub use widgets;

/// Exports the picture of an answer, whose functions are in the module `answer`.
#[macro_export]
macro_rules! picture {
    ($picture:ident of $slug:ident: $($function:ident),+ $(,)?) => {
        $crate::widgets::module!($crate::$picture, {
            use $crate::exercise_spec::$slug::{EXERCISE, Functions};
            let [nothing, ..] = Functions::spoiled();
            let functions = Functions { $($function: answer::$function),+ };
            $crate::$picture::of(&EXERCISE, $crate::written(functions, nothing))
        });

        /// What the panic that ended a call said, in bytes.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn panic_said() -> u64 {
            $crate::panic_said()
        }

        /// Asks the answer no more.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn silence() {
            $crate::silence();
        }
    };
}
