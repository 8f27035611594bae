//! Pictures that a reader takes hold of. What is computed here is computed by the library of the book; a page runs it as
//! WebAssembly, and a test runs it natively and compares.
//!
//! A [`Widget`] says once what a reader can change and what is shown ([`Face`]), and then draws a [`Scene`] for any state
//! of its controls. The script in `widgets/script` makes sliders of the one and lines of the other, and computes nothing.

pub mod bearing;
pub mod bundle_adjustment;
mod face;
pub mod marginalization;
pub mod preintegration;
pub mod reprojection;
mod scene;
mod session;

pub use face::{Axis, Control, Face, Handle, Kind, Panel, Question, Reading};
pub use scene::{Scene, Shape, Style};
pub use session::{Player, Session};

/// A picture with controls.
pub trait Widget: Default {
    /// What a reader can change, and what is shown.
    const FACE: Face;

    /// Draws the picture for these values of the controls, in the order of the face.
    fn show(&mut self, controls: &[f64], scene: &mut Scene);

    /// What the controls become when a reader drags a handle to a place of its panel.
    fn drag(&self, _handle: usize, _to: [f64; 2], _controls: &mut [f64]) {}
}

/// A widget by its name, to be played without a page.
pub type Named = (&'static str, fn() -> Box<dyn Player>);

/// All widgets.
pub const WIDGETS: &[Named] = &[
    ("bearing", || Box::new(Session::<bearing::Bearing>::new())),
    ("reprojection", || Box::new(Session::<reprojection::Reprojection>::new())),
    ("preintegration", || Box::new(Session::<preintegration::Preintegration>::new())),
    ("marginalization", || Box::new(Session::<marginalization::Marginalization>::new())),
    ("bundle_adjustment", || Box::new(Session::<bundle_adjustment::BundleAdjustment>::new())),
];

/// Exports a widget from a module that imports nothing. Texts and numbers are handed over as a place in the module's
/// memory: the address in the upper half, the length in the lower one.
#[macro_export]
macro_rules! module {
    ($widget:ty) => {
        std::thread_local! {
            static SESSION: std::cell::RefCell<$crate::Session<$widget>> =
                std::cell::RefCell::new($crate::Session::new());
        }

        fn place<T>(of: &[T]) -> u64 {
            (of.as_ptr() as usize as u64) << 32 | of.len() as u64
        }

        /// The face as JSON, in bytes.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn face() -> u64 {
            SESSION.with_borrow(|session| place(session.face().as_bytes()))
        }

        /// The values of the controls, to be read and written.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn controls() -> u64 {
            SESSION.with_borrow(|session| place(session.controls()))
        }

        /// Draws; the numbers of the scene.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn show() -> u64 {
            SESSION.with_borrow_mut(|session| place(session.show()))
        }

        /// Drags a handle; the controls are other ones then.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn drag(handle: u32, x: f64, y: f64) {
            SESSION.with_borrow_mut(|session| session.drag(handle as usize, [x, y]));
        }
    };
}
