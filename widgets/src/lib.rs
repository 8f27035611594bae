//! Pictures that a reader takes hold of. What is computed here is computed by the library of the book; a page runs it as
//! WebAssembly, and a test runs it natively and compares.
//!
//! A [`Widget`] says once what a reader can change and what is shown ([`Face`]), and then draws a [`Scene`] for any state
//! of its controls. The script in `widgets/script` makes sliders of the one and lines of the other, and computes nothing.

pub mod bearing;
pub mod bundle_adjustment;
mod curve;
mod ellipse;
mod face;
pub mod marginalization;
pub mod msckf;
pub mod odometry;
pub mod parallax;
mod pixels;
pub mod preintegration;
pub mod reprojection;
mod scene;
mod session;

pub use face::{Axis, Control, Face, Handle, Kind, Panel, Question, Reading, Steps};
pub use scene::{Scene, Shape, Style};
pub use session::{Player, Session};

/// A picture with controls.
pub trait Widget {
    /// What a reader can change, and what is shown.
    const FACE: Face;

    /// The same, where it is not known before the widget is there.
    fn face(&self) -> Face {
        Self::FACE
    }

    /// What is told of each step of what goes on in steps; by default nothing does.
    const STEPS: Steps = Steps { decisions: &[], numbers: &[], lost: None };

    /// Computes a little of what these controls show, and says whether more is left. What takes too long for one picture
    /// of the screen is computed so; the rest is computed when it is shown.
    fn advance(&mut self, _controls: &[f64]) -> bool {
        false
    }

    /// Draws the picture for these values of the controls, in the order of the face, as far as it has been computed.
    fn show(&mut self, controls: &[f64], scene: &mut Scene);

    /// Decisions and numbers of the steps until what these controls show, one step after the other.
    fn steps(&self, _controls: &[f64], _into: &mut Vec<f64>) {}

    /// What the controls become when a reader drags a handle to a place of its panel.
    fn drag(&self, _handle: usize, _to: [f64; 2], _controls: &mut [f64]) {}
}

/// A widget by its name, to be played without a page.
pub type Named = (&'static str, fn() -> Box<dyn Player>);

/// All widgets.
pub const WIDGETS: &[Named] = &[
    ("bearing", || Box::new(Session::<bearing::Bearing>::new())),
    ("parallax", || Box::new(Session::<parallax::Parallax>::new())),
    ("reprojection", || Box::new(Session::<reprojection::Reprojection>::new())),
    ("preintegration", || Box::new(Session::<preintegration::Preintegration>::new())),
    ("marginalization", || Box::new(Session::<marginalization::Marginalization>::new())),
    ("bundle_adjustment", || Box::new(Session::<bundle_adjustment::BundleAdjustment>::new())),
    ("msckf", || Box::new(Session::<msckf::Filter>::new())),
    ("odometry", || Box::new(Session::<odometry::Assembled>::new())),
];

/// Exports a widget from a module that imports nothing. Texts and numbers are handed over as a place in the module's
/// memory: the address in the upper half, the length in the lower one.
#[macro_export]
macro_rules! module {
    ($widget:ty) => {
        $crate::module!($widget, <$widget>::default());
    };
    ($widget:ty, $made:expr) => {
        std::thread_local! {
            static SESSION: std::cell::RefCell<$crate::Session<$widget>> =
                std::cell::RefCell::new($crate::Session::of($made));
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

        /// Computes a little; one if more is left, and zero if not.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn advance() -> u32 {
            SESSION.with_borrow_mut(|session| u32::from(session.advance()))
        }

        /// Draws what has been computed; the numbers of the scene.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn show() -> u64 {
            SESSION.with_borrow_mut(|session| place(session.show()))
        }

        /// What is told of each step.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn steps() -> u64 {
            SESSION.with_borrow_mut(|session| place(session.steps()))
        }

        /// What the picture that was drawn last says in words, in bytes.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn said() -> u64 {
            SESSION.with_borrow(|session| place(session.said().as_bytes()))
        }

        /// Drags a handle; the controls are other ones then.
        #[allow(unsafe_code)]
        #[unsafe(no_mangle)]
        pub extern "C" fn drag(handle: u32, x: f64, y: f64) {
            SESSION.with_borrow_mut(|session| session.drag(handle as usize, [x, y]));
        }
    };
}
